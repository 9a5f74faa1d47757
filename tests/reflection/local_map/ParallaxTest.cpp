#include "reflection/local_map/Parallax.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Distances from the centre of a box to its walls.
LocalMap roomOf(int faceSize, const glm::vec3& low, const glm::vec3& high) {
    LocalMap map;
    map.resize(faceSize);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < faceSize; ++y)
            for (int x = 0; x < faceSize; ++x) {
                const glm::vec3 d = cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize);
                float t = infinity;
                for (int axis = 0; axis < 3; ++axis)
                    if (d[axis] != 0) t = std::min(t, (d[axis] > 0 ? high : low)[axis] / d[axis]);
                map.depth[map.faceOffset(face) + static_cast<std::size_t>(y * faceSize + x)] = t;
            }
    return map;
}

TEST(ParallaxTest, onAPlaneTheRaysOwnHitIsLookedUp) {
    // One wall, seen from anywhere before it: hits within the angle of a texel, over three magnitudes.
    SeededRandom random(4);
    const int n = 256;
    for (const double scale : {0.1, 1.0, 30.0, 1000.0}) {
        const auto s = static_cast<float>(scale);
        LocalMap map = roomOf(n, glm::vec3(-infinity), {4 * s, infinity, infinity});
        for (int k = 0; k < 2000; ++k) {
            const auto between = [&](double a, double b) { return static_cast<float>(random.between(a, b)); };
            const glm::vec3 from = s * glm::vec3(between(-1, 1.5), between(-1.5, 1.5), between(-1.5, 1.5));
            const glm::vec3 towards = glm::normalize(glm::vec3(1, between(-1.2, 1.2), between(-1.2, 1.2)));
            const glm::vec3 hit = from + towards * ((4 * s - from.x) / towards.x);
            const glm::vec3 got = glm::normalize(lookedUpTowards(map, from, towards));
            // A texel of 1 / 256 of a face's two units, its nearness off by half of it, twice.
            EXPECT_LT(glm::length(glm::cross(got, glm::normalize(hit))), 2.0f * 2 / n) << scale << ' ' << k;
        }
    }
}

TEST(ParallaxTest, inARoomItIsFarNearerThanTheDirectionAlone) {
    SeededRandom random(5);
    const glm::vec3 low(-9, -7, -1), high(11, 6, 8);
    const LocalMap map = roomOf(128, low, high);
    double with = 0, without = 0;
    for (int k = 0; k < 5000; ++k) {
        const auto between = [&](double a, double b) { return static_cast<float>(random.between(a, b)); };
        const glm::vec3 from(between(-2, 2), between(-0.9, 0.9), between(-0.5, 0.5));
        const glm::vec3 towards = glm::normalize(glm::vec3(between(-1, 1), between(-1, 1), between(-1, 1)));
        float t = infinity;
        for (int axis = 0; axis < 3; ++axis)
            t = std::min(t, ((towards[axis] > 0 ? high : low)[axis] - from[axis]) / towards[axis]);
        const glm::vec3 truly = glm::normalize(from + t * towards);
        with += glm::length(truly - glm::normalize(lookedUpTowards(map, from, towards)));
        without += glm::length(truly - towards);
    }
    EXPECT_LT(with, 0.12 * without);
}

TEST(ParallaxTest, theSkyAndWhatIsNotFiniteLeaveTheDirection) {
    LocalMap sky;
    sky.resize(8);
    std::ranges::fill(sky.depth, infinity);
    const glm::vec3 towards = glm::normalize(glm::vec3(1, 2, 3));
    EXPECT_EQ(lookedUpTowards(sky, {1, 1, 1}, towards), towards);
    std::ranges::fill(sky.depth, std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(lookedUpTowards(sky, {1, 1, 1}, towards), towards);
    std::ranges::fill(sky.depth, 0.0f);
    EXPECT_EQ(lookedUpTowards(sky, {1, 1, 1}, towards), towards);
    EXPECT_EQ(lookedUpTowards({}, {1, 1, 1}, towards), towards);
    const LocalMap room = roomOf(8, glm::vec3(-1), glm::vec3(1));
    EXPECT_EQ(lookedUpTowards(room, {0, 0, 0}, towards), towards);
    const glm::vec3 far = lookedUpTowards(room, glm::vec3(1e6f), towards);
    EXPECT_TRUE(std::isfinite(far.x) && std::isfinite(far.y) && std::isfinite(far.z));
}

}  // namespace
}  // namespace reflection
