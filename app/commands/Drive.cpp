#include "app/commands/Drive.h"

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
      lighting_(scene.lighting) {}

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
    const VehicleReflections reflections;
    stats.reflectionMs = watch.elapsed();
    renderer_->drawView(view, reflections, framebuffer);
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
    if (settings.hour != old.hour)
        lighting_ = lightingAt(settings.hour, scene_->city.frame ? scene_->city.frame->latitude() : 50);
}

}  // namespace app
