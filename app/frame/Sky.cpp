#include "app/frame/Sky.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace app {

glm::vec3 skyRadiance(const Lighting& lighting, const glm::vec3& direction) {
    constexpr float inversePi = 0.31830989f;
    const glm::vec3 mean = lighting.skyIrradiance * inversePi;
    const float up = std::max(direction.z, 0.f);
    const float low = 1 - up;
    const float low2 = low * low;
    // Deep overhead, pale and brighter towards the horizon, where the air is thick.
    const glm::vec3 zenith = mean * glm::vec3(0.6f, 0.86f, 1.2f);
    const float grey = 0.33f * (mean.r + mean.g + mean.b);
    const glm::vec3 horizon = glm::mix(mean, glm::vec3(grey), 0.55f) * 1.9f;
    glm::vec3 radiance = glm::mix(zenith, horizon, low2 * low2);

    // Light scattered forwards around the sun: a wide and a narrow lobe, stronger in hazy air.
    const float facing = std::max(glm::dot(direction, lighting.sunDirection), 0.f);
    const float f2 = facing * facing;
    const float f4 = f2 * f2;
    const float f16 = f4 * f4 * f4 * f4;
    const float f64 = f16 * f16 * f16 * f16;
    const float f256 = f64 * f64 * f64 * f64;
    radiance += lighting.sunIrradiance * (0.02f * lighting.turbidity) *
                (0.12f * f4 + 0.55f * f64 + 2.2f * f256 * f64);

    // Below the horizon: hazy ground, meeting the sky's colour at the horizon without a seam.
    const float below = std::min(std::max(-direction.z, 0.f) * 6, 1.f);
    radiance = glm::mix(radiance, lighting.groundIrradiance * inversePi, below);

    if (direction.z > -0.01f && glm::dot(direction, lighting.sunDirection) > sunDiscCosine)
        radiance = glm::min(lighting.sunIrradiance * 100.f, glm::vec3(sunDiscRadiance));
    return radiance;
}

}  // namespace app
