#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/commands/CarsStage.h"
#include "app/commands/CityMirrors.h"
#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/Governor.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// The scene of the load step: a street with enough cars in view, of which a cast is left. The same for every
/// play of the same seed, frame by frame.
class GovernorPlay {
  public:
    /// Keeps references to all but the settings. `renderer`: of its own, for it hides changes of detail from
    /// one picture to the next. `close`: what chrome shows, as the program does it; null: nothing.
    GovernorPlay(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                 std::uint32_t mostCars, std::uint64_t seed, glm::ivec2 resolution,
                 const ReflectionSettings& settings, const CityMirrors& mirrors, const CloseScene* close,
                 const ChromeDrawing& chrome);

    /// False: the city has no street to look down.
    bool possible() const { return set_.traffic.has_value(); }
    /// The traffic drives on for a thirtieth of a second.
    void next(Cast& cast);
    /// With a detail that never changes, or with the governor's, which is told what it took.
    FrameCost draw(const Detail& detail);
    FrameCost draw(Governor& governor);

    Image8 picture() const { return readPixels(target_.framebuffer(), target_.size()); }
    /// Of all frames so far.
    std::uint64_t chromeJobs() const { return chromeJobs_; }
    const ReflectionCounters& counters() const { return engine_.counters(); }

  private:
    FrameCost draw(const Detail* fixed, Governor* governor);

    const Scene& scene_;
    SceneRenderer& renderer_;
    OffscreenTarget target_;
    CarsStage set_;
    ReflectionEngine engine_;
    CityMirrors mirrors_;
    const CloseScene* close_;
    ChromeDrawing chrome_;
    ChromeFades fades_;
    std::uint64_t chromeJobs_ = 0;
    FrameScene frame_;
};

/// Mean FLIP from each picture to the next: one less than pictures.
std::vector<double> jumps(const std::vector<Image8>& pictures);

}  // namespace app
