#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "city/terrain/Heightfield.h"

namespace city {

/// A triangle with x and y in cells from the grid's south-west corner, z in metres.
struct GridTriangle {
    std::array<glm::dvec3, 3> corner;

    /// Twice the area seen from above; positive when counter-clockwise.
    double signedArea2() const {
        const glm::dvec2 a(corner[1] - corner[0]);
        const glm::dvec2 b(corner[2] - corner[0]);
        return a.x * b.y - a.y * b.x;
    }
    /// dz/dx and dz/dy (metres per cell); the triangle must not be vertical.
    glm::dvec2 slope() const {
        const glm::dvec3 a = corner[1] - corner[0];
        const glm::dvec3 b = corner[2] - corner[0];
        const double area = signedArea2();
        return {(a.z * b.y - b.z * a.y) / area, (a.x * b.z - b.x * a.z) / area};
    }
};

/// Finds the cells that triangles cover together, and the greatest height at which they do: the triangles in
/// a cell are taken from the highest down and cut out of the square until nothing of it is left.
class WholeCells {
  public:
    explicit WholeCells(const Heightfield& field) : width_(field.width()), height_(field.height()) {}

    void add(const GridTriangle& triangle);
    /// Raises the field's covered cells. Cost: triangles + pairs of triangle and cell.
    void raise(Heightfield& field) const;

  private:
    struct Pair {
        std::uint64_t cell;
        std::uint32_t triangle;
    };
    int width_;
    int height_;
    std::vector<GridTriangle> triangles_;
    std::vector<Pair> pairs_;
};

}  // namespace city
