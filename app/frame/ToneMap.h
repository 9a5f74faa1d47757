#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace app {

/// Linear radiance to sRGB-encoded display values in [0, 1]: the filmic curve of Hejl and Burgess-Dawson,
/// which holds the encoding within one rational function. Twin of toneMap in data/shaders/tonemap.glsl.
/// Precondition: finite radiance.
inline glm::vec3 toneMap(const glm::vec3& radiance, float exposure) {
    const glm::vec3 x = glm::max(radiance * (1.4f * exposure) - 0.004f, glm::vec3(0));
    return (x * (6.2f * x + 0.5f)) / (x * (6.2f * x + 1.7f) + 0.06f);
}

}  // namespace app
