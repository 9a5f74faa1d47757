#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace reflection {

/// What a search says of a vertex, always one of these.
enum class ReflectionStatus : std::uint8_t {
    found,        ///< the eye sees the vertex in the part, at `point`
    hidden,       ///< the part stands between eye and vertex (or encloses the vertex): `point` is where
    unreflected,  ///< neither: its reflection would lie past the part's rim (`point`, on the closing
                  ///< surface), or nowhere
    outOfSteps,  ///< published search only: the steps ended before the tolerance was met; `point` is the last
                 ///< one
    invalid      ///< eye or vertex is not finite, or the map is empty; everything else is zero
};

/// Where a vertex is reflected. Frame: the reflector's, metres.
struct ReflectionPoint {
    glm::dvec3 point{0};         ///< on the reflector's surface (of its map)
    glm::dvec3 normal{0, 0, 1};  ///< of the map there, unit length
    double residual = 0;         ///< radians between the bisector and the normal; 0 for hidden vertices
    double path = 0;             ///< metres from the eye over the point to the vertex
    ReflectionStatus status = ReflectionStatus::invalid;
    std::uint8_t lookups = 0;  ///< of the pair of maps (four corners each)
};

/// The vertex mirrored at the tangent plane of its reflection point: seen from the eye it covers the point,
/// `path` metres away. For a hidden vertex this is the vertex in front whose image would be there, which
/// continues reflected triangles past the part's outline (Estalella et al. 2005, section 6.1).
inline glm::dvec3 virtualVertex(const ReflectionPoint& r, const glm::dvec3& vertex) {
    return vertex - 2.0 * glm::dot(vertex - r.point, r.normal) * r.normal;
}

}  // namespace reflection
