#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "city/geometry/Mesh.h"
#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

/// A point of a chrome part's surface, in the part's frame.
struct SurfacePoint {
    glm::dvec3 position{0};
    glm::dvec3 normal{0, 0, 1};
};

/// Up to `most` points of a piece's own triangles, as far from each other as they go: the first ones say
/// most of where it lies. Deterministic. Cost: `most` passes over some thousand corners.
std::vector<SurfacePoint> spreadPoints(const city::Mesh& mesh, std::size_t most);

/// Where an eye seems to stand for those who look at it in a piece: the point that the rays on which it sees
/// a body in the piece come from, were they straight.
///
/// For a plane that is the eye's mirror image; for a curved piece the rays near one ray come from two focal
/// lines (along and across the plane of incidence), and the point between them is off by an angle that grows
/// with the body's size: b (f1 - f2) / 2 (D + f)^2 for a body of half width b at a distance D and focal
/// lines f1 and f2 behind the surface. It is not derived from curvatures, but found as the point nearest to
/// the rays of searched reflection points, so that `stray` holds whatever bends them.
struct BounceEye {
    glm::dvec3 eye{0};
    /// Radians, the worst at a point: between the ray that reaches it from the piece and that from `eye`. pi
    /// where no single eye explains them: rays that meet in front of the body, or fewer than three points.
    double stray = 3.14159265358979;
    std::vector<std::size_t> seen;  ///< indices of the points that face the piece where they are seen in it
    std::vector<glm::dvec3> at;     ///< of these, where in the piece they are seen
};

/// `points`: of the body, in the piece's frame. Cost: a search for each.
BounceEye bounceEye(const ReflectorMap& map, const glm::dvec3& eye, std::span<const SurfacePoint> points,
                    const SearchOptions& search = {});

}  // namespace reflection
