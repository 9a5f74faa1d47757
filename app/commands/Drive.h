#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/DriveSettings.h"
#include "app/frame/EyeAdaptation.h"
#include "app/frame/Governor.h"
#include "app/frame/MirrorPlan.h"
#include "app/frame/ReflectionEngine.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/FrameTimer.h"
#include "app/render/SceneRenderer.h"

namespace app {

struct CloseScene;

/// How a budget or an error was met in a frame.
struct Governed {
    bool active = false;
    double position = 0;     ///< on the ladder, 0: finest
    double last = 0;         ///< its cheapest position
    double predictedMs = 0;  ///< of this frame's detail at the load so far
    double error = 0;        ///< mean FLIP on mirrors that the calibration found for this detail
    std::string givenUp;     ///< against the finest; empty: nothing
};

/// What one frame took and did.
struct FrameStats {
    double frameMs = 0;       ///< reflections and drawing, until OpenGL had finished
    double reflectionMs = 0;  ///< the reflections' share: planning, building, uploading
    ReflectionCounters reflections;
    RenderCounters drawn;
    MirrorCounters mirrors;
    std::uint32_t chromeParts = 0;    ///< of the vehicles seen
    std::uint32_t chromeLeftOut = 0;  ///< jobs for want of room
    std::uint32_t chromeMaking = 0;   ///< jobs that wait for their reflectors
    std::size_t chromeBytes = 0;      ///< of reflectors, held now
    Governed governed;
};

/// The one way of a frame: traffic -> FrameScene -> reflections -> picture. Needs an OpenGL context current
/// from construction to destruction; keeps a reference to the scene. Vehicles have plain paint until
/// `startReflecting`.
class Drive {
  public:
    /// `renderer`: GL_RENDERER, for which calibrations are kept.
    Drive(const Scene& scene, const Options& options, std::string renderer);
    ~Drive();

    /// Heightfield, reference maps and whatever else the method needs. False: ended by `carryOn` or an
    /// interrupt; what is finished stays in the cache.
    /// `calibrating` is asked while a budget or an error needs a calibration that is not in the cache; ended,
    /// the named quality stays.
    bool startReflecting(const CarryOn& carryOn = {}, const CarryOn& calibrating = {});

    /// Simulates on, in the traffic's fixed steps; what is left of a step is kept for the next call.
    void advance(double seconds);
    /// The first call draws its frame twice: what is made with a first picture (programs, the sun's shadow
    /// map, the first local maps, chrome's surroundings) belongs to the start, not to a frame that is shown.
    /// `seconds`: since the last picture, for the viewer's eye, which adapts while the traffic stands too.
    FrameStats draw(const View& view, std::uint32_t framebuffer, double seconds);

    const DriveSettings& settings() const { return settings_; }
    /// Takes over what changed: other cars start the traffic anew, other quality the renderer, another hour
    /// asks for other reference maps. False: those were ended by `carryOn` or an interrupt, and hour and
    /// method stay as they were.
    bool change(const DriveSettings& wanted, const CarryOn& carryOn = {}, const CarryOn& calibrating = {});

    const vehicles::Traffic& traffic() const { return traffic_; }
    const FrameScene& frame() const { return frame_; }
    /// What reflects; nothing while the method is `none` and no other was used before.
    const ReflectionEngine* engine() const { return engine_.get(); }
    /// What goes up and down the ladder; nothing unless a budget or an error is to be met.
    const Governor* governor() const { return governor_ ? &*governor_ : nullptr; }
    /// Slots of the last frame's vehicles, empty for plain paint.
    const VehicleReflections& reflections() const { return reflections_; }

  private:
    RenderOptions renderOptions() const;
    void makeRenderer();
    MirrorSettings mirrorSettings(const View& view) const;
    /// Which chrome shows close things itself: only maps need that, rays see all.
    ChromePlan chromePlan(std::span<const SeenVehicle> seen);
    void makeCloseScene();
    ReflectionSettings reflectionSettings() const;
    void lendRays();
    /// Heightfield, maps and engine for this light; the old ones stay when it is cut short, and until then.
    bool reflectIn(const Lighting& lighting, const CarryOn& carryOn);

    FrameStats drawFrame(const View& view, std::uint32_t framebuffer);
    /// Of a fixed quality: draws the frame some times and keeps the detail that then meets the budget.
    void chooseOnce(const View& view, std::uint32_t framebuffer);
    /// Detail of the coming frame, in which so many vehicles are seen.
    Governed chooseDetail(std::size_t seen, const View& view);
    /// Starts or ends governing, as the settings say; calibrates when needed.
    void govern(const CarryOn& calibrating);

    const Scene* scene_;
    std::uint64_t seed_;
    PreparationOptions preparation_;
    MapsOn mapsOn_;
    std::size_t gpuMapBytes_;
    glm::ivec2 resolution_;
    std::string rendererName_;
    DriveSettings settings_;
    vehicles::Traffic traffic_;
    MirrorPlanner mirrorPlanner_;
    MirrorPlan mirrorPlan_;                   ///< of the last frame
    std::unique_ptr<CloseScene> closeScene_;  ///< made when first needed
    ChromeFades chromeFades_;
    bool waitForChrome_;  ///< for its reflectors: pictures must not depend on how fast they are made
    std::unique_ptr<SceneRenderer> renderer_;
    Lighting lighting_;
    std::unique_ptr<RayTracer> rays_;  ///< made when first needed
    PreparedReflections prepared_;
    std::unique_ptr<ReflectionEngine> engine_;
    std::optional<Governor> governor_;
    bool choosing_ = false;
    bool rehearsed_ = false;
    FrameTimer timer_;
    std::optional<DetailLadder> ladder_;  ///< of this quality's renderer
    VehicleReflections reflections_;
    EyeAdaptation adaptation_;
    FrameScene frame_;
    double lead_ = 0;  ///< seconds asked for and not yet simulated
};

}  // namespace app
