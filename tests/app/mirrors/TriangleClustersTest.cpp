// Clusters of triangles: none is lost, and none that an eye sees is left out.
#include "app/mirrors/TriangleClusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "app/mirrors/LitShapes.h"

namespace app {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::vector<Triangle> trianglesOf(const LitMesh& mesh) {
    std::vector<Triangle> all;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Triangle t{mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        all.push_back(t);
    }
    std::sort(all.begin(), all.end());
    return all;
}

TEST(TriangleClusters, KeepEveryTriangleAndItsWindingOnce) {
    for (LitMesh mesh :
         {litBall({1, 2, 3}, 2, 40, 22, glm::vec3(1)), litBox({0, 0, 0}, {1, 2, 3}, glm::vec3(1)),
          litPanel({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, 16, 16, glm::vec3(1), glm::vec3(0))}) {
        const std::vector<Triangle> before = trianglesOf(mesh);
        const auto clusters = clusterTriangles(mesh);
        EXPECT_EQ(trianglesOf(mesh), before);
        std::size_t next = 0;
        for (const TriangleCluster& c : clusters) {
            EXPECT_EQ(c.first, next);
            EXPECT_LE(c.count, 96u);
            next += c.count;
        }
        EXPECT_EQ(next, mesh.indices.size());
    }
    LitMesh none;
    EXPECT_TRUE(clusterTriangles(none).empty());
}

TEST(TriangleClusters, LeaveOutNothingThatAnEyeSees) {
    std::mt19937_64 random(5);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::size_t leftOut = 0, triangles = 0;
    for (LitMesh mesh :
         {litBall({1, 2, 3}, 2, 40, 22, glm::vec3(1)), litPillar({0, 0, 0}, 0.4f, 3, 24, glm::vec3(1)),
          litPanel({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, 16, 16, glm::vec3(1), glm::vec3(0))}) {
        const auto clusters = clusterTriangles(mesh);
        for (int round = 0; round < 300; ++round) {
            const glm::dvec3 eye(20 * unit() - 10, 20 * unit() - 10, 20 * unit() - 10);
            const glm::dvec3 target(4 * unit(), 4 * unit(), 4 * unit());
            const reflection::HalfSpaces frustum =
                reflection::frustumOf(reflection::perspectiveView(eye, target, 0.4 + unit(), 1.3));
            for (const TriangleCluster& c : clusters) {
                triangles += c.count / 3;
                if (mayBeSeen(c, eye, frustum)) continue;
                leftOut += c.count / 3;
                for (std::size_t i = c.first; i < c.first + c.count; i += 3) {
                    std::array<glm::dvec3, 3> p;
                    for (std::size_t k = 0; k < 3; ++k)
                        p[k] = glm::dvec3(mesh.corners[mesh.indices[i + k]].position) - eye;
                    if (glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), p[0]) >= 0) continue;  // its back
                    EXPECT_TRUE(reflection::clipped({p.begin(), p.end()}, frustum).empty());
                }
            }
        }
    }
    // Of a ball in view, the half that is turned away; of a panel seen from behind, all.
    EXPECT_GT(leftOut, triangles * 2 / 5);
    EXPECT_LT(leftOut, triangles);
}

}  // namespace
}  // namespace app
