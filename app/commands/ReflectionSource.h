#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/compare/FeatureAngles.h"
#include "app/frame/FrameScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// A way to give a frame's vehicles their reflections, as measurements see it: what is done once a frame for
/// all views, and what for each view.
class ReflectionSource {
  public:
    virtual ~ReflectionSource() = default;
    /// Once a frame. `renderer` is prepared with the scene; `seen`: the vehicles in its views.
    virtual void beginFrame(const FrameScene& scene, std::span<const SeenVehicle> seen,
                            SceneRenderer& renderer) = 0;
    virtual VehicleReflections forView(const View& view, const SceneRenderer& renderer) = 0;
    /// Whether what is shown depends on frames before.
    virtual bool keepsMaps() const = 0;
    virtual double mapsRebuilt() const = 0;  ///< in the last frame
    virtual std::size_t textureBytes() const = 0;
    /// The map that a vehicle (by index) was given in the last frame, with its distances, for measuring: it
    /// is read back. Nothing where distances are not those of what is shown. Good until the next call.
    virtual std::optional<ShownMap> shownMap(const FrameScene& scene, std::uint32_t vehicle) = 0;
};

/// Any of the program's methods. `rays` is what `raytrace` traces with; it must outlive the source.
std::unique_ptr<ReflectionSource> engineSource(const Scene& scene, const PreparedReflections& prepared,
                                               const ReflectionSettings& settings, RayTracer& rays);

/// What is true: each pixel mirrors what many rays through it see, over several bounces.
std::unique_ptr<ReflectionSource> tracedTruth(RayTracer& rays);
inline constexpr TraceOptions truthTracing{32, 3, false, 1};

}  // namespace app
