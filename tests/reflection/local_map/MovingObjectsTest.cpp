#include "reflection/local_map/MovingObjects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

/// Nearer than this nothing is drawn (MovingObjects.cpp).
constexpr double nearLimit = 0.05;

LocalMap sceneAt(int n, float depth) {
    LocalMap map;
    map.resize(n);
    std::fill(map.depth.begin(), map.depth.end(), depth);
    std::fill(map.red.begin(), map.red.end(), -1.0f);
    return map;
}

struct RayHit {
    double depth = std::numeric_limits<double>::infinity();
    glm::dvec3 radiance{0};
    bool doubtful = false;  ///< so near to an edge, a limit or edge-on that rounding decides
};

/// Möller & Trumbore in double, front faces only: the nearest hit of a texel's centre ray.
RayHit trace(std::span<const MovingObject> objects, const glm::dvec3& d) {
    RayHit hit;
    for (const MovingObject& object : objects)
        for (std::size_t k = 0; k < object.indices.size(); k += 3) {
            const glm::dvec3 a(object.positions[object.indices[k]]),
                b(object.positions[object.indices[k + 1]]), c(object.positions[object.indices[k + 2]]);
            const glm::dvec3 n = glm::cross(b - a, c - a);
            const double facing = glm::dot(n, d);
            const double size = glm::length(n) * glm::length(d);
            if (!(size > 0)) continue;
            // Within half a degree of edge-on a float's rounding of the texel position moves the depth by
            // more than is asked for.
            constexpr double edgeOn = 1e-2;
            if (facing > edgeOn * size) continue;
            const double t = glm::dot(n, a) / facing;
            const glm::dvec3 p = t * d;
            const double wa = glm::dot(n, glm::cross(c - b, p - b)) / glm::dot(n, n);
            const double wb = glm::dot(n, glm::cross(a - c, p - c)) / glm::dot(n, n);
            const double wc = 1 - wa - wb;
            const double least = std::min({wa, wb, wc});
            constexpr double edge = 2e-3;
            if (!(least > -edge) || !(t > nearLimit * 0.98)) {
                if (facing > -edgeOn * size) hit.doubtful = true;
                continue;
            }
            if (least < edge || t < nearLimit * 1.02 || facing > -edgeOn * size) {
                hit.doubtful = true;
                continue;
            }
            if (std::abs(t / hit.depth - 1) < 1e-3) hit.doubtful = true;
            if (t >= hit.depth) continue;
            hit.depth = t;
            hit.radiance = wa * glm::dvec3(object.radiance[object.indices[k]]) +
                           wb * glm::dvec3(object.radiance[object.indices[k + 1]]) +
                           wc * glm::dvec3(object.radiance[object.indices[k + 2]]);
        }
    return hit;
}

struct Tally {
    int drawn = 0, left = 0, doubtful = 0;
};

void compareWithRays(std::span<const MovingObject> objects, int n, float sceneDepth, Tally& tally) {
    LocalMap map = sceneAt(n, sceneDepth);
    for (int face = 0; face < 6; ++face) {
        const std::uint32_t written = drawMovingObjects(objects, face, map);
        std::uint32_t changed = 0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const std::size_t i = map.faceOffset(face) + static_cast<std::size_t>(y * n + x);
                changed += map.red[i] >= 0 ? 1 : 0;
                const RayHit hit = trace(objects, glm::dvec3(cubeDirection(face, glm::vec2(x, y) + 0.5f, n)));
                if (hit.doubtful || std::abs(hit.depth / sceneDepth - 1) < 1e-3) {
                    ++tally.doubtful;
                } else if (hit.depth < sceneDepth) {
                    ++tally.drawn;
                    // A triangle cut at the near limit has corners of reciprocal depth 20, whose rounding (a
                    // few 2^-24) is left in the small reciprocal of a far texel.
                    ASSERT_NEAR(map.depth[i] / hit.depth, 1, 1e-4 + 5e-6 * hit.depth)
                        << face << ' ' << x << ' ' << y;
                    ASSERT_NEAR(map.red[i], hit.radiance.r, 2e-3);
                    ASSERT_NEAR(map.green[i], hit.radiance.g, 2e-3);
                    ASSERT_NEAR(map.blue[i], hit.radiance.b, 2e-3);
                } else {
                    ++tally.left;
                    ASSERT_EQ(map.depth[i], sceneDepth) << face << ' ' << x << ' ' << y;
                    ASSERT_EQ(map.red[i], -1.0f);
                }
            }
        ASSERT_GE(written, changed);
    }
}

glm::vec3 randomPoint(SeededRandom& random, double size) {
    return {random.between(-size, size), random.between(-size, size), random.between(-size, size)};
}

void addTriangle(MovingObject& object, SeededRandom& random, const glm::vec3& a, const glm::vec3& b,
                 const glm::vec3& c) {
    for (const glm::vec3& p : {a, b, c}) {
        object.indices.push_back(static_cast<std::uint32_t>(object.positions.size()));
        object.positions.push_back(p);
        object.radiance.emplace_back(random.unit(), random.unit(), random.unit());
    }
}

