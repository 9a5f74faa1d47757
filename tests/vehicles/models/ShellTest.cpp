#include "vehicles/models/Shell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "vehicles/models/Cage.h"
#include "vehicles/models/Levels.h"
#include "vehicles/models/Outline.h"

namespace vehicles {
namespace {

/// A flat square of n x n cells, y = 0 .. 1 and x = 0 .. 1, facing up.
Shell square(int n) {
    Shell shell;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            shell.positions.push_back({static_cast<float>(i) / static_cast<float>(n),
                                       static_cast<float>(j) / static_cast<float>(n), 0});
            shell.normals.push_back({0, 0, 1});
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1,
                       c = b + static_cast<std::uint32_t>(n + 1), d = c - 1;
            shell.triangles.push_back({{a, b, c}, Surface::paint});
            shell.triangles.push_back({{a, c, d}, Surface::paint});
        }
    return shell;
}

float areaOf(const Shell& shell, Surface surface) {
    float area = 0;
    for (const auto& t : shell.triangles)
        if (t.surface == surface)
            area += 0.5f * glm::cross(shell.positions[t.corner[1]] - shell.positions[t.corner[0]],
                                      shell.positions[t.corner[2]] - shell.positions[t.corner[0]])
                               .z;
    return area;
}

/// Edges used once must lie on the square's outline: a cut opens no crack.
int openEdgesInside(const Shell& shell) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const auto& t : shell.triangles)
        for (int k = 0; k < 3; ++k) ++uses[std::minmax(t.corner[k], t.corner[(k + 1) % 3])];
    int open = 0;
    for (const auto& [edge, count] : uses) {
        if (count == 2) continue;
        const glm::vec3 m = 0.5f * (shell.positions[edge.first] + shell.positions[edge.second]);
        open += m.x > 1e-5f && m.x < 1 - 1e-5f && m.y > 1e-5f && m.y < 1 - 1e-5f;
    }
    return open;
}

const Field disc = [](const glm::vec3& p, const glm::vec3&) {
    return std::hypot(p.x - 0.47f, p.y - 0.52f) - 0.31f;
};

TEST(Shell, CutsADiscOfTheRightAreaWithoutCracks) {
    Shell shell = square(7);
    shell.refine(disc, 0.02f);
    shell.assign(disc, Surface::glass);
    const float exact = 3.14159265f * 0.31f * 0.31f;
    EXPECT_NEAR(areaOf(shell, Surface::glass), exact, 0.01f * exact);
    EXPECT_NEAR(areaOf(shell, Surface::glass) + areaOf(shell, Surface::paint), 1, 1e-4f);
    EXPECT_EQ(openEdgesInside(shell), 0);
}

TEST(Shell, DrawsALineThinnerThanItsTriangles) {
    Shell shell = square(4);
    shell.refine(disc, 0.03f);
    shell.assignLine(disc, 0.004f, Surface::trim);
    const float exact = 2 * 3.14159265f * 0.31f * 0.008f;
    EXPECT_NEAR(areaOf(shell, Surface::trim), exact, 0.06f * exact);
    EXPECT_EQ(openEdgesInside(shell), 0);
}

TEST(Shell, RespectsTheSurfacesItMayDrawOver) {
    Shell shell = square(6);
    shell.assign(disc, Surface::glass);
    const float glass = areaOf(shell, Surface::glass);
    shell.assign([](const glm::vec3& p, const glm::vec3&) { return p.x - 0.5f; }, Surface::trim,
                 {Surface::paint});
    EXPECT_NEAR(areaOf(shell, Surface::glass), glass, 1e-4f);
    EXPECT_GT(areaOf(shell, Surface::trim), 0.2f);
}

TEST(Shell, MirrorsAcrossThePlaneAndSharesTheSeam) {
    Shell shell = square(3);
    const std::size_t before = shell.positions.size();
    shell.mirror();
    EXPECT_EQ(shell.positions.size(), 2 * before - 4);
    EXPECT_NEAR(areaOf(shell, Surface::paint), 2, 1e-4f);
}

