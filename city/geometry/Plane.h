#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace city {

/// The points p with dot(normal, p) + offset = 0; the normal has unit length and points to the front side.
struct Plane {
    glm::vec3 normal{0, 0, 1};
    float offset = 0;

    /// Positive in front, in metres.
    float signedDistance(const glm::vec3& p) const { return glm::dot(normal, p) + offset; }
};

}  // namespace city
