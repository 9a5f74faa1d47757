#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "city/roads/Polyline.h"

namespace city {

/// A set of areas in the plan with exact set algebra (GEOS, on a grid of a millimetre, where its overlays are
/// robust). Value semantics; an operation that GEOS cannot do gives the left operand back.
class Region {
  public:
    Region();  ///< empty
    /// Strip of `half` metres on both sides of a line, cut off square at its ends.
    static Region strip(const Polyline& line, double half);
    static Region disc(const glm::dvec3& centre, double radius);
    static Region convexHull(std::span<const glm::dvec3> points);
    static Region united(std::span<const Region> parts);

    Region with(const Region& other) const;
    Region without(const Region& other) const;
    Region within(const Region& other) const;
    /// Grown by a distance (shrunk by a negative one), with round corners.
    Region grown(double distance) const;
    /// Grown with corners kept sharp: few points more than before.
    Region widened(double distance) const;
    /// Without points that lie within `tolerance` metres of the line between their neighbours; topology is
    /// kept.
    Region simplified(double tolerance) const;
    Region clipped(double minX, double minY, double maxX, double maxY) const;

    bool empty() const;
    double area() const;
    /// minX, minY, maxX, maxY; zeros for an empty region.
    std::array<double, 4> bounds() const;
    /// Triangles, counter-clockwise, three corners each.
    std::vector<glm::dvec2> triangles() const;
    /// Borders with the region on their left; first point repeated at the end.
    std::vector<std::vector<glm::dvec2>> borders() const;

  private:
    struct Geometry;
    explicit Region(std::shared_ptr<const Geometry> geometry);
    std::shared_ptr<const Geometry> geometry_;
};

}  // namespace city
