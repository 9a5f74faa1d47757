#include "app/commands/Drive.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/display/OffscreenTarget.h"
#include "app/report/Timing.h"

namespace app {

Drive::Drive(const Scene& scene, const Options& options)
    : scene_(&scene),
      seed_(options.seed),
      mapsOn_(options.mapsOn),
      gpuMapBytes_(options.gpuMapBytes()),
      settings_{options.method, options.mem, options.quality, options.cars.front(), options.hour},
      traffic_(startTraffic(scene, options.seed, options.cars.front())),
      renderer_(std::make_unique<SceneRenderer>(scene.city, scene.models, renderOptions())),
      lighting_(scene.lighting) {
    preparation_.cell = static_cast<float>(options.cell);
    preparation_.quiet = options.quiet;
}

bool Drive::startReflecting(const CarryOn& carryOn) {
    return settings_.method == ReflectionMethod::none || reflectIn(lighting_, carryOn);
}

bool Drive::reflectIn(const Lighting& lighting, const CarryOn& carryOn) {
    FrameScene empty;
    empty.lighting = lighting;
    empty.signalColours.assign(scene_->city.signalHeads.size(), vehicles::SignalColour::red);
    renderer_->prepare(empty);
    PreparationOptions preparation = preparation_;
    preparation.carryOn = carryOn;
    preparation.maps = readsReferenceMaps(settings_.method);
    const Stopwatch watch;
    PreparedReflections prepared = prepareReflections(scene_->city, lighting, *renderer_, preparation);
    if (!prepared.complete) return false;
    if (preparation.maps)
        spdlog::info(
            "{} reference maps see {:.1f}% of what can be seen from the lanes ({} from the cache, {} drawn, "
            "{:.1f} s)",
            prepared.maps.size(), 100 * prepared.coverage, prepared.loaded, prepared.baked,
            watch.elapsed() / 1000);
    engine_.reset();  // before the maps that it reads
    prepared_ = std::move(prepared);
    engine_ = std::make_unique<ReflectionEngine>(*prepared_.tracer, prepared_.maps, scene_->models,
                                                 reflectionSettings());
    lendRays();
    return true;
}

void Drive::lendRays() {
    if (settings_.method != ReflectionMethod::raytrace || !engine_) return;
    if (!rays_) rays_ = std::make_unique<RayTracer>(scene_->city, scene_->models);
    engine_->useRayTracer(rays_.get(), [this] { return renderer_->sunMap(); });
}

ReflectionSettings Drive::reflectionSettings() const {
    ReflectionSettings settings;
    settings.method = settings_.method;
    settings.variant = settings_.mem;
    settings.quality = settings_.quality;
    settings.mapsOn = mapsOn_;
    settings.gpuMapBytes = gpuMapBytes_;
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
        reflections_ = {engine_->textures(), plan.slots, engine_->mirroredIn(view)};
        stats.reflectionMs = reflecting.elapsed();
        stats.reflections = engine_->counters();
    }
    renderer_->drawView(view, reflections_, framebuffer);
    finishDrawing();
    stats.frameMs = watch.elapsed();
    stats.drawn = renderer_->counters();
    return stats;
}

bool Drive::change(const DriveSettings& wanted, const CarryOn& carryOn) {
    const DriveSettings old = settings_;
    settings_ = wanted;
    if (wanted.cars != old.cars) traffic_ = startTraffic(*scene_, seed_, wanted.cars);
    if (wanted.quality != old.quality) {
        renderer_.reset();
        renderer_ = std::make_unique<SceneRenderer>(scene_->city, scene_->models, renderOptions());
    }
    const bool relit = wanted.hour != old.hour;
    const Lighting lighting =
        relit ? lightingAt(wanted.hour, scene_->city.frame ? scene_->city.frame->latitude() : 50) : lighting_;
    const bool reflects = wanted.method != ReflectionMethod::none;
    bool finished = true;
    const bool mapsMissing = readsReferenceMaps(wanted.method) && prepared_.maps.empty();
    if (reflects && (!engine_ || relit || mapsMissing)) finished = reflectIn(lighting, carryOn);
    if (finished) {
        lighting_ = lighting;
        // Maps of another light are of no use later.
        if (!reflects && relit) engine_.reset();
    } else {
        settings_.hour = old.hour;
        settings_.method = engine_ && !mapsMissing ? wanted.method : old.method;
    }
    if (engine_ && settings_.method != ReflectionMethod::none) {
        engine_->configure(reflectionSettings());
        lendRays();
    }
    return finished;
}

}  // namespace app
