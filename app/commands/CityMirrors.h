#pragma once

#include <optional>

#include "app/commands/LoadScene.h"
#include "app/commands/Options.h"
#include "app/frame/MirrorPlan.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// The windows and wet streets of a scene in frames that are drawn to be measured. A city without either is
/// drawn as if there were no such thing.
class CityMirrors {
  public:
    /// Keeps a reference to the scene.
    CityMirrors(const Scene& scene, const MirrorSettings& settings, bool wet)
        : scene_(&scene), planner_(scene.glass.fronts), settings_(settings), wet_(wet) {}

    /// Whether anything mirrors at all.
    bool any() const {
        return wet_ ||
               (!scene_->glass.fronts.empty() && settings_.on && settings_.maps > 0 && settings_.depth > 0);
    }
    /// The most that is drawn.
    MirrorDetail most() const {
        return {1, static_cast<double>(settings_.maps), static_cast<double>(settings_.depth)};
    }
    bool wet() const { return wet_; }

    /// Plans the view of a frame that `renderer`, which has the scene's glass, was prepared with. The result
    /// holds until the next call.
    PlanarReflections plan(const View& view, const SceneRenderer& renderer, const Detail& detail);

  private:
    const Scene* scene_;
    MirrorPlanner planner_;
    MirrorSettings settings_;
    bool wet_;
    MirrorPlan plan_;
};

/// What --mirrors, --mirror-depth, --mirror-maps, --mirror-fade and --weather say.
CityMirrors cityMirrors(const Scene& scene, const Options& options);

}  // namespace app
