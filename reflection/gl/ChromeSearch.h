#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <type_traits>
#include <vector>

#include "reflection/chrome/ReflectionPoint.h"
#include "reflection/chrome/ReflectorMap.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Program.h"

namespace reflection {

/// What the GPU writes for each vertex, std430: 48 bytes, so that a vertex array can take `fromEye` from it
/// (three floats, offset 0) and `status` (an unsigned integer, offset 12). Frame: the reflector's axes,
/// metres.
struct GpuReflection {
    glm::vec3 fromEye{0};  ///< VirtualVertex::fromEye, of hidden vertices too
    std::uint32_t status = static_cast<std::uint32_t>(ReflectionStatus::invalid);
    glm::vec3 point{0};  ///< relative to the map's centre
    float residual = 0;  ///< radians
    glm::vec3 normal{0};
    float path = 0;
    ReflectionStatus statusOf() const { return static_cast<ReflectionStatus>(status); }
};
static_assert(sizeof(GpuReflection) == 48 && std::is_trivially_copyable_v<GpuReflection>);

/// A reflector map's copy on the GPU. Needs a current GL 4.5 context at construction and destruction; the map
/// is not needed afterwards.
class ChromeMapBuffer {
  public:
    /// Precondition: the map is not empty.
    explicit ChromeMapBuffer(const ReflectorMap& map);

    std::size_t bytes() const { return bytes_; }
    const ReflectorMap& map() const { return map_; }

  private:
    friend class ChromeSearch;
    ReflectorMap map_;  ///< for what all vertices of a search share
    gl::Buffer corners_, coverage_, normals_;
    std::size_t bytes_ = 0;
};

/// findReflectionPoints on the GPU, an invocation a vertex: hidden vertices first, then the same starts and
/// safeguarded Newton steps in float. Float settles a vertex where its rounding moves the point and the
/// mirrored vertex by at most 3e-5 radians as seen from the eye (the rounding of bisectors, 5e-7 at distances
/// of one radius, through the inverse of the Newton step's matrix) and where line of sight and rim are clear
/// of the outline by that rounding. The others go to a second pass with the same steps in double precision,
/// what that does not settle and all vertices on concave pieces to a third, a group of invocations a vertex,
/// which looks everywhere as the processor's search does. All loops are bounded and every vertex gets a
/// status: found, hidden, unreflected, or invalid where it is not finite.
///
/// Nothing is read back or waited for: lists of what is left stay on the GPU, dispatches are indirect.
/// Against the processor's search: points and virtual vertices within 1e-4 radians as seen from the eye, the
/// same statuses but where the outline passes through the vertex to within a double's rounding and, on open
/// pieces, where the closing surface's creases show a vertex a second time: which point is reached may hang
/// on the last bit then (one of 16,000 on a saloon's front).
///
/// Needs a current GL 4.5 context in every call and at destruction.
class ChromeSearch {
  public:
    /// Throws std::runtime_error when the shaders are missing or do not compile.
    ChromeSearch();

    /// Searches for `count` vertices: tightly packed vec3 in a buffer, relative to the map's centre, in the
    /// reflector's axes, metres. Writes as many GpuReflection to the buffer `results`. The eye is in the
    /// reflector's frame; where it is not finite all vertices are invalid. Ends with barriers for drawing
    /// from `results` as vertices and for reading it in shaders and copies.
    void search(const ChromeMapBuffer& map, const glm::dvec3& eye, std::uint32_t vertices, std::size_t count,
                std::uint32_t results);

    /// How many vertices of the last search went to the second and third pass; waits for the GPU.
    struct Left {
        std::uint32_t toDouble = 0, toThorough = 0;
    };
    Left leftOfLast() const;

    /// Waits for the GPU: for tests and measurements.
    static std::vector<GpuReflection> read(std::uint32_t results, std::size_t count);

  private:
    gl::Program fast_, precise_, thorough_;
    gl::Buffer block_, counts_, left_;
    std::size_t capacity_ = 0;
    bool concave_ = false;
    std::uint32_t lastCount_ = 0;
};

}  // namespace reflection
