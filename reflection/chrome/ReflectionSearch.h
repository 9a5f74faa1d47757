#pragma once

#include <span>
#include <vector>

#include "reflection/chrome/ReflectionPoint.h"
#include "reflection/chrome/ReflectorMap.h"

namespace reflection {

struct SearchOptions {
    /// Radians between bisector and normal at which a point is found. Double precision on a map of floats
    /// reaches about 1e-9; ten times below what is promised leaves room for a caller's own transforms.
    double tolerance = 1e-7;
    /// Lookups after which a vertex leaves the packets and is searched for thoroughly (still to an answer).
    int lookups = 40;
    /// On convex pieces without an opening there is but one point to look for: without the thorough search, a
    /// vertex that did not come within a milliradian in `lookups` is told unreflected, and none takes longer.
    bool thorough = true;
};

/// Finds where the eye sees each vertex in the reflector. A point is one where the bisector of the directions
/// to eye and vertex is the normal; Newton steps on the bisector's part along the surface, each kept only if
/// the angle shrinks and halved otherwise, from the surface's point of the bisector seen from the centre or,
/// for vertices close to the surface, from the mirror point of the tangent plane under them. In floats first,
/// then a step in doubles. What arrives is not hidden; of the others, hidden ones are told first: the
/// distance function of a convex body is convex along the line of sight, so its tangents bracket the line's
/// deepest point. What does not converge is searched for on a lattice of starting points, so every vertex
/// gets a status and none is `outOfSteps`. On concave pieces the point with the shortest path is given: for
/// all, findAllReflectionPoints.
///
/// `guesses`: empty, or for each vertex a point near its reflection point (the last frame's, a neighbour's)
/// from where to start, not a number for none. On convex pieces they change how long it takes, not what comes
/// out; on concave ones they are not looked at.
///
/// `points` must have room for all vertices. Frame: the reflector's, metres. Cost: three to six lookups of
/// the map a vertex in floats, sixteen vertices at a time where the processor has AVX-512, and two in
/// doubles, eight at a time. Source: Estalella et al. 2005, sections 4.2 to 6.1; error function and its
/// descent are the paper's, steps and safeguards are not.
void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const SearchOptions& options = {}, std::span<const glm::dvec3> guesses = {});

/// All reflection points of one vertex on the part itself, shortest path first, each `found`: on a concave
/// piece there may be several. Empty: none. Cost: two microseconds to tell patches of the surface that
/// cannot hold one, then Newton steps from each that is left.
std::vector<ReflectionPoint> findAllReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                                                     const glm::dvec3& vertex,
                                                     const SearchOptions& options = {});

/// The search as published: from the point of the bisector seen from the centre, `steps` midpoint steps along
/// the bisector field projected onto the cube's face, two lookups each, their length doubled where start and
/// middle agree and halved where they do not; vertices behind the part by the inverse search. The error is E
/// = (1 - B.N) / 2. A point whose error is above `threshold` at the end is outOfSteps.
struct PublishedOptions {
    int steps = 9;
    double threshold = 1e-4;  ///< of E; about a degree
};
void findReflectionPointsAsPublished(const ReflectorMap& map, const glm::dvec3& eye,
                                     std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                                     const PublishedOptions& options = {});

}  // namespace reflection
