#pragma once

#include <cstdint>
#include <memory>

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/DriveSettings.h"
#include "app/frame/ReflectionEngine.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// What one frame took and did.
struct FrameStats {
    double frameMs = 0;       ///< reflections and drawing, until OpenGL had finished
    double reflectionMs = 0;  ///< the reflections' share: planning, building, uploading
    ReflectionCounters reflections;
    RenderCounters drawn;
};

/// The one way of a frame: traffic -> FrameScene -> reflections -> picture. Needs an OpenGL context current
/// from construction to destruction; keeps a reference to the scene. Vehicles have plain paint until
/// `startReflecting`.
class Drive {
  public:
    Drive(const Scene& scene, const Options& options);

    /// Heightfield, reference maps and whatever else the method needs. False: ended by `carryOn` or an
    /// interrupt; what is finished stays in the cache.
    bool startReflecting(const CarryOn& carryOn = {});

    /// Simulates on, in the traffic's fixed steps; what is left of a step is kept for the next call.
    void advance(double seconds);
    FrameStats draw(const View& view, std::uint32_t framebuffer);

    const DriveSettings& settings() const { return settings_; }
    /// Takes over what changed: other cars start the traffic anew, other quality the renderer, another hour
    /// asks for other reference maps. False: those were ended by `carryOn` or an interrupt, and hour and
    /// method stay as they were.
    bool change(const DriveSettings& wanted, const CarryOn& carryOn = {});

    const vehicles::Traffic& traffic() const { return traffic_; }
    const FrameScene& frame() const { return frame_; }
    /// What reflects; nothing while the method is `none` and no other was used before.
    const ReflectionEngine* engine() const { return engine_.get(); }
    /// Slots of the last frame's vehicles, empty for plain paint.
    const VehicleReflections& reflections() const { return reflections_; }

  private:
    RenderOptions renderOptions() const;
    ReflectionSettings reflectionSettings() const;
    void lendRays();
    /// Heightfield, maps and engine for this light; the old ones stay when it is cut short, and until then.
    bool reflectIn(const Lighting& lighting, const CarryOn& carryOn);

    const Scene* scene_;
    std::uint64_t seed_;
    PreparationOptions preparation_;
    MapsOn mapsOn_;
    std::size_t gpuMapBytes_;
    DriveSettings settings_;
    vehicles::Traffic traffic_;
    std::unique_ptr<SceneRenderer> renderer_;
    Lighting lighting_;
    std::unique_ptr<RayTracer> rays_;  ///< made when first needed
    PreparedReflections prepared_;
    std::unique_ptr<ReflectionEngine> engine_;
    VehicleReflections reflections_;
    FrameScene frame_;
    double lead_ = 0;  ///< seconds asked for and not yet simulated
};

}  // namespace app
