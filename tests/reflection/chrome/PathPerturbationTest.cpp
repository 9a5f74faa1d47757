#include "reflection/chrome/PathPerturbation.h"

#include <gtest/gtest.h>

#include "reflection/chrome/BuildReflectorMap.h"
#include "reflection/chrome/CellInterpolation.h"
#include "reflection/chrome/ReflectionSearch.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

TEST(PathPerturbation, SlopesAreThoseOfSearchesNearby) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({1, .7, .5}), 100), {.1, 0, 0}, Bend::convex).map;
    const glm::dvec3 eye(3, -2, 1);
    std::mt19937_64 random(5);
    std::size_t compared = 0;
    for (int k = 0; k < 300; ++k) {
        const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2 - 1; };
        const glm::dvec3 v = 3.0 * glm::dvec3(unit(), unit(), unit());
        // Differences over a step that bends by less than a thousandth.
        constexpr double step = 1e-3;
        std::array<glm::dvec3, 7> around{v};
        for (int a = 0; a < 3; ++a) {
            glm::dvec3 d(0);
            d[a] = step;
            around[static_cast<std::size_t>(2 * a + 1)] = v + d;
            around[static_cast<std::size_t>(2 * a + 2)] = v - d;
        }
        std::array<ReflectionPoint, 7> r;
        findReflectionPoints(map, eye, around, r);
        bool seen = true;
        for (const ReflectionPoint& p : r) seen = seen && p.status == ReflectionStatus::found;
        if (!seen || glm::length(v - r[0].point) < 0.2) continue;
        PathImage image;
        perturbPaths(map, eye, glm::dmat3(1), std::span(around).first(1), std::span(&r[0].point, 1),
                     std::span(&image, 1));
        EXPECT_EQ(image.turn, -1);
        const auto at = [&](std::size_t i) {
            return glm::dvec4(virtualVertex(r[i], around[i]) - eye,
                              glm::dot(r[i].normal, glm::normalize(eye - r[i].point)));
        };
        EXPECT_LT(glm::length(glm::dvec4(image.image) - at(0)), 1e-5);
        for (std::size_t a = 0; a < 3; ++a) {
            const glm::dvec4 slope = (at(2 * a + 1) - at(2 * a + 2)) / (2 * step);
            // Cells of the map have slopes of their own on both sides of a border.
            EXPECT_LT(glm::length(glm::dvec4(image.by[a]) - slope), 0.05 * glm::length(slope) + 0.02);
        }
        ++compared;
    }
    EXPECT_GT(compared, 100U);
}

TEST(PathPerturbation, ImagesGoOnSmoothlyPastTheOutline) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 100), {0, 0, 0}, Bend::convex).map;
    const glm::dvec3 eye(4, 0, 0);
    glm::dvec3 from(0.2, 1, 0);
    glm::vec4 last(0), move(0);
    int hidden = 0;
    for (int k = 0; k < 36; ++k) {
        const glm::dvec3 v(-5, 2.8 - 0.05 * k, 0.1);
        ReflectionPoint r;
        findReflectionPoints(map, eye, std::span(&v, 1), std::span(&r, 1));
        if (r.status == ReflectionStatus::found) from = r.point;
        hidden += r.status == ReflectionStatus::hidden;
        PathImage image;
        perturbPaths(map, eye, glm::dmat3(1), std::span(&v, 1), std::span(&from, 1), std::span(&image, 1));
        ASSERT_EQ(image.turn, -1) << k;
        EXPECT_EQ(image.image.w > 0, r.status == ReflectionStatus::found) << k;
        if (k > 1) {
            EXPECT_LT(glm::length(image.image - last - move), 0.12f * glm::length(move) + 1e-4f) << k;
        }
        move = image.image - last;
        last = image.image;
    }
    EXPECT_GT(hidden, 10);
}

TEST(CellInterpolation, IsExactForCubicsAndAsItsSlowOracle) {
    // A mesh with an axis in which it has no extent, one with a vertex that is not finite.
    for (const bool flat : {false, true}) {
        std::vector<glm::vec3> points;
        std::mt19937_64 random(9);
        const auto unit = [&] { return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53); };
        for (int k = 0; k < 700; ++k) points.emplace_back(2 * unit(), unit(), flat ? 0.5f : 3 * unit());
        points.push_back(glm::vec3(NAN));
        const CellTree tree(points, 20);
        // A cubic along each axis, a constant besides.
        const auto value = [](const glm::vec3& p) {
            return glm::vec4(1 + p.x * p.x * p.x - p.y, p.y * p.y - 2 * p.z, p.x * p.y * p.z, 0.5f);
        };
        std::vector<PathImage> atNodes;
        for (const glm::vec3& p : tree.nodes()) {
            PathImage image;
            image.image = value(p);
            image.by = {glm::vec4(3 * p.x * p.x, 0, p.y * p.z, 0), glm::vec4(-1, 2 * p.y, p.x * p.z, 0),
                        glm::vec4(0, -2, p.x * p.y, 0)};
            atNodes.push_back(image);
        }
        std::vector<SmoothCell> leaves;
        std::size_t covered = 0;
        for (std::uint32_t k = 0; k < tree.cells().size(); ++k)
            if (tree.cells()[k].count == 0) {
                leaves.push_back({k, ReflectionStatus::found, 0, false});
                covered += tree.cells()[k].vertices();
            }
        EXPECT_EQ(covered, 700U);
        EXPECT_GT(leaves.size(), 30U);
        std::vector<VirtualVertex> image(points.size());
        std::vector<std::uint32_t> doubtful;
        interpolateCells(tree, atNodes, leaves, image, doubtful);
        EXPECT_TRUE(doubtful.empty());
        EXPECT_EQ(image.back().status, ReflectionStatus::invalid);
        for (const SmoothCell& s : leaves) {
            const CellTree::Cell& cell = tree.cells()[s.cell];
            for (std::uint32_t v = cell.first; v < cell.last; ++v) {
                const std::uint32_t k = tree.order()[v];
                EXPECT_EQ(image[k].status, ReflectionStatus::found);
                EXPECT_LT(glm::length(image[k].fromEye - glm::vec3(value(points[k]))), 1e-4f);
                EXPECT_LT(glm::length(interpolateIn(tree, atNodes, cell, points[k]) - value(points[k])),
                          1e-4f);
            }
        }
        // Where the outline crosses cells, the sign of the fourth value tells, and what is near zero is told.
        for (PathImage& n : atNodes) n.image.w = n.image.x - 2, n.by[0].w = n.by[0].x, n.by[1].w = n.by[1].x;
        for (SmoothCell& s : leaves) s.status = ReflectionStatus::invalid, s.doubt = 0.01f;
        interpolateCells(tree, atNodes, leaves, image, doubtful);
        std::size_t close = 0;
        for (std::size_t k = 0; k < 700; ++k) {
            const float w = value(points[k]).x - 2;
            close += std::abs(w) < 0.01f;
            if (std::abs(w) > 0.011f) {
                EXPECT_EQ(image[k].status, w > 0 ? ReflectionStatus::found : ReflectionStatus::hidden);
            }
        }
        EXPECT_NEAR(static_cast<double>(doubtful.size()), static_cast<double>(close), 2.0);
    }
}

}  // namespace
}  // namespace reflection
