#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "reflection/chrome/ReflectionPoint.h"

namespace reflection {

/// What a virtual vertex is drawn with.
struct VirtualVertex {
    /// In the reflector's frame relative to the eye, metres: lies on the line of sight through the reflection
    /// point, as far away as the light's whole path is long. Its direction places it on screen, its length
    /// orders it in depth among everything reflected in the same piece.
    glm::vec3 fromEye{0};
    ReflectionStatus status = ReflectionStatus::invalid;
};

/// Where on the piece a virtual vertex is seen, from what it is drawn with: on its line of sight, where the
/// rest of its path reaches the vertex. Frame: the reflector's. The eye, where there is no such place.
inline glm::dvec3 reflectionPointOf(const VirtualVertex& seen, const glm::dvec3& eye,
                                    const glm::dvec3& vertex) {
    // |eye + s u - vertex| = path - s, solved for s.
    const glm::dvec3 path(seen.fromEye), away = eye - vertex;
    const double length = glm::length(path), straight = glm::length(away);
    const glm::dvec3 u = path / std::max(length, 1e-300);
    const double by = 2 * (length + glm::dot(u, away));
    if (!(by > 0)) return eye;
    const double s = (length - straight) * (length + straight) / by;
    return eye + std::clamp(s, 0.0, length) * u;
}

}  // namespace reflection
