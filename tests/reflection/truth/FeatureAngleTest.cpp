#include "reflection/truth/FeatureAngle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {
namespace {

TEST(FeatureAngleTest, isTheParallaxWorkedByHand) {
    // A wall 8 m to the north of the map's centre; the bonnet is a metre east of it. The map shows the wall's
    // point straight to the north, which from the bonnet lies atan(1 / 8) to the west of north.
    const auto angle = featureAngle({1, 0, 0}, {0, 2, 0}, {0, 8, 0});
    ASSERT_TRUE(angle);
    EXPECT_NEAR(*angle, std::atan2(1.0, 8.0), 1e-12);
    EXPECT_EQ(featureAngle({0, 0, 0}, {0, 1, 0}, {0, 8, 0}), 0.0);
    EXPECT_NEAR(*featureAngle({0, 0, 0}, {0, 1, 0}, {0, -8, 0}), std::numbers::pi, 1e-12);
}

TEST(FeatureAngleTest, smallAnglesKeepTheirDigits) {
    EXPECT_NEAR(*featureAngle({0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-20);
}

TEST(FeatureAngleTest, isNotDefinedWhereThereIsNothingToMeasure) {
    EXPECT_FALSE(featureAngle({1, 2, 3}, {0, 1, 0}, {1, 2, 3}));
    EXPECT_FALSE(featureAngle({1, 2, 3}, {0, 0, 0}, {4, 2, 3}));
    EXPECT_FALSE(featureAngle({0, 0, 0}, {0, 1, 0}, {std::numeric_limits<double>::infinity(), 0, 0}));
}

TEST(FeatureShownTest, theMapsOwnDistanceLeadsToThePoint) {
    LocalMap map;
    map.resize(8);
    // A room of 6 x 6 x 6 m around the centre: the same parameter for every texel. One texel sees the sky.
    std::fill(map.depth.begin(), map.depth.end(), 3.0f);
    map.depth[map.faceOffset(4) + 8 * 4 + 4] = std::numeric_limits<float>::infinity();
    const glm::dvec3 centre(100, 50, 1);
    const auto shown = featureShown(map, centre, {0.5f, -0.25f, 0.125f});
    ASSERT_TRUE(shown);
    EXPECT_LT(glm::distance(*shown, centre + glm::dvec3(3, -1.5, 0.75)), 1e-6);
    EXPECT_FALSE(featureShown(map, centre, cubeDirection(4, {4.5f, 4.5f}, 8)));
    EXPECT_TRUE(featureShown(map, centre, cubeDirection(4, {3.5f, 4.5f}, 8)));
    EXPECT_FALSE(featureShown(map, centre, {0, 0, 0}));
    EXPECT_FALSE(featureShown({}, centre, {1, 0, 0}));
}

}  // namespace
}  // namespace reflection
