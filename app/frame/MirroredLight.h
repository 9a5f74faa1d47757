#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace app {

/// The light that each pixel's vehicle mirrors: radiance that arrives from the mirrored direction, before
/// Fresnel's factor, top row first. Drawn by SceneRenderer (VehicleReflections::mirrored), so that two
/// pictures with different mirrored light differ in their reflections and in nothing else.
struct MirroredLight {
    glm::ivec2 size{0};
    std::vector<glm::vec3> radiance;  ///< linear; size.x * size.y
    /// The pixels that count lie within [low, high); others hold 0, or what was there before.
    glm::ivec2 low{0}, high{0};
    std::uint64_t pixels = 0;  ///< that show a vehicle
    std::uint64_t rays = 0;    ///< mirror rays, and rays from mirror to mirror
};

}  // namespace app
