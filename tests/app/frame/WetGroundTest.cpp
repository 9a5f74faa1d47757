// What rain makes of ground, as rays and shaders share it.
#include "app/frame/WetGround.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace app {
namespace {

constexpr glm::vec3 level(0, 0, 1);

TEST(WetGroundTest, waterMirrorsAsFresnelSaysAndMoreTheLowerTheEye) {
    EXPECT_FLOAT_EQ(wetGround(city::Pattern::asphalt, level, {3, 4}, 1).mirrored, wet::waterReflectance);
    EXPECT_FLOAT_EQ(wetGround(city::Pattern::asphalt, level, {3, 4}, 0).mirrored, 1);
    EXPECT_FLOAT_EQ(wetGround(city::Pattern::asphalt, level, {3, 4}, -1).mirrored, 1);  // from below: as 0
    float before = 2;
    for (float cosine = 0; cosine <= 1; cosine += 0.05f) {
        const float mirrored = wetGround(city::Pattern::asphalt, level, {3, 4}, cosine).mirrored;
        EXPECT_LT(mirrored, before) << cosine;
        before = mirrored;
    }
}

TEST(WetGroundTest, waterRunsOffSlopesAndSoaksIntoSoil) {
    const glm::vec3 kerb(1, 0, 0), ramp = glm::normalize(glm::vec3(0, 0.4f, 1));
    for (const glm::vec3& steep : {kerb, ramp}) {
        const WetGround ground = wetGround(city::Pattern::pavement, steep, {0, 0}, 0.5f);
        EXPECT_EQ(ground.lies, 0);
        EXPECT_EQ(ground.mirrored, 0);
        EXPECT_EQ(ground.under, wet::filmShade);
    }
    for (const city::Pattern soaking : {city::Pattern::grass, city::Pattern::soil}) {
        const WetGround ground = wetGround(soaking, level, {0, 0}, 0.2f);
        EXPECT_EQ(ground.mirrored, 0);
        EXPECT_EQ(ground.puddle, 0);
        EXPECT_EQ(ground.under, wet::soakedShade);
    }
}

TEST(WetGroundTest, somePuddlesLieOnStreetsAndTheyAreDarker) {
    std::mt19937_64 random(7);
    const auto metres = [&] { return static_cast<float>(random() % 2000000) * 1e-3f - 1000; };
    constexpr int count = 20000;
    int puddles = 0;
    for (int i = 0; i < count; ++i) {
        const WetGround ground = wetGround(city::Pattern::asphalt, level, {metres(), metres()}, 0.3f);
        ASSERT_GE(ground.puddle, 0);
        ASSERT_LE(ground.puddle, 1);
        EXPECT_NEAR(ground.under, wet::filmShade + (wet::puddleShade - wet::filmShade) * ground.puddle,
                    1e-5f);
        if (ground.puddle > 0.5f) ++puddles;
    }
    EXPECT_GT(puddles, count / 20);
    EXPECT_LT(puddles, count / 2);
}

TEST(WetGroundTest, ripplesStayWithinTheirSlopeAndFlattenWithDistance) {
    std::mt19937_64 random(11);
    const auto metres = [&] { return static_cast<float>(random() % 2000000) * 1e-3f - 1000; };
    float most = 0;
    for (int i = 0; i < 5000; ++i) {
        const glm::vec2 place(metres(), metres());
        const glm::vec2 near = rippleAt(place, 0), far = rippleAt(place, 100);
        most = std::max({most, std::abs(near.x), std::abs(near.y)});
        EXPECT_NEAR(glm::length(far) * (1 + 100 * wet::rippleFade), glm::length(near), 1e-6f);
    }
    EXPECT_LE(most, 0.5f * wet::rippleSlope);
    EXPECT_GT(most, 0.4f * wet::rippleSlope);
}

TEST(WetGroundTest, withoutAnImageStreetsShowHousesLowAndSkyHigh) {
    const Lighting light = lightingAt(15);
    const auto brightness = [&](float up) {
        const glm::vec3 to(0, std::sqrt(1 - up * up), up);
        return glm::dot(wetSurroundings(light, to, 1, 1), glm::vec3(1.f / 3));
    };
    EXPECT_LT(brightness(0.05f), 0.7f * brightness(0.95f));
    // The film shows the sun around its mirror image; puddles do not here: theirs is a disc.
    const glm::vec3 sun = light.sunDirection;
    EXPECT_GT(wetSurroundings(light, sun, 0, 1).x, 5 * wetSurroundings(light, sun, 1, 1).x);
    EXPECT_EQ(wetSurroundings(light, sun, 0, 0), wetSurroundings(light, sun, 1, 1));
}

}  // namespace
}  // namespace app
