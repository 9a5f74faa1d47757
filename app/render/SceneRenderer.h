#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/frame/Detail.h"
#include "app/frame/FrameScene.h"
#include "app/frame/SunMap.h"
#include "city/model/CityModel.h"
#include "reflection/gl/LocalMapTextures.h"
#include "reflection/gl/SceneDrawer.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

enum class Antialiasing : std::uint8_t { none, fxaa, msaa4 };

struct RenderOptions {
    Antialiasing antialiasing = Antialiasing::fxaa;
    bool shadows = true;
    bool occlusionCulling = true;
};

struct RenderCounters {
    std::uint32_t drawCalls = 0;
    std::uint64_t triangles = 0;
    std::uint32_t chunksDrawn = 0;
    std::uint32_t chunksCulled = 0;
    std::uint32_t vehiclesDrawn = 0;
};

/// How the vehicles of a frame reflect.
struct VehicleReflections {
    reflection::LocalMapTextures textures;
    std::vector<reflection::LocalMapSlot> slots;  ///< one per FrameScene::vehicles; empty: all plain paint
    /// GL name of a ScreenLight's texture for this view: what each pixel mirrors, in place of all maps. 0:
    /// none.
    std::uint32_t mirrored = 0;
};

/// Draws city and vehicles with OpenGL 4.5. Owns the GL objects of one city and one set of vehicle models;
/// needs the same context current in every call.
class SceneRenderer final : public reflection::SceneDrawer {
  public:
    SceneRenderer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                  const RenderOptions& options);
    ~SceneRenderer() override;

    /// Takes over this frame's vehicles, lights and signal states. Call once a frame, before any drawing.
    void prepare(const FrameScene& scene);

    /// Of all views from now on. Costs nothing to change.
    void setDetail(const DrawingDetail& detail);

    /// Draws one of the prepared scene's views, tone mapped, into a framebuffer (0: the window), sRGB-encoded
    /// 8 bit.
    void drawView(const View& view, const VehicleReflections& reflections, std::uint32_t framebuffer);

    void drawCube(const glm::dvec3& centre, const reflection::CubeTarget& target,
                  const reflection::CubeContent& content) override;

    /// The shadows of the prepared scene's sun, read back: for rays that are to see the same. Waits for the
    /// GPU; up to 128 MiB. Empty without shadows.
    std::shared_ptr<const SunMap> sunMap();

    const RenderCounters& counters() const;  ///< of the last drawView

    /// Which vehicles of the prepared scene lie in the view and are not hidden by buildings: (index,
    /// projected diameter in pixels) pairs. What the plan is made from.
    struct VisibleVehicle {
        std::uint32_t index;
        float diameterPixels;
    };
    std::vector<VisibleVehicle> visibleVehicles(const View& view) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