TEST(Outline, MeasuresDistancesToASquareExactly) {
    const Outline o({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, 0);
    EXPECT_NEAR(o.distance({1, 1}), -1, 1e-6f);
    EXPECT_NEAR(o.distance({1, 1.75f}), -0.25f, 1e-6f);
    EXPECT_NEAR(o.distance({1, 2.25f}), 0.25f, 1e-6f);
    EXPECT_NEAR(o.distance({2.2f, 2.2f}), 0.2f * std::sqrt(2.0f), 1e-6f);
    EXPECT_GT(o.distance({9, 9}), 0.3f);  // far off: a lower bound
    EXPECT_LE(o.distance({9, 9}), 7 * std::sqrt(2.0f));
}

/// Oracle: the limit of a Catmull-Clark surface does not depend on how often it is refined before the limit
/// is taken.
TEST(Cage, LimitPointsStayWhereTheyAreAtEveryDepth) {
    Cage cage;
    for (const float x : {1.0f, 0.4f, -0.4f, -1.0f})
        cage.stations.push_back({{x, 1},
                                 {x, .6f, .95f},
                                 {x, .8f, .8f},
                                 {x, .85f, .6f},
                                 {x, .85f, .4f},
                                 {x, .8f, .2f},
                                 {x, .6f, .1f}});
    cage.frontX = {0, 1.1f, 1.15f, 1.15f, 1.1f, 1};
    cage.rearX = {0, -1.1f, -1.15f, -1.15f, -1.1f, -1};
    const Extent extent{.rear = -2, .front = 2, .width = 1.6f, .floor = 0, .top = 1};
    const Shell coarse = subdivide(cage, extent, 1), fine = subdivide(cage, extent, 3);
    float worst = 0;
    std::size_t used = 0;
    std::vector<bool> seen(coarse.positions.size());
    for (const auto& t : coarse.triangles)
        for (const auto c : t.corner) {
            if (seen[c]) continue;
            seen[c] = true;
            ++used;
            float best = 1e9f;
            std::size_t at = 0;
            for (std::size_t i = 0; i < fine.positions.size(); ++i)
                if (const float d = glm::length(fine.positions[i] - coarse.positions[c]); d < best)
                    best = d, at = i;
            worst = std::max(worst, best);
            EXPECT_GT(glm::dot(fine.normals[at], coarse.normals[c]), 0.995f);
        }
    EXPECT_GT(used, 100u);
    // The extreme points that set the scale are found a little more exactly on the finer one.
    EXPECT_LT(worst, 0.02f);
}

TEST(Cage, NormalsFollowTheTrianglesAndFaceOutwards) {
    Cage cage;
    for (const float x : {1.0f, 0.4f, -0.4f, -1.0f})
        cage.stations.push_back({{x, 1},
                                 {x, .6f, .95f},
                                 {x, .8f, .8f},
                                 {x, .85f, .6f},
                                 {x, .85f, .4f},
                                 {x, .8f, .2f},
                                 {x, .6f, .1f}});
    cage.frontX = {0, 1.1f, 1.15f, 1.15f, 1.1f, 1};
    cage.rearX = {0, -1.1f, -1.15f, -1.15f, -1.1f, -1};
    const Shell shell = subdivide(cage, {.rear = -1, .front = 1, .width = 1.6f, .floor = 0, .top = 1}, 3);
    for (const auto& t : shell.triangles) {
        const glm::vec3 a = shell.positions[t.corner[0]], b = shell.positions[t.corner[1]],
                        c = shell.positions[t.corner[2]];
        const glm::vec3 flat = glm::normalize(glm::cross(b - a, c - a));
        for (const auto k : t.corner) EXPECT_GT(glm::dot(flat, shell.normals[k]), 0.7f);
        EXPECT_GT(glm::dot(flat, (a + b + c) / 3.0f - glm::vec3(0, 0, 0.5f)), 0);
    }
}

TEST(Levels, DistanceBetweenFindsTheFarthestPoint) {
    city::Mesh flat, bumped;
    const auto v = [](float x, float y, float z) { return city::Vertex{{x, y, z}, {0, 0, 1}, {}, 0}; };
    flat.addQuad(v(0, 0, 0), v(1, 0, 0), v(1, 1, 0), v(0, 1, 0));
    bumped.addTriangle(v(0, 0, 0), v(1, 0, 0), v(.5f, .5f, 0.3f));
    bumped.addTriangle(v(.5f, .5f, 0.3f), v(1, 0, 0), v(1, 1, 0));
    EXPECT_NEAR(distanceBetween(flat, flat), 0, 1e-6f);
    EXPECT_NEAR(distanceBetween(bumped, flat, 100), 0.3f, 1e-5f);
    EXPECT_TRUE(std::isinf(distanceBetween(flat, {})));
    EXPECT_EQ(distanceBetween({}, flat), 0);
}

TEST(Levels, ThinPiecesTakeTheirNeighboursSurface) {
    Shell shell = square(8);
    shell.refine(disc, 0.03f);
    shell.assignLine(disc, 0.004f, Surface::trim);
    const city::Mesh merged = withoutThinPieces(shell.mesh(), 0.02f);
    for (const auto& vertex : merged.vertices)
        EXPECT_EQ(vertex.material, static_cast<std::uint32_t>(Surface::paint));
    EXPECT_EQ(merged.triangleCount(), shell.mesh().triangleCount());
    bool kept = false;
    for (const auto& vertex : withoutThinPieces(shell.mesh(), 0.002f).vertices)
        kept |= vertex.material == static_cast<std::uint32_t>(Surface::trim);
    EXPECT_TRUE(kept);
}

}  // namespace
}  // namespace vehicles
