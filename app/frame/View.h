#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace app {

/// One image to draw: an eye, a direction and a projection. Depth runs reversed: near plane 1, infinity 0
/// (clip control zero-to-one), so that float depth keeps its precision across a city.
struct View {
    glm::dvec3 eye{0};           ///< world metres, double: subtracted before upload
    glm::mat4 viewFromWorld{1};  ///< rotation alone: x right, y up, z towards the viewer
    glm::mat4 clipFromView{1};   ///< reversed depth
    glm::ivec2 size{1280, 720};  ///< pixels
};

/// A symmetric perspective view. Returns the identity rotation when target and eye coincide.
View lookAt(const glm::dvec3& eye, const glm::dvec3& target, double fovYRadians, glm::ivec2 size,
            double nearPlane = 0.1);

}  // namespace app
