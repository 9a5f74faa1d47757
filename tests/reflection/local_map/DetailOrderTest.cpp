#include "reflection/local_map/DetailOrder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

std::vector<int> ordered(const std::vector<glm::vec3>& offsets, const SurfacePatch& patch) {
    std::vector<Candidate> candidates;
    for (const glm::vec3& o : offsets) candidates.push_back({nullptr, o});
    std::vector<std::uint8_t> order(offsets.size());
    orderByDetail(candidates, patch, order);
    return {order.begin(), order.end()};
}

/// A wall at x = 10 straight ahead.
const SurfacePatch wall{{10, 0, 0}, {0.1f, 0, 0}};

TEST(DetailOrderTest, aMapThatFacesTheWallComesBeforeANearerOneThatSeesItAslant) {
    // The second stands a metre from the wall, 9 m along it, at about the local map's distance: its texels
    // are stretched ninefold over the wall. By distance alone it would be the first.
    EXPECT_EQ(ordered({{-3, 5, 0}, {9, 9, 0}}, wall), (std::vector<int>{0, 1}));
    EXPECT_EQ(ordered({{9, 9, 0}, {-3, 5, 0}}, wall), (std::vector<int>{1, 0}));
}

TEST(DetailOrderTest, aMapBehindTheSurfaceComesLast) {
    EXPECT_EQ(ordered({{11, 1, 0}, {-60, 40, 0}, {10, 30, 0}}, wall), (std::vector<int>{1, 0, 2}));
}

TEST(DetailOrderTest, aMapAtTheLocalMapsPlaceComesFirst) {
    EXPECT_EQ(ordered({{2, 0, 0}, {-2, 0, 0}, {0, 0, 0}, {0, 3, 0}}, wall)[0], 2);
}

TEST(DetailOrderTest, amongEqualsTheFirstStaysFirst) {
    EXPECT_EQ(ordered({{0, 4, 0}, {0, -4, 0}, {0, 0, 4}}, wall), (std::vector<int>{0, 1, 2}));
}

TEST(DetailOrderTest, aPlaneIsFoundFromItsReciprocals) {
    SeededRandom random(91);
    constexpr int n = 16;
    for (int k = 0; k < 200; ++k) {
        const int face = k % 6;
        const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
        // In front of the whole face, so that no texel is sky.
        const glm::vec3 plane = static_cast<float>(random.between(0.02, 2)) *
                                (f.major + static_cast<float>(random.between(-0.4, 0.4)) * f.sAxis +
                                 static_cast<float>(random.between(-0.4, 0.4)) * f.tAxis);
        std::vector<float> reciprocal;
        for (int i = 0; i < n * n; ++i)
            reciprocal.push_back(glm::dot(plane, cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n)));
        for (const auto& [x, y] : {std::array{0, 0}, {n - 1, n - 1}, {7, 3}, {0, 9}}) {
            const SurfacePatch patch = patchAround(f, reciprocal.data(), n, x, y);
            const float size = glm::length(plane);
            // A difference over two texels of an eighth each, of values rounded to 2^-24 of twice the plane's
            // length.
            EXPECT_LT(glm::length(patch.plane - plane), 16 * 0x1p-22f * size);
            EXPECT_NEAR(glm::dot(patch.point, plane), 1, 1e-5);
        }
    }
}

TEST(DetailOrderTest, whateverTheStartsEveryCandidateIsOrderedOnce) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    SeededRandom random(92);
    const std::array values{0.0f, -1.0f, nan, inf, 1e-30f, 1e30f, 0.1f};
    for (int k = 0; k < 1000; ++k) {
        std::vector<float> reciprocal(9);
        for (float& w : reciprocal) w = values[random.below(values.size())];
        std::vector<glm::vec3> offsets;
        for (int i = 0; i < 16; ++i)
            offsets.emplace_back(random.between(-9, 9), random.between(-9, 9), i % 3 == 0 ? inf : 0.0f);
        std::vector<int> order = ordered(
            offsets, patchAround(cubeFaces[random.below(6)], reciprocal.data(), 3,
                                 static_cast<int>(random.below(3)), static_cast<int>(random.below(3))));
        std::sort(order.begin(), order.end());
        for (int i = 0; i < 16; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
    }
}

}  // namespace
}  // namespace reflection
