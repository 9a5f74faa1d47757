#pragma once

#include <glm/vec3.hpp>

#include "app/frame/Lighting.h"

namespace app {

/// Largest radiance of the sun's disc: the true one (some 40,000) would not survive half floats and
/// filtering.
inline constexpr float sunDiscRadiance = 200;
/// Cosine of the disc's angular radius, 0.5 degrees: about twice the true one, so that it is not lost between
/// pixels.
inline constexpr float sunDiscCosine = 0.99996192f;

/// Linear radiance of a clear sky towards a direction (unit length), the ground's haze below the horizon;
/// with the sun's disc. The twin of skyRadiance in data/shaders/sky.glsl: equal to within rounding. Its
/// cosine-weighted integral over the upper half is close to `Lighting::skyIrradiance`.
glm::vec3 skyRadiance(const Lighting& lighting, const glm::vec3& direction);

}  // namespace app
