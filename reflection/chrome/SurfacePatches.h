#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace reflection {

class ReflectorMap;

/// A reflector map's surface as patches of some cells, each with a ball around its points and a cone around
/// its normals: what tells where a reflection point can be at all. Frame: the map's.
///
/// Normals of a cell are blended from its corners', so they lie in the corners' cone. Points between corners
/// may leave the ball of the corners by a hundredth of its radius where the surface bends by a right angle
/// over a face; balls are a tenth larger. Of convex pieces, where nobody asks for them, there are none.
class SurfacePatches {
  public:
    SurfacePatches() = default;
    explicit SurfacePatches(const ReflectorMap& map);

    std::size_t size() const { return starts.size(); }
    std::size_t bytes() const {
        return starts.size() * sizeof(glm::vec3) + 9 * sizeof(float) * numbers[0].size();
    }
    /// A patch's middle on the cube, stretch taken out: where to start from.
    const glm::vec3& start(std::uint32_t patch) const { return starts[patch]; }

    /// Patches in which the bisector of the directions to eye and vertex can be the normal, in their order.
    /// The bisector's direction leaves that at the ball's centre by the angles under which eye and vertex see
    /// the ball, over the bisector's length. Groups of patches first. Cost: half a microsecond.
    void mayReflect(const glm::dvec3& eye, const glm::dvec3& vertex, std::vector<std::uint32_t>& to) const;

    /// Numbers of all patches side by side, padded by patches that reflect nothing, then those of groups of
    /// sixteen, then of groups of those.
    enum Row : std::uint8_t { centreX, centreY, centreZ, radius, axisX, axisY, axisZ, cosine, sine, rows };
    static constexpr std::size_t padding = 16;
    const float* row(Row r) const { return numbers[r].data(); }

  private:
    std::vector<glm::vec3> starts;
    std::array<std::vector<float>, rows> numbers;
};

}  // namespace reflection
