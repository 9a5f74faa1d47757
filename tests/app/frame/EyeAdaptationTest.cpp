#include "app/frame/EyeAdaptation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/vec2.hpp>
#include <limits>

#include "city/terrain/Heightfield.h"

namespace app {
namespace {

/// 300 m of ground, with two rows of houses of this height along x, 14 m apart.
reflection::GridTracer street(float height) {
    city::Heightfield field(300, 300, 1, glm::dvec2(-150));
    for (int j = 0; j < 300; ++j)
        for (int i = 0; i < 300; ++i) {
            const double across = std::abs(j - 149.5);
            field.set(i, j, across > 7 && across < 30 ? height : 0);
        }
    return reflection::GridTracer(field);
}

const glm::dvec3 driver(0.3, 0.2, 1.5);

TEST(EyeAdaptationTest, inTheSunTheExposureIsTheHours) {
    EXPECT_EQ(exposureAround(street(0), lightingAt(12), driver), 1);
}

TEST(EyeAdaptationTest, inAShadedStreetItIsLongerTheHigherTheHouses) {
    // From the west and low: along the street it shines, across it not.
    Lighting across = lightingAt(12);
    across.sunDirection = glm::vec3(0, -0.8f, 0.6f);
    const double low = exposureAround(street(6), across, driver);
    const double high = exposureAround(street(25), across, driver);
    EXPECT_GT(high, 1.5);
    EXPECT_GT(high, low);
    EXPECT_LE(high, longestExposure);
    Lighting along = across;
    along.sunDirection = glm::vec3(-0.8f, 0, 0.6f);
    EXPECT_LT(exposureAround(street(25), along, driver), high);
}

TEST(EyeAdaptationTest, nightWhoseSkyIsItsLightIsNotTakenForShade) {
    const Lighting night = lightingAt(0);
    EXPECT_LT(exposureAround(street(0), night, driver), 1.2);
}

TEST(EyeAdaptationTest, whatIsNotFiniteLeavesTheExposureAlone) {
    const double infinity = std::numeric_limits<double>::infinity();
    const reflection::GridTracer houses = street(25);
    EXPECT_EQ(exposureAround(houses, lightingAt(12), {0, std::nan(""), 1}), 1);
    EXPECT_EQ(exposureAround(houses, lightingAt(12), {infinity, 0, 1}), 1);
    Lighting dark;
    dark.sunIrradiance = dark.skyIrradiance = glm::vec3(0);
    EXPECT_EQ(exposureAround(houses, dark, driver), 1);
    EyeAdaptation eye;
    EXPECT_EQ(eye.follow(std::nan(""), driver, 0), 1);
    EXPECT_EQ(eye.follow(2, driver, std::nan("")), 1);
}

TEST(EyeAdaptationTest, itGoesTheSameWayInManySmallStepsAsInFewLargeOnes) {
    EyeAdaptation few, many;
    few.follow(1, driver, 0);
    many.follow(1, driver, 0);
    const double once = few.follow(2, driver, 0.5);
    double last = 1;
    for (int i = 0; i < 50; ++i) {
        const double now = many.follow(2, driver, 0.01);
        EXPECT_GT(now, last);
        EXPECT_LT(now, 2);
        last = now;
    }
    EXPECT_NEAR(last, once, 1e-9);
}

TEST(EyeAdaptationTest, itRestsSoThatAStandingViewIsKept) {
    EyeAdaptation eye;
    eye.follow(1, driver, 0);
    for (int i = 0; i < 300; ++i) eye.follow(2, driver, 1.0 / 30);
    const double rests = eye.follow(2, driver, 1.0 / 30);
    EXPECT_NEAR(rests, 2, 2.0 / 255);
    EXPECT_EQ(eye.follow(2, driver, 1.0 / 30), rests);
}

TEST(EyeAdaptationTest, aCutIsAdaptedToAtOnceADriveIsNot) {
    EyeAdaptation eye;
    eye.follow(1, driver, 0);
    EXPECT_LT(eye.follow(2, driver + glm::dvec3(0.5, 0, 0), 1.0 / 30), 1.1);
    EXPECT_EQ(eye.follow(2, driver + glm::dvec3(200, 0, 0), 1.0 / 30), 2);
}

}  // namespace
}  // namespace app
