#pragma once

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vec3.hpp>

namespace app {

/// Linear radiance to sRGB-encoded display values in [0, 1]: the filmic curve of Hejl and Burgess-Dawson,
/// which holds the encoding within one rational function. Twin of toneMap in data/shaders/tonemap.glsl.
/// Precondition: finite radiance.
inline glm::vec3 toneMap(const glm::vec3& radiance, float exposure) {
    const glm::vec3 x = glm::max(radiance * (1.4f * exposure) - 0.004f, glm::vec3(0));
    return (x * (6.2f * x + 0.5f)) / (x * (6.2f * x + 1.7f) + 0.06f);
}

/// The radiance that toneMap shows as these display values: its inverse, the positive root of a quadratic.
/// Values are taken from 0 to just below 1, which no radiance reaches.
inline glm::vec3 radianceShownAs(const glm::vec3& display, float exposure) {
    const glm::vec3 y = glm::clamp(display, 0.0f, 0.999f);
    const glm::vec3 a = 6.2f * (1.0f - y), b = 0.5f - 1.7f * y;
    const glm::vec3 root = glm::sqrt(b * b + 0.24f * a * y);
    // Of the two ways to write the root, the one without cancellation where b > 0 is not needed: root - b is
    // small only where the display value is, whose radiance is next to nothing.
    return ((root - b) / (2.0f * a) + 0.004f) / (1.4f * exposure);
}

}  // namespace app
