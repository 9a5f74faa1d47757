#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "reflection/planar/Portal.h"

namespace app {

/// Some neighbouring triangles of a mesh that are left out together where an eye sees none of them.
struct TriangleCluster {
    std::size_t first = 0, count = 0;  ///< of the mesh's indices
    glm::vec3 centre{0};               ///< of a ball that holds them, world
    float radius = 0;
    /// An eye to whom the way to the apex runs along the axis, by more than the cutoff, sees their backs.
    glm::vec3 coneApex{0}, coneAxis{0, 0, 1};
    float coneCutoff = 1;
};

/// Puts a mesh's indices in the order of clusters of at most `most` triangles (meshoptimizer: near each
/// other, and facing alike). Which triangles there are, and their winding, stays. Preconditions: 4 <= most <=
/// 512.
std::vector<TriangleCluster> clusterTriangles(LitMesh& mesh, std::size_t most = 32);

/// Whether some of the cluster may be seen: false only where all its triangles are outside `frustum`
/// (relative to the eye, as all of Portal.h), or show the eye their backs.
bool mayBeSeen(const TriangleCluster& cluster, const glm::dvec3& eye, const reflection::HalfSpaces& frustum);

}  // namespace app
