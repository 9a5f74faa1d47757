#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/mirrors/MirrorWorld.h"

namespace app {

/// A surface of revolution: a profile of (radius, height) turned about an axis.
///
///      height           The profile is a smooth curve through its points (a cubic spline by the length of
///        |  .           its chords, curvature continuous). A point given twice in a row is a crease. A first
///        | /            or last point of radius 0 lies on the axis, and the curve crosses it level; a last
///        ||  -> front   point equal to the first closes a curve without creases (a ring). The front lies to
///        | \            the right of the way from the first point to the last.
///   foot +--'-- radius
struct Lathe {
    glm::dvec3 foot{0};
    glm::dvec3 axis{0, 0, 1};         ///< any length but 0
    std::vector<glm::dvec2> profile;  ///< metres
    int steps = 1;                    ///< bands between two neighbouring points, at least 1
    int slices = 32;                  ///< at least 3
    /// Radians about the axis, from < to <= from + a whole turn; counted from east towards north about an
    /// upright axis, from the upright about a lying one (more than 26 degrees from z).
    double from = 0, to = 6.283185307179586;

    /// Of its mesh. Precondition: no latheProblem.
    int triangles() const;
    /// The same surface in so many times as many bands and slices.
    Lathe finer(int times) const;
};

/// What keeps a lathe from being one: a clause, and what to do.
struct LatheProblem {
    std::string what, remedy;
};
std::optional<LatheProblem> latheProblem(const Lathe& lathe);

/// The surface itself, of which meshes are samples. Precondition: no latheProblem.
class LatheSurface {
  public:
    struct Point {
        glm::dvec3 position{0};
        glm::dvec3 normal{0, 0, 1};  ///< unit length, towards the front
        bool within = false;         ///< neither on the profile's free ends nor outside the arc
    };

    explicit LatheSurface(const Lathe& lathe);

    /// The nearest point (all around the axis, whatever the arc). On the axis itself, one of them. Cost: some
    /// microseconds for a profile of ten points.
    Point nearest(const glm::dvec3& p) const;
    /// Corners on the surface with its normals, split at creases. `second` colours every other smooth part of
    /// the profile.
    LitMesh mesh(const glm::vec3& colour, const glm::vec3& second) const;

  private:
    /// A smooth part of the profile: a point and a derivative at each knot.
    struct Run {
        std::vector<double> knots;
        std::vector<glm::dvec2> points, slopes;
        bool closed = false;
    };
    struct CurvePoint {
        glm::dvec2 at, first, second;
    };
    struct Guide {
        std::size_t run;
        double t;
        glm::dvec2 at;
    };
    static Run splined(const std::vector<glm::dvec2>& points);
    static CurvePoint sample(const Run& run, double t);

    Lathe shape_;
    glm::dvec3 axis_, u_, v_;
    std::vector<Run> runs_;
    std::vector<Guide> guides_;  ///< where the search for the nearest point begins
};

}  // namespace app
