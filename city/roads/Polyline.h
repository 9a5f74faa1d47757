#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace city {

/// Curves in the plan (z is carried along, lengths and directions are those of x and y). All take and give
/// points without equal neighbours where they can; a curve of fewer than two points is "no curve".
using Polyline = std::vector<glm::dvec3>;

/// Drops points that are not finite and neighbours closer than `tolerance` metres; the last point is kept.
Polyline withoutDuplicates(std::span<const glm::dvec3> points, double tolerance);

double lengthOf(const Polyline& line);

/// Point at a distance from the start; clamped to the ends.
glm::dvec3 pointAt(const Polyline& line, double distance);

/// Unit direction in the plan at a distance from the start; (1, 0, 0) for no curve.
glm::dvec3 directionAt(const Polyline& line, double distance);

/// The part between two distances from the start, a < b; both clamped.
Polyline partOf(const Polyline& line, double a, double b);

Polyline reversed(Polyline line);

/// Rounds corners to arcs of about `radius` metres where the legs are long enough (quadratic Bezier, points
/// at most about a metre apart). Ends stay.
Polyline rounded(const Polyline& line, double radius);

/// Parallel curve `offset` metres to the right. Points that would run backwards (inside of tight bends) are
/// dropped. At least two points come back for a curve of at least two.
Polyline offsetToTheRight(const Polyline& line, double offset);

/// Smooth curve from p (unit direction u) to q (unit direction v); points at most `spacing` metres apart.
Polyline smoothCurve(const glm::dvec3& p, const glm::dvec3& u, const glm::dvec3& q, const glm::dvec3& v,
                     double spacing);

/// Nearest point in the plan: its distance along the line, the distance from it, and whether it lies before
/// the start.
struct Nearest {
    double along = 0;
    double distance = 0;
    bool beforeStart = false;
};
Nearest nearestOn(const Polyline& line, const glm::dvec3& p);

/// Unit vector to the right of a direction in the plan.
glm::dvec3 rightOf(const glm::dvec3& direction);

/// Angle in the plan from u to v, counter-clockwise positive, in (-pi, pi].
double turnAngle(const glm::dvec3& u, const glm::dvec3& v);

}  // namespace city
