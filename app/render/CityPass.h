#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "app/render/CityGeometry.h"
#include "app/render/CityMaterials.h"
#include "app/render/PassTarget.h"
#include "reflection/gl/MirrorScene.h"
#include "reflection/gl/Program.h"

namespace app {

/// Draws the static city, as much of it as a view can see, nearest first.
class CityPass {
  public:
    explicit CityPass(const city::CityModel& city);

    struct Counts {
        std::uint32_t drawCalls = 0;
        std::uint64_t triangles = 0;
        std::uint32_t chunksDrawn = 0;
        std::uint32_t chunksCulled = 0;
    };
    /// The uniform block Frame must hold the same view. `tolerance`: pixels by which a level of detail may be
    /// off.
    Counts draw(const PassView& view, PassTarget target, float tolerance);

    const CityGeometry& geometry() const { return geometry_; }
    /// What the wet road mirrors, and where it lies.
    struct Wet {
        reflection::MirrorMap map;
        glm::vec2 uvPerRadian{1};  ///< texture coordinates of the map, near the middle of its image
        glm::vec2 uvPerNdc{1};     ///< the same for the view's clip coordinates over w
        double height = 0;         ///< world z of the mirror
    };
    /// Draws the ground that a view sees over itself as it looks after rain, depth as it was. Null: no map,
    /// mean light and the sun in its place.
    Counts drawWet(const PassView& view, PassTarget target, const Wet* wet);

    /// Patterns to texture unit 0, table to uniform buffer 1.
    void bindMaterials() const { materials_.bind(); }
    const CityMaterials& materials() const { return materials_; }

  private:
    struct Batch {
        std::vector<GLsizei> counts;
        std::vector<const void*> offsets;
        std::vector<GLint> baseVertices;
        void clear();
        void add(const MeshRange& range);
    };
    struct Placed {
        std::uint32_t key;  ///< prototype and level
        float distance;
        std::uint32_t placement;
    };
    void useFor(Coverage coverage, bool instanced, PassTarget target);

    std::array<std::array<reflection::gl::Program, 2>, 2>
        wetPrograms_;  ///< [target][with a map]; made when first needed
    CityGeometry geometry_;
    CityMaterials materials_;
    std::array<std::array<std::array<reflection::gl::Program, 2>, 2>, passTargetCount>
        programs_;  ///< [target][instanced][cutout]
    std::array<Batch, coverageCount> batches_;
    std::vector<std::pair<float, std::uint32_t>> order_;
    std::vector<Placed> placed_;
    std::vector<PlacementInstance> instances_;
};

}  // namespace app
