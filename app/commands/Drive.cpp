#include "app/commands/Drive.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/display/OffscreenTarget.h"
#include "app/report/Timing.h"

namespace app {

Drive::Drive(const Scene& scene, const Options& options)
    : scene_(&scene),
      seed_(options.seed),
      settings_{options.method, options.mem, options.quality, options.cars.front(), options.hour},
      traffic_(startTraffic(scene, options.seed, options.cars.front())),
      renderer_(std::make_unique<SceneRenderer>(scene.city, scene.models, renderOptions())),
      lighting_(scene.lighting) {
    preparation_.cell = static_cast<float>(options.cell);
    preparation_.quiet = options.quiet;
    if (settings_.method != ReflectionMethod::none) prepareReflecting();
}

void Drive::prepareReflecting() {
    FrameScene empty;
    empty.lighting = lighting_;
    empty.signalColours.assign(scene_->city.signalHeads.size(), vehicles::SignalColour::red);
    renderer_->prepare(empty);
    engine_.reset();
    const Stopwatch watch;
    prepared_ = prepareReflections(scene_->city, lighting_, *renderer_, preparation_);
    spdlog::info(
        "{} reference maps see {:.1f}% of what can be seen from the lanes ({} from the cache, {} drawn, "
        "{:.1f} s)",
        prepared_.maps.size(), 100 * prepared_.coverage, prepared_.loaded, prepared_.baked,
        watch.elapsed() / 1000);
    engine_ = std::make_unique<ReflectionEngine>(*prepared_.tracer, prepared_.maps, scene_->models,
                                                 reflectionSettings());
}

ReflectionSettings Drive::reflectionSettings() const {
    ReflectionSettings settings;
    settings.method = settings_.method;
    settings.variant = settings_.mem;
    settings.quality = settings_.quality;
    return settings;
}

RenderOptions Drive::renderOptions() const {
    RenderOptions options;
    options.shadows = settings_.quality != Quality::low;
    options.antialiasing = settings_.quality == Quality::low      ? Antialiasing::none
                           : settings_.quality == Quality::medium ? Antialiasing::fxaa
                                                                  : Antialiasing::msaa4;
    return options;
}

void Drive::advance(double seconds) {
    if (traffic_.size() == 0) return;
    // A long pause (a window that was dragged) is not caught up with.
    lead_ += std::clamp(seconds, 0.0, 0.5);
    double before = traffic_.time();
    while (lead_ > 0) {
        traffic_.step();
        lead_ -= traffic_.time() - before;
        before = traffic_.time();
    }
}

FrameStats Drive::draw(const View& view, std::uint32_t framebuffer) {
    FrameStats stats;
    frame_ = assembleFrame(scene_->city, traffic_, lighting_, {view});
    finishDrawing();
    const Stopwatch watch;
    renderer_->prepare(frame_);
    reflections_ = {};
    if (settings_.method != ReflectionMethod::none && engine_) {
        const Stopwatch reflecting;
        std::vector<SeenVehicle> seen;
        for (const auto& visible : renderer_->visibleVehicles(view))
            seen.push_back({visible.index, visible.diameterPixels});
        const ReflectionPlan& plan = engine_->update(frame_, seen, *renderer_);
        reflections_ = {engine_->textures(), plan.slots};
        stats.reflectionMs = reflecting.elapsed();
        stats.reflections = engine_->counters();
    }
    renderer_->drawView(view, reflections_, framebuffer);
    finishDrawing();
    stats.frameMs = watch.elapsed();
    stats.drawn = renderer_->counters();
    return stats;
}

void Drive::change(const DriveSettings& settings) {
    const DriveSettings old = settings_;
    settings_ = settings;
    if (settings.cars != old.cars) traffic_ = startTraffic(*scene_, seed_, settings.cars);
    if (settings.quality != old.quality) {
        renderer_.reset();
        renderer_ = std::make_unique<SceneRenderer>(scene_->city, scene_->models, renderOptions());
    }
    const bool relit = settings.hour != old.hour;
    if (relit)
        lighting_ = lightingAt(settings.hour, scene_->city.frame ? scene_->city.frame->latitude() : 50);
    if (settings.method == ReflectionMethod::none) {
        // Maps of another light are of no use later.
        if (relit) engine_.reset();
        return;
    }
    if (!engine_ || relit)
        prepareReflecting();
    else
        engine_->configure(reflectionSettings());
}

}  // namespace app
