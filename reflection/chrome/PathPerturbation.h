#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "reflection/chrome/ReflectionPoint.h"
#include "reflection/chrome/ReflectorMap.h"

namespace reflection {

/// Where a vertex is seen, and how that changes as the vertex moves.
struct PathImage {
    /// The virtual vertex, relative to the eye, in the reflector's frame, metres; and the cosine between
    /// normal and line of sight at the reflection point, which goes through zero where the reflector begins
    /// to hide the vertex.
    glm::vec4 image{0};
    std::array<glm::vec4, 3> by{};  ///< its change along each of the axes asked for, per metre
    /// 1 or -1: which way round a small surface at the vertex is seen; 0: no image that changes smoothly.
    int turn = 0;
};

/// How reflection points that were searched for move with their vertices. A vertex lies on the reflected ray,
/// at p(s, t) + l r(s, t): three equations for s, t and l, whose Jacobian is regular wherever an image is not
/// torn, at grazing incidence too. So hidden vertices have an image as well: the same equations continue
/// past the outline, where the surface is met from behind, and what is interpolated between vertices on both
/// sides of the outline is smooth. `points`: as found, or for a hidden vertex that of a neighbour which is
/// seen, from where Newton steps lead to its own; `turn` is 0 where they end nowhere.
///
/// Cost: one lookup of the map, about 30 ns; hidden vertices a few. Source: Chen & Arvo 2000, Perturbation
/// methods for interactive specular reflections (there for implicit surfaces); the continuation is ours.
void perturbPaths(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat3& axes,
                  std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> points,
                  std::span<PathImage> images);

}  // namespace reflection
