// Polygons in the image, and made wider: everything near them is inside, nothing far from them.
#include "reflection/planar/Outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace reflection {
namespace {

double distanceTo(const std::vector<glm::dvec2>& polygon, const glm::dvec2& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i], d = polygon[(i + 1) % polygon.size()] - a;
        const double t = glm::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
        least = std::min(least, glm::distance(p, a + t * d));
    }
    return least;
}

bool inside(const std::vector<glm::dvec2>& polygon, const glm::dvec2& p) {
    int left = 0, right = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i], d = polygon[(i + 1) % polygon.size()] - a, e = p - a;
        const double side = d.x * e.y - d.y * e.x;
        left += side > 1e-9 ? 1 : 0;
        right += side < -1e-9 ? 1 : 0;
    }
    return left == 0 || right == 0;
}

double unit(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

TEST(Outline, WiderPolygonsHoldAllWithinTheMarginAndNothingFarOutside) {
    std::mt19937_64 random(7);
    for (int run = 0; run < 200; ++run) {
        // Corners on a circle, in order: convex; flattened: sharp.
        std::vector<glm::dvec2> polygon;
        const int corners = 3 + static_cast<int>(random() % 6);
        const double flat = run % 3 == 0 ? 0.02 : 1;
        for (int i = 0; i < corners; ++i) {
            const double angle = 6.283185307179586 * (i + 0.8 * unit(random)) / corners;
            polygon.emplace_back(100 * std::cos(angle), 100 * flat * std::sin(angle));
        }
        if (run % 2 == 1) std::reverse(polygon.begin(), polygon.end());
        const double margin = 3 * unit(random);
        const auto wider = widened(polygon, glm::dvec2(1), margin);
        ASSERT_GE(wider.size(), 3u);
        for (int k = 0; k < 200; ++k) {
            const glm::dvec2 p((unit(random) - 0.5) * 240, (unit(random) - 0.5) * 240 * flat);
            const double far = inside(polygon, p) ? 0 : distanceTo(polygon, p);
            if (far < margin - 1e-6) {
                EXPECT_TRUE(inside(wider, p)) << run;
            }
            // A right angle's corner lies the root of two farther; so does a cut one's.
            if (far > 1.4143 * margin + 1e-6) {
                EXPECT_FALSE(inside(wider, p)) << run;
            }
        }
    }
}

TEST(Outline, PolygonsWithoutAreaOrBehindTheEyeHaveNone) {
    EXPECT_TRUE(widened({}, glm::dvec2(1), 1).empty());
    EXPECT_TRUE(widened({{0, 0}, {1, 0}}, glm::dvec2(1), 1).empty());
    EXPECT_TRUE(widened({{3, 3}, {3, 3}, {3, 3}}, glm::dvec2(1), 1).empty());
    const EyeView view = perspectiveView({0, 0, 0}, {1, 0, 0}, 1, 1);
    EXPECT_TRUE(projected(view, {{2, 0, 0}, {2, 1, 0}, {-1, 0, 1}}).empty());
    const auto corners = projected(view, {{2, 0, 0}});
    ASSERT_EQ(corners.size(), 1u);
    EXPECT_NEAR(glm::length(corners.front()), 0, 1e-12);
}

}  // namespace
}  // namespace reflection
