#include "app/commands/CityMirrors.h"

#include "app/frame/WetRoad.h"

namespace app {

PlanarReflections CityMirrors::plan(const View& view, const SceneRenderer& renderer, const Detail& detail) {
    if (!any()) return {};
    MirrorSettings settings = settings_;
    settings.limit(detail);
    if (wet_) settings.wetRoad = roadSeenBy(scene_->city.roads, view);
    plan_ = planner_.plan(std::span(&view, 1), settings,
                          [&](const auto& from, const auto* glass, const auto& box) {
                              return renderer.hides(from, glass, box);
                          });
    return {settings_.on ? &plan_ : nullptr, 0, wet_};
}

CityMirrors cityMirrors(const Scene& scene, const Options& options) {
    MirrorSettings settings;
    settings.on = options.mirrors;
    settings.depth = options.mirrorDepth;
    settings.maps = options.mirrorMaps;
    settings.fade = options.mirrorFade;
    return {scene, settings, options.weather == Weather::wet};
}

}  // namespace app
