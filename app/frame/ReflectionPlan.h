#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <span>
#include <vector>

#include "app/frame/FrameScene.h"
#include "reflection/local_map/LocalMapSlot.h"

namespace app {

/// A vehicle that the frame's views show.
struct SeenVehicle {
    std::uint32_t index = 0;   ///< into FrameScene::vehicles
    float diameterPixels = 0;  ///< projected, the greatest over all views
};

/// One local map to build this frame.
struct MapJob {
    std::uint32_t vehicle = 0;  ///< index into FrameScene::vehicles
    reflection::LocalMapSlot slot;
    glm::dvec3 centre{0};  ///< world metres
    float error = 0;       ///< estimated error on screen if not built, pixels; infinite for a new map
};

/// What the reflections of one frame need: plain data, made without a GPU. A map that a scene does not need
/// is not in it.
struct ReflectionPlan {
    std::vector<MapJob> jobs;  ///< most urgent first
    std::vector<reflection::LocalMapSlot>
        slots;                     ///< one per FrameScene::vehicles; invalid: not reflected this frame
    std::uint32_t visible = 0;     ///< vehicles seen
    std::uint32_t fresh = 0;       ///< maps kept because their error on screen is below the threshold
    std::uint32_t postponed = 0;   ///< maps that the budget left for a later frame
    std::uint32_t shared = 0;      ///< vehicles that show a neighbour's map
    std::uint32_t borrowed = 0;    ///< of these, new vehicles: they show a neighbour's map until then
    std::uint32_t crowdedOut = 0;  ///< vehicles without a map because every place for one is taken
    std::uint64_t texels = 0;      ///< to be built
};

/// Maps that the plan builds anew.
inline std::vector<reflection::LocalMapSlot> renewedBy(const ReflectionPlan& plan) {
    std::vector<reflection::LocalMapSlot> slots;
    for (const MapJob& job : plan.jobs) slots.push_back(job.slot);
    return slots;
}

struct PlanOptions {
    std::uint64_t texelBudget =
        80'000;                   ///< texels built a frame; at least one map is built whatever it costs
    float texelsPerPixel = 0.5f;  ///< face size wanted for each pixel of the vehicle's projected diameter
    float errorThreshold = 0.5f;  ///< pixels of shift of a reflected feature that are let stand
    /// Share of its vehicle's own motion by which a map ages: less than 1 where it is looked up with
    /// parallax, since it stays right for all that its centre saw.
    float ownMotion = 1;
    bool everyFrame = false;  ///< rebuild all visible maps every frame (measuring; the paper's way)
    /// Maps of one size class at most: what every OpenGL 4.5 grants (table 23.53: arrays of 2048 layers, six
    /// a cube).
    int layersAtMost = 341;
    bool share = true;  ///< a vehicle may show a neighbour's map where that is within the threshold
    /// Not 0: in turn, whatever their errors: vehicles without a map, and so many maps besides, the oldest
    /// first. Budget and threshold do not matter then, and nothing is shared.
    std::uint32_t mapsInTurn = 0;
    int sizeClass = -1;  ///< not -1: of all maps, whatever the vehicles' sizes on screen
};

/// Decides which local maps are built when. Keeps what it planned before: a map's age is the distance that
/// its vehicle and its neighbours have moved since. Deterministic.
///
/// The error on screen of a map grows with that distance: a feature at distance r seen from a centre that is
/// off by s turns by about s / r, and a mirror that shows the half space over D pixels shifts it by about D s
/// / (pi r). r is not known for each feature; a street's half width stands for it. By the same measure the
/// map of a neighbour at distance s may do for a vehicle: in practice for those of a few pixels, of which a
/// long street has many. A map of what stands in the city (StandingReflectors.h) is built when it comes into
/// view, and again when something passes by.
class ReflectionPlanner {
  public:
    /// Forgets all maps: after a change of city, light or method.
    void reset();

    /// `seen`: vehicles in the views. `models`: height of each model's reflection centre above the road.
    ReflectionPlan plan(const FrameScene& scene, std::span<const SeenVehicle> seen,
                        std::span<const float> centreHeights, const PlanOptions& options);

    /// Layers in use of each size class: what the atlas must hold.
    std::span<const int> layersNeeded() const { return layers_; }

  private:
    struct Held {
        reflection::LocalMapSlot slot;
        glm::dvec3 centre{0};
        double neighbourMotion =
            0;  ///< metres that neighbours moved since the map was built, weighted by nearness
        std::uint64_t lastSeen = 0;
        std::uint64_t lastBuilt = 0;
        bool built = false;
    };
    /// The map of least error on this vehicle among the lenders' that is below the threshold, or null.
    static const Held* lenderFor(const MapJob& job, float diameterPixels, float threshold,
                                 std::span<const Held* const> lenders);
    /// The lender that is nearest to a place, in the same street; null where none is.
    static const Held* nearestOf(std::span<const Held* const> lenders, const glm::dvec3& centre);
    /// A class with a free place: the wanted one, else the next coarser one, else a finer one that costs no
    /// more than `texels`; -1: none.
    int classWithRoom(int wanted, int layersAtMost, std::uint64_t texels) const;
    void countMotion(const FrameScene& scene, double elapsed);
    reflection::LocalMapSlot allocate(int sizeClass);
    void release(reflection::LocalMapSlot slot);

    std::map<std::uint32_t, Held> held_;  ///< by vehicle id, ordered: the plan must not depend on hashing
    std::vector<std::vector<std::int16_t>> free_ =
        std::vector<std::vector<std::int16_t>>(reflection::localMapFaceSizes.size());
    std::vector<int> layers_ = std::vector<int>(reflection::localMapFaceSizes.size(), 0);
    std::uint64_t frame_ = 0;
    double lastTime_ = 0;
};

/// Class of map for a vehicle of this projected diameter: the coarsest whose face has `texelsPerPixel` texels
/// a pixel, with a class held before kept until the size is a fifth beyond its bounds, so that a vehicle on
/// the border does not flip.
int sizeClassFor(float diameterPixels, float texelsPerPixel, int held = -1);

}  // namespace app
