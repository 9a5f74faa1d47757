#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

/// A triangle as the search for a centre sees it.
struct FacingTriangle {
    std::array<glm::dvec3, 3> corners;
    glm::dvec3 normal;  ///< unit length
};

/// Least cosine between the normals (times sign) and the lines from the centre to the corners.
double starMargin(const FacingTriangle& triangle, const glm::dvec3& centre, double sign);

/// Moves the centre until it sees all triangles from behind (sign 1) or in front (sign -1) with a margin of
/// at least `wanted`, or as near to that as it comes within `steps` moves, each away from the triangle that
/// is seen worst. Returns the margin reached. Stopping at a wanted margin keeps the centre close: from far
/// away any surface is seen steeply, but covers few cells of a map. Cost: triangles times steps.
double findStarCentre(const std::vector<FacingTriangle>& triangles, double sign, double wanted, int steps,
                      glm::dvec3& centre);

/// Draws a centre that sees the triangles with some margin straight towards `target` (their middle), as near
/// as it keeps `least` of it (or all of what it has, if that is less); returns the margin there. From near by
/// a surface covers more of a map.
double drawStarCentre(const std::vector<FacingTriangle>& triangles, double sign, const glm::dvec3& target,
                      double least, glm::dvec3& centre);

}  // namespace reflection
