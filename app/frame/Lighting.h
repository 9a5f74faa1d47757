#pragma once

#include <glm/vec3.hpp>
#include <string>

namespace app {

/// Sun and sky for one frame; linear RGB, scaled so that a white diffuse ground in full daylight has radiance
/// near 1 and exposure 1 shows it right.
struct Lighting {
    glm::vec3 sunDirection{0.48f, -0.48f, 0.73f};    ///< unit, towards the sun
    glm::vec3 sunIrradiance{2.6f, 2.45f, 2.2f};      ///< on a surface that faces it
    glm::vec3 skyIrradiance{0.55f, 0.68f, 0.9f};     ///< on an upward surface, from the whole sky
    glm::vec3 groundIrradiance{0.22f, 0.2f, 0.18f};  ///< on a downward surface, from the ground
    float turbidity = 3;
    float exposure = 1;
    bool lampsLit = false;  ///< street lamps and head lamps on

    bool operator==(const Lighting&) const = default;
};

/// Lighting at an hour of a clear day, 0..24 local solar time, at a latitude (degrees) in mid June. Finite
/// for every finite input.
Lighting lightingAt(double hour, double latitude = 50);

}  // namespace app
