#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/frame/ChromeDrawing.h"
#include "app/frame/Detail.h"
#include "app/frame/FrameScene.h"
#include "app/frame/MirrorPlan.h"
#include "app/frame/SunMap.h"
#include "city/model/CityModel.h"
#include "city/model/GlassFronts.h"
#include "reflection/gl/LocalMapTextures.h"
#include "reflection/gl/SceneDrawer.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

struct ChromePlan;
struct CloseScene;

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
    std::uint32_t mirrorPasses = 0;        ///< reflections drawn for windows
    std::uint64_t mirrorTriangles = 0;     ///< in them
    std::uint64_t mirrorTextureBytes = 0;  ///< colour and depth of their maps, held now
    ChromeCounts chrome;                   ///< close things in chrome
    std::uint64_t chromeTextureBytes = 0;  ///< of the images for them, held now
};

/// How the vehicles of a frame reflect.
struct VehicleReflections {
    reflection::LocalMapTextures textures;
    std::vector<reflection::LocalMapSlot> slots;  ///< one per FrameScene::vehicles; empty: all plain paint
    /// GL name of a ScreenLight's texture for this view: what each pixel mirrors, in place of all maps. 0:
    /// none.
    std::uint32_t mirrored = 0;
    /// Maps that are not what they were when this renderer drew before; nothing: any may be. What shows them
    /// and did not move is not drawn again while they stay.
    std::optional<std::vector<reflection::LocalMapSlot>> renewed = {};
};

/// What the city's windows mirror in a view.
struct PlanarReflections {
    const MirrorPlan* plan = nullptr;  ///< null: glass is as it is painted on the walls
    std::uint32_t root = 0;            ///< of the plan's tree: this view
    bool wet = false;                  ///< it has rained: ground that no map serves shines by mean light
};

/// What chrome shows of close things in a view.
struct CloseReflections {
    const ChromePlan* plan = nullptr;  ///< null: all chrome mirrors its vehicle's map
    std::uint32_t view = 0;            ///< of the plan: this view
    ChromeDrawing drawing = {};
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
    /// `dissolveFrames`: where the next view is the one that was drawn last, in the same light, the change is
    /// not seen at once: for so many frames, ever more of the picture shows the new detail, and what moves
    /// shows it from the start. Its cost is the new one's at once. In another view it is seen at once, for
    /// there all changes.
    void setDetail(const DrawingDetail& detail, int dissolveFrames = 0);
    /// Makes now what changes of detail would wait for when they first come, for views of this size.
    void prepareForChanges(glm::ivec2 size);
    /// Whether it is this view, in the prepared scene's light, that was drawn last.
    bool drewLast(const View& view) const;

    /// The city's glass, to which the indices of mirror plans refer; empty: none. Without it plans are
    /// ignored.
    void setGlass(std::span<const city::GlassFront> fronts);

    /// Draws one of the prepared scene's views, tone mapped, into a framebuffer (0: the window), sRGB-encoded
    /// 8 bit. With a mirror plan: the reflections it lists first, each into its level's map, and glass
    /// without a map by mean light. Textures for maps are kept while plans use them.
    void drawView(const View& view, const VehicleReflections& reflections, std::uint32_t framebuffer,
                  const PlanarReflections& planar = {}, const CloseReflections& close = {});

    /// The chrome, and what may be close to it, to which plans of close reflections refer; null: none.
    /// Without it such plans are ignored. Keeps the pointer. What drawing them needs is made when a plan
    /// first has jobs, and given back after a second's worth of frames without any.
    void setCloseScene(const CloseScene* scene);

    /// Whether a box is surely hidden by buildings from an eye that may look through a mirror: what
    /// MirrorPlanner asks. Answers for the eyes of one frame are kept until `prepare`.
    bool hides(const reflection::EyeView& from, const reflection::HalfSpace* glass,
               const city::Aabb& box) const;

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
    /// The same with the vehicles that are seen in the plan's mirrors, at half their size there: they too
    /// mirror the street, and what shows them is dim.
    std::vector<VisibleVehicle> visibleVehicles(const View& view, const PlanarReflections& planar) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
