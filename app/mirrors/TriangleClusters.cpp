#include "app/mirrors/TriangleClusters.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <glm/geometric.hpp>

namespace app {

std::vector<TriangleCluster> clusterTriangles(LitMesh& mesh, std::size_t most) {
    std::vector<TriangleCluster> clusters;
    if (mesh.indices.empty()) return clusters;
    const std::size_t triangles = (most + 3) / 4 * 4, vertices = std::min<std::size_t>(3 * triangles, 255);
    const float* positions = &mesh.corners.front().position.x;
    std::vector<meshopt_Meshlet> found(meshopt_buildMeshletsBound(mesh.indices.size(), vertices, triangles));
    std::vector<unsigned int> corner(found.size() * vertices);
    std::vector<unsigned char> local(found.size() * triangles * 3);
    found.resize(meshopt_buildMeshlets(found.data(), corner.data(), local.data(), mesh.indices.data(),
                                       mesh.indices.size(), positions, mesh.corners.size(),
                                       sizeof(LitMesh::Corner), vertices, triangles, 0.5f));
    std::vector<std::uint32_t> ordered;
    ordered.reserve(mesh.indices.size());
    for (const meshopt_Meshlet& m : found) {
        TriangleCluster& cluster = clusters.emplace_back();
        cluster.first = ordered.size();
        cluster.count = std::size_t{3} * m.triangle_count;
        for (std::size_t i = 0; i < cluster.count; ++i)
            ordered.push_back(corner[m.vertex_offset + local[m.triangle_offset + i]]);
        const meshopt_Bounds b = meshopt_computeMeshletBounds(
            &corner[m.vertex_offset], &local[m.triangle_offset], m.triangle_count, positions,
            mesh.corners.size(), sizeof(LitMesh::Corner));
        cluster.centre = {b.center[0], b.center[1], b.center[2]};
        cluster.radius = b.radius;
        cluster.coneApex = {b.cone_apex[0], b.cone_apex[1], b.cone_apex[2]};
        cluster.coneAxis = {b.cone_axis[0], b.cone_axis[1], b.cone_axis[2]};
        cluster.coneCutoff = b.cone_cutoff;
    }
    mesh.indices = std::move(ordered);
    return clusters;
}

bool mayBeSeen(const TriangleCluster& cluster, const glm::dvec3& eye, const reflection::HalfSpaces& frustum) {
    // Bounds are floats: a hair more.
    constexpr double hair = 1e-4;
    const glm::dvec3 centre = glm::dvec3(cluster.centre) - eye;
    const double radius = static_cast<double>(cluster.radius) * (1 + hair);
    if (!reflection::touches(frustum, centre, radius)) return false;
    const glm::dvec3 way = glm::dvec3(cluster.coneApex) - eye;
    const double along = glm::dot(way, glm::dvec3(cluster.coneAxis));
    return !(along > (static_cast<double>(cluster.coneCutoff) + hair) * glm::length(way));
}

}  // namespace app
