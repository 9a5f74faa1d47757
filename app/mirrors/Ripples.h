#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace app {

/// Waves on a flat mirror, wind on water: six plane waves about one direction. Only their slopes matter.
struct Ripples {
    double slope = 0;  ///< standard deviation along each wave's direction, summed: tan of an angle; 0: none
    double wavelength = 1;  ///< metres, of the longest

    bool any() const { return slope > 0; }
    /// Radians by which reflections stray, nearly never more: three deviations, doubled by reflection.
    double reach() const { return 6 * slope; }
};

/// Two directions along a plane by which ripples are laid out: of a level one, east and north.
struct RippleFrame {
    explicit RippleFrame(const glm::dvec3& normal);
    glm::dvec3 u, v;
};

/// The waves' slopes along the frame's u and v at a place of the world. The twin of `rippleSlope` in
/// data/shaders/mirror_world.frag.
glm::dvec2 rippleSlope(const Ripples& ripples, const RippleFrame& frame, const glm::dvec3& world);

}  // namespace app
