#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "app/frame/Lighting.h"
#include "city/model/GlassFronts.h"

namespace app {

// Twins of data/shaders/glass.vert and glass.frag.

/// Shares of the light outside, of the sky and of the sun, that fall on what stands behind a window.
inline constexpr float roomSky = 0.6f;
inline constexpr float roomSun = 0.35f;

/// The shares that fall on what is seen through a pane, or lies at its surface.
inline float behindSky(const city::GlassSurface& glass) {
    return glass.solid ? 1.f : roomSky;
}
inline float behindSun(const city::GlassSurface& glass) {
    return glass.solid ? 1.f : roomSun;
}

/// What a pane lets through and what it mirrors at an angle, as shares of the light behind and before it.
struct GlassShares {
    float through = 1, mirrored = 0;
};
/// `cosine`: between the pane's normal and the direction to the eye; negative counts as 0. After Schlick.
inline GlassShares glassShares(const city::GlassSurface& glass, float cosine) {
    const float grazing = 1 - std::clamp(cosine, 0.f, 1.f);
    const float grazing2 = grazing * grazing;
    const float more = grazing2 * grazing2 * grazing;
    return {glass.transmittance * (1 - more), glass.reflectance + (1 - glass.reflectance) * more};
}

/// What a pane without a reflection map mirrors: the mean light from above or below.
inline glm::vec3 meanSurroundings(const Lighting& lighting, const glm::vec3& reflected) {
    constexpr float inverse = 0.31830989f;
    const float up = std::clamp(reflected.z * 2 + 0.5f, 0.f, 1.f);
    return glm::mix(lighting.groundIrradiance, lighting.skyIrradiance, up) * (inverse * 0.8f);
}

}  // namespace app
