#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "city/terrain/Overhang.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// First entry of a ray into a heightfield with columns that hang above it (city::Overhang): solid from an
/// underside up to a top.
///
/// Both together are traced as columns without air beneath them first: where such a ray ends on the ground,
/// on a house or in the side or the top of what hangs, it ends so in truth. Only a ray that comes in below an
/// underside goes on from there, cell by cell until it is out again, and then as before.
///
/// A column that hangs is entered, at the ray's start too, where z is between underside and top, both
/// included. What is solid is met exactly where GridTracer meets it without anything that hangs; borders
/// below what hangs are computed in doubles, heights on entry compared in floats, so that a ray within a
/// rounding error (some 1e-6 of the height, of t) of an edge may be told as on either side.
class HangingTracer {
  public:
    /// Copies what it needs. Both must have the same cells (std::invalid_argument). Cost: that of another
    /// GridTracer, and 9 bytes a cell.
    HangingTracer(const city::Heightfield& solid, const city::Overhang& hanging);

    /// Entries with t > tMax count as misses. Cost: as GridTracer's for rays that do not pass below what
    /// hangs; else three times that, and some nanoseconds for each cell below it.
    TraceResult trace(const city::Ray& ray, float tMax) const;

    /// As GridTracer::traceFan.
    void traceFan(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy,
                  std::span<const float> dz, std::span<float> t) const;

  private:
    struct Column {
        float underside = 0, top = 0;
    };
    bool inside(glm::ivec2 cell) const {
        return cell.x >= 0 && cell.y >= 0 && cell.x < width_ && cell.y < height_;
    }
    std::size_t index(glm::ivec2 cell) const {
        return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(cell.x);
    }
    TraceResult below(const city::Ray& ray, float tMax, const TraceResult& entered) const;

    int width_, height_;
    double cellSize_;
    glm::dvec2 origin_;
    GridTracer solid_;
    GridTracer filled_;  ///< with what hangs down to the ground
    std::vector<Column> columns_;
    enum : std::uint8_t { hangs = 1, near = 2 };
    std::vector<std::uint8_t> marks_;  ///< near: the cell or one of the eight around it hangs
};

}  // namespace reflection
