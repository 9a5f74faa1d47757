#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "app/mirrors/TriangleClusters.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/Portal.h"

namespace app {

/// A MirrorWorld's triangles in one pair of buffers: position, normal and colour at locations 0 to 2, mirrors
/// in the colour that they have without a map.
class MirrorWorldGeometry {
  public:
    struct Range {
        std::size_t first = 0, count = 0;       ///< of the indices
        std::vector<TriangleCluster> clusters;  ///< its parts, where it is large
    };
    /// `longest`: edges are cut to that length, for projections that bend them; 0: left alone.
    MirrorWorldGeometry(const MirrorWorld& world, float longest);

    void bind() const { array_.bind(); }
    GLuint arrayName() const { return array_.name(); }

    std::vector<Range> objects, mirrors, curved;

  private:
    reflection::gl::Buffer vertices_, indices_;
    reflection::gl::VertexArray array_;
};

/// Ranges to be drawn in one call.
class MirrorDrawList {
  public:
    void clear();
    void add(const MirrorWorldGeometry::Range& range) { addPart(range.first, range.count); }
    /// What an eye sees of it, by clusters; all of it where `frustum` is empty, as nothing is culled then.
    void addSeen(const MirrorWorldGeometry::Range& range, const glm::dvec3& eye,
                 const reflection::HalfSpaces& frustum);
    /// Draws them from the geometry that is bound, with the program in use, and counts their triangles.
    void draw();
    std::uint64_t trianglesDrawn() const { return triangles_; }  ///< since the beginning

  private:
    void addPart(std::size_t first, std::size_t count);

    std::vector<GLsizei> counts_;
    std::vector<const void*> offsets_;
    std::size_t end_ = 0;  ///< of the last one
    std::uint64_t triangles_ = 0;
};

}  // namespace app