TEST(MovingObjectsTest, trianglesOfAllSizesAgreeWithRays) {
    SeededRandom random(41);
    Tally tally;
    for (int k = 0; k < 300; ++k) {
        std::vector<MovingObject> objects(1 + static_cast<std::size_t>(random.below(3)));
        for (MovingObject& object : objects) {
            const glm::vec3 middle = randomPoint(random, 8);
            const double size = std::exp(random.between(-1, 2.5));
            for (int i = 0; i < 4; ++i)
                addTriangle(object, random, middle + randomPoint(random, size),
                            middle + randomPoint(random, size), middle + randomPoint(random, size));
        }
        compareWithRays(objects, 1 + random.below(24), static_cast<float>(random.between(2, 30)), tally);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(tally.drawn, 10000);
    EXPECT_GT(tally.left, 10000);
    EXPECT_LT(tally.doubtful, (tally.drawn + tally.left) / 8);
}

TEST(MovingObjectsTest, trianglesAroundTheNearLimitAgreeWithRays) {
    SeededRandom random(42);
    Tally tally;
    for (int k = 0; k < 300; ++k) {
        std::vector<MovingObject> objects(1);
        for (int i = 0; i < 3; ++i)
            addTriangle(objects[0], random, randomPoint(random, 0.2), randomPoint(random, 1),
                        randomPoint(random, 3));
        compareWithRays(objects, 16, 20, tally);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(tally.drawn, 3000);
    EXPECT_LT(tally.doubtful, (tally.drawn + tally.left) / 8);
}

/// A box whose faces are counter-clockwise seen from outside.
MovingObject box(const glm::vec3& low, const glm::vec3& high) {
    MovingObject object;
    for (int k = 0; k < 8; ++k) {
        object.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
        object.radiance.emplace_back(0.1f * static_cast<float>(k + 1));
    }
    for (const auto& q : {std::array<std::uint32_t, 4>{0, 4, 6, 2},
                          {1, 3, 7, 5},
                          {0, 1, 5, 4},
                          {2, 6, 7, 3},
                          {0, 2, 3, 1},
                          {4, 5, 7, 6}})
        object.indices.insert(object.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    return object;
}

TEST(MovingObjectsTest, aBoxShowsItsOutsideOnEveryFaceAndNothingFromWithin) {
    for (int face = 0; face < 6; ++face) {
        const glm::vec3 at = 6.0f * cubeFaces[static_cast<std::size_t>(face)].major;
        const std::vector<MovingObject> objects{box(at - 1.0f, at + 1.0f)};
        LocalMap map = sceneAt(33, 50);
        EXPECT_GT(drawMovingObjects(objects, face, map), 20u) << face;
        // The near side, 5 m off, not the far one.
        EXPECT_NEAR(map.depth[map.faceOffset(face) + std::size_t{16} * 33 + 16], 5, 1e-4f) << face;
        EXPECT_EQ(drawMovingObjects(objects, face ^ 1, map), 0u) << face;
    }
    const std::vector<MovingObject> around{box(glm::vec3(-2), glm::vec3(2))};
    LocalMap map = sceneAt(16, 50);
    for (int face = 0; face < 6; ++face)
        EXPECT_EQ(drawMovingObjects(around, face, map), 0u) << "back faces are not drawn";
}

TEST(MovingObjectsTest, sharedEdgesThroughTexelCentresAreDrawnOnceByTheTopLeftRule) {
    // On a face of 8 texels a square from the centre of texel (1, 1) to that of (5, 5), in two triangles
    // either way.
    const int n = 8;
    for (int face = 0; face < 6; ++face)
        for (int diagonal = 0; diagonal < 2; ++diagonal) {
            std::vector<glm::vec3> corner;
            for (const glm::vec2& at : {glm::vec2(1.5f, 1.5f), {1.5f, 5.5f}, {5.5f, 5.5f}, {5.5f, 1.5f}})
                corner.push_back(4.0f * cubeDirection(face, at, n));
            std::vector<int> count(static_cast<std::size_t>(n * n), 0);
            for (int half = 0; half < 2; ++half) {
                MovingObject object;
                const auto i = static_cast<std::uint32_t>(diagonal), j = i + (half ? 2 : 0);
                object.positions = corner;
                object.radiance.assign(4, glm::vec3(1));
                object.indices = {j % 4, (j + 1) % 4, (j + 2) % 4};
                LocalMap map = sceneAt(n, 50);
                std::uint32_t written = drawMovingObjects(std::span(&object, 1), face, map);
                if (written == 0) {
                    std::swap(object.indices[1], object.indices[2]);
                    written = drawMovingObjects(std::span(&object, 1), face, map);
                }
                ASSERT_GT(written, 0u);
                for (std::size_t k = 0; k < count.size(); ++k)
                    count[k] += map.depth[map.faceOffset(face) + k] < 50 ? 1 : 0;
            }
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    EXPECT_EQ(count[static_cast<std::size_t>(y * n + x)],
                              x >= 1 && x < 5 && y >= 1 && y < 5 ? 1 : 0)
                        << face << ' ' << x << ' ' << y;
        }
}

TEST(MovingObjectsTest, rubbishIsNotDrawn) {
    const float bad = std::numeric_limits<float>::quiet_NaN(), far = std::numeric_limits<float>::infinity();
    LocalMap map = sceneAt(8, 50);
    for (const glm::vec3& p : {glm::vec3(bad), glm::vec3(far), glm::vec3(0), glm::vec3(bad, 1, 1)}) {
        MovingObject object;
        object.positions = {p, {5, 1, 0}, {5, 0, 1}};
        object.radiance.assign(3, glm::vec3(1));
        object.indices = {0, 1, 2, 0, 2, 1, 0, 0, 0, 1, 1, 2};
        for (int face = 0; face < 6; ++face) (void)drawMovingObjects(std::span(&object, 1), face, map);
    }
    for (const float d : map.depth) EXPECT_TRUE(d > 0 && d <= 50);
    for (const float r : map.red) EXPECT_TRUE(std::isfinite(r));
    EXPECT_EQ(drawMovingObjects({}, 0, map), 0u);
}

}  // namespace
}  // namespace reflection
