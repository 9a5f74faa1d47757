#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "app/render/VertexFormats.h"
#include "city/geometry/Aabb.h"
#include "city/model/CityModel.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/VertexArray.h"

namespace app {

/// How a part of a mesh must be drawn.
enum class Coverage : std::uint8_t {
    solid,     ///< opaque, seen from its front
    twoSided,  ///< opaque, seen from both sides
    cutout,    ///< seen from both sides, with holes where the pattern is transparent
    count
};
inline constexpr std::size_t coverageCount = static_cast<std::size_t>(Coverage::count);

/// The city's meshes on the GPU: one vertex and one index buffer for everything, and where each chunk and
/// each level of each prototype lies in them. Made once.
class CityGeometry {
  public:
    using Ranges = std::array<MeshRange, coverageCount>;

    struct Chunk {
        city::Aabb bounds;
        Ranges ranges;
        city::ChunkKind kind = city::ChunkKind::building;
        bool onlyShadow = false;  ///< a standing reflector: views draw it otherwise
    };
    struct Level {
        Ranges ranges;
        float error = 0;  ///< metres
    };
    struct Prototype {
        std::vector<Level> levels;
        city::Aabb bounds;    ///< prototype's frame
        glm::vec3 centre{0};  ///< bounding sphere in the prototype's frame
        float radius = 0;
    };
    struct Placement {
        std::uint32_t prototype = 0;
        PlacementInstance instance;
        glm::vec3 centre{0};  ///< bounding sphere, world
        float radius = 0;
        city::Aabb bounds;  ///< world
        float scale = 1;    ///< largest stretch of the transform
    };

    explicit CityGeometry(const city::CityModel& city);

    /// Of everything, placements with the whole of their bounding spheres.
    const city::Aabb& bounds() const { return bounds_; }
    const std::vector<Chunk>& chunks() const { return chunks_; }
    const std::vector<Prototype>& prototypes() const { return prototypes_; }
    const std::vector<Placement>& placements() const { return placements_; }

    const reflection::gl::VertexArray& chunkArray() const { return chunkArray_; }
    /// Expects the instances in `instances()` at vertex binding 1.
    const reflection::gl::VertexArray& instancedArray() const { return instancedArray_; }
    reflection::gl::Buffer& instances() { return instances_; }

  private:
    city::Aabb bounds_;
    std::vector<Chunk> chunks_;
    std::vector<Prototype> prototypes_;
    std::vector<Placement> placements_;
    reflection::gl::Buffer vertices_;
    reflection::gl::Buffer indices_;
    reflection::gl::Buffer instances_;
    reflection::gl::VertexArray chunkArray_;
    reflection::gl::VertexArray instancedArray_;
};

}  // namespace app
