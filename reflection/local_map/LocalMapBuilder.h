#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "reflection/local_map/LocalMap.h"
#include "reflection/local_map/LocalMapMesh.h"
#include "reflection/local_map/ReferenceLookup.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// How the texels of a local map are made from reference maps.
enum class LocalMapMethod : std::uint8_t {
    blend,     ///< the two nearest maps mixed by direction alone (the paper's figure 9 a)
    box,       ///< parallax corrected by a street-aligned box around the nearest map
    memPaper,  ///< Meyer & Loscos 2003: heightfield hits at mesh vertices, two maps, depth test
    mem,       ///< ours: planarity mesh, hits refined against several maps
};

/// A box aligned with the street, as parallax correction takes it: open above.
struct StreetBox {
    glm::vec3 forward{1, 0, 0};                            ///< unit, horizontal
    float ahead = 50, behind = 50, left = 10, right = 10;  ///< metres from the map's centre
    float below = 1.6f;
};

/// Estimates the box from the map's own distances: the median over the texels near each of the four
/// horizontal directions and below.
StreetBox streetBoxOf(const PackedReferenceMap& map, const glm::vec3& forward);

struct LocalMapRequest {
    LocalMapMethod method = LocalMapMethod::mem;
    glm::dvec3 centre{0};                   ///< world metres
    int faceSize = 128;                     ///< texels
    std::span<const Candidate> candidates;  ///< best first; blend and memPaper take two (one is enough)
    MeshOptions mesh;
    LookupOptions lookup;
    float depthTolerance =
        1.5f;  ///< memPaper's depth test, metres: a heightfield hit may be off by a cell's diagonal
    glm::vec3 streetDirection{1, 0, 0};  ///< box: along the lane
};

/// Builds local maps; reusable, keeps its buffers. One builder a thread.
class LocalMapBuilder {
  public:
    /// Fills one face of `map`, which must have the request's face size. Without candidates the face becomes
    /// black sky. Returns the rays traced.
    std::uint32_t buildFace(const GridTracer& tracer, const LocalMapRequest& request, int face,
                            LocalMap& map);

    /// What `buildFace` starts the texels of a face from, for those who look colours up elsewhere: the mesh's
    /// 1/t, faceSize^2 values, 0 for sky. The method must be mem. Returns the rays traced.
    std::uint32_t buildStarts(const GridTracer& tracer, const LocalMapRequest& request, int face,
                              std::span<float> reciprocal);

    /// The mesh of the face built last (memPaper and mem).
    const LocalMapMesh& mesh() const { return mesh_; }

  private:
    void fillReciprocal(int faceSize);
    /// Where quads' borders are texels' borders and no quad has more than 16 x 16 texels, a power of two.
    void fillAligned(int faceSize, int texelsPerUnit);
    void fillPaper(const LocalMapRequest& request, int face);
    void fillBlend(const LocalMapRequest& request, int face);
    void fillBox(const LocalMapRequest& request, int face);
    void resizePlanes(int faceSize);

    LocalMapMesh mesh_;
    std::vector<float> reciprocal_;
    std::vector<float> px_, py_, pz_, weight_;
};

}  // namespace reflection
