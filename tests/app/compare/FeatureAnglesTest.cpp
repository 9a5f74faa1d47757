#include "app/compare/FeatureAngles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace app {
namespace {

/// Everything a metre away along the greatest component: a cube of 2 m.
reflection::LocalMap cube() {
    reflection::LocalMap map;
    map.resize(64);
    std::ranges::fill(map.depth, 1.0f);
    return map;
}

TEST(FeatureAnglesTest, isTheAngleThatTheOffsetMakesAndParallaxTakesItAway) {
    const reflection::LocalMap map = cube();
    // Half a metre aside of the centre, towards +x: the direction alone shows what lies 26.6 degrees aside.
    const std::vector<MirroringPoint> points{{{100, 50.5, 0}, {1, 0, 0}, 3}};
    const auto angle = [&](bool parallax) {
        return meanFeatureAngle(points, [&](std::uint32_t) {
            return std::optional(ShownMap{&map, glm::dvec3(100, 50, 0), parallax});
        });
    };
    // A texel of 64 in two units, seen from a metre away: its half.
    EXPECT_NEAR(angle(false), std::atan(0.5), 1.0 / 64);
    EXPECT_NEAR(angle(true), 0, 1.0 / 64);
}

TEST(FeatureAnglesTest, pointsWithoutAMapOrWithTheSkyDoNotCountAndMapsAreAskedOnce) {
    const reflection::LocalMap map = cube();
    reflection::LocalMap sky = cube();
    std::ranges::fill(sky.depth, std::numeric_limits<float>::infinity());
    const std::vector<MirroringPoint> points{{{0, 0.5, 0}, {1, 0, 0}, 1},
                                             {{0, 0.5, 0}, {1, 0, 0}, 1},
                                             {{0, 0.5, 0}, {1, 0, 0}, 2},
                                             {{0, 0.5, 0}, {1, 0, 0}, 3}};
    int asked = 0;
    const double angle = meanFeatureAngle(points, [&](std::uint32_t vehicle) -> std::optional<ShownMap> {
        ++asked;
        if (vehicle == 2) return std::nullopt;
        return ShownMap{vehicle == 1 ? &map : &sky, glm::dvec3(0), false};
    });
    EXPECT_EQ(asked, 3);
    EXPECT_NEAR(angle, std::atan(0.5), 1.0 / 64);
    EXPECT_TRUE(std::isnan(meanFeatureAngle(points, [](std::uint32_t) { return std::nullopt; })));
    EXPECT_TRUE(std::isnan(meanFeatureAngle({}, [](std::uint32_t) { return std::nullopt; })));
}

}  // namespace
}  // namespace app
