#include "app/frame/Lighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "app/frame/Sky.h"
#include "app/frame/View.h"

namespace app {
namespace {

TEST(LightingTest, isFiniteAtAnyHourAndLatitude) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (double hour : {0.0, 3.7, 6.0, 12.0, 18.3, 23.99, -5.0, 1e9, infinity, std::nan("")}) {
        for (double latitude : {-90.0, -23.4, 0.0, 50.0, 89.9, 1e6, std::nan("")}) {
            const Lighting l = lightingAt(hour, latitude);
            EXPECT_NEAR(glm::length(l.sunDirection), 1, 0.01);
            EXPECT_GT(l.sunDirection.z, 0);
            for (const glm::vec3& v : {l.sunIrradiance, l.skyIrradiance, l.groundIrradiance})
                for (int c = 0; c < 3; ++c)
                    EXPECT_TRUE(std::isfinite(v[c]) && v[c] >= 0) << hour << " " << latitude;
            EXPECT_TRUE(std::isfinite(l.exposure) && l.exposure > 0);
        }
    }
}

TEST(LightingTest, theSunRisesInTheEastStandsSouthAtNoonAndSetsInTheWest) {
    EXPECT_GT(lightingAt(7).sunDirection.x, 0.5f);
    EXPECT_LT(lightingAt(12).sunDirection.y, -0.3f);
    EXPECT_NEAR(lightingAt(12).sunDirection.x, 0, 1e-3);
    EXPECT_LT(lightingAt(17).sunDirection.x, -0.5f);
    EXPECT_NEAR(std::asin(lightingAt(12, 50).sunDirection.z) * 180 / std::numbers::pi, 90 - 50 + 23.44, 0.1);
}

TEST(LightingTest, nightIsDarkAndLampsAreLit) {
    EXPECT_FALSE(lightingAt(12).lampsLit);
    EXPECT_TRUE(lightingAt(0).lampsLit);
    EXPECT_LT(lightingAt(0).skyIrradiance.g, 0.1f * lightingAt(12).skyIrradiance.g);
    // White ground in full daylight has radiance near 1.
    const Lighting noon = lightingAt(12);
    const float ground =
        (noon.skyIrradiance.g + noon.sunIrradiance.g * noon.sunDirection.z) / std::numbers::pi_v<float>;
    EXPECT_NEAR(ground, 0.95, 0.2);
}

TEST(SkyTest, itsIrradianceIsTheLightings) {
    // Cosine-weighted integral over the upper half, sun's disc left out.
    for (double hour : {8.0, 12.0, 17.0}) {
        const Lighting lighting = lightingAt(hour);
        glm::dvec3 sum(0);
        const int n = 200;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < 4 * n; ++j) {
                const double z = std::sqrt((i + 0.5) / n);  // uniform in z^2: weighted by the cosine
                const double azimuth = 2 * std::numbers::pi * (j + 0.5) / (4 * n);
                const double r = std::sqrt(1 - z * z);
                const glm::vec3 d(r * std::cos(azimuth), r * std::sin(azimuth), z);
                if (glm::dot(d, lighting.sunDirection) < sunDiscCosine)
                    sum += glm::dvec3(skyRadiance(lighting, d));
            }
        }
        const glm::dvec3 irradiance = sum * std::numbers::pi / (4.0 * n * n);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(irradiance[c] / lighting.skyIrradiance[c], 1, 0.4) << hour << " " << c;
    }
}

TEST(SkyTest, theDiscStaysRepresentable) {
    const Lighting lighting = lightingAt(12);
    const glm::vec3 disc = skyRadiance(lighting, lighting.sunDirection);
    EXPECT_GT(disc.g, 100);
    EXPECT_LE(std::max({disc.r, disc.g, disc.b}), sunDiscRadiance);
}

TEST(ViewTest, lookAtPutsTheTargetInTheMiddleAndUpUp) {
    const View view = lookAt({10, 20, 5}, {13, 24, 5}, 1.0, {800, 400});
    const glm::mat4 clip = view.clipFromView * view.viewFromWorld;
    const glm::vec4 middle = clip * glm::vec4(3, 4, 0, 1);
    EXPECT_NEAR(middle.x / middle.w, 0, 1e-6);
    EXPECT_NEAR(middle.y / middle.w, 0, 1e-6);
    EXPECT_NEAR(middle.w, 5, 1e-5);
    EXPECT_NEAR(middle.z / middle.w, 0.1 / 5, 1e-6);  // reversed depth: near / distance
    const glm::vec4 above = clip * glm::vec4(3, 4, 1, 1);
    EXPECT_GT(above.y, 0);
    const glm::vec4 right = clip * glm::vec4(4, 3, 0, 1);
    EXPECT_GT(right.x, 0);
}

TEST(ViewTest, degenerateTargetsGiveFiniteViews) {
    const View same = lookAt({1, 2, 3}, {1, 2, 3}, 1.0, {8, 8});
    EXPECT_EQ(same.viewFromWorld, glm::mat4(1));
    for (double z : {-1.0, 1.0}) {
        const View steep = lookAt({0, 0, 0}, {0, 0, z}, 1.0, {8, 8});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(glm::length(glm::vec3(steep.viewFromWorld[i])), 1, 1e-6);
    }
}

}  // namespace
}  // namespace app
