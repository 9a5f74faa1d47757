#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

/// The corners of a cube map's cells as points of a lattice on the cube: those that faces share are one point
/// with one number, and every point knows its four neighbours (three at the cube's own corners).
class CubeLattice {
  public:
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    explicit CubeLattice(int cellsPerSide);

    std::size_t size() const { return points.size(); }
    /// The point's place on the cube of half side 1.
    const glm::dvec3& point(std::uint32_t id) const { return points[id]; }
    /// Neighbours along +x -x +y -y +z -z; `none` where the step leaves the cube's surface.
    const std::array<std::uint32_t, 6>& neighbours(std::uint32_t id) const { return steps[id]; }
    /// The point of a corner as ReflectorMap::cornerIndex numbers them.
    std::uint32_t ofCorner(std::size_t cornerIndex) const { return ids[cornerIndex]; }

  private:
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::uint32_t, 6>> steps;
    std::vector<std::uint32_t> ids;
};

}  // namespace reflection
