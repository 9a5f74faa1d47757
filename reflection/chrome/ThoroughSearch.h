#pragma once

#include <span>
#include <vector>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

/// Where a descent ended. Frame and units: the map's.
struct Candidate {
    glm::dvec3 point{0}, normal{0};
    double error =
        2;  ///< squared sine of the angle between bisector and normal; more than 1 beyond a right angle
};

/// Newton steps from every start (directions from the centre, stretch taken out), several at a time; in the
/// map's frame.
void descendFromStarts(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                       std::span<const glm::dvec3> starts, std::span<Candidate> found,
                       const SearchOptions& options);

/// Whether the segment meets the inside of the surface, and where it enters; `from` must be outside. In the
/// map's frame.
bool entersSurface(const ReflectorMap& map, const glm::dvec3& from, const glm::dvec3& to, glm::dvec3& point);

/// Every distinct reflection point of the vertex, on the part and on its closing surface, shortest path
/// first; in the map's frame. On concave pieces descents start in every patch of the surface that can hold
/// one (SurfacePatches), so what is missed can only be one of two in the same few cells; on convex ones at
/// the least errors of a lattice.
std::vector<ReflectionPoint> everyReflectionPoint(const ReflectorMap& map, const glm::dvec3& eye,
                                                  const glm::dvec3& vertex, const SearchOptions& options);

/// What is said of a vertex whose reflection points are all known: the first of those on the part, else
/// hidden, else unreflected. In the map's frame.
ReflectionPoint settle(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                       std::span<const ReflectionPoint> all);

/// An answer for one vertex at any price: the shortest of everyReflectionPoint on the part, else hidden, else
/// unreflected. In the map's frame.
ReflectionPoint searchThoroughly(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                                 const SearchOptions& options);

}  // namespace reflection
