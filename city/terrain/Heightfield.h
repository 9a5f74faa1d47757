#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "city/geometry/Aabb.h"

namespace city {

/// A grid of square columns seen from above. Column (i, j) covers x in [origin.x + i*cellSize, origin.x +
/// (i+1)*cellSize) and y likewise, and is solid from -infinity up to its height (metres, world z). NaN and
/// -infinity both mean "no column here" (nothing to hit); +infinity is a column without a top. Row-major, row
/// j = 0 at the south edge.
class Heightfield {
  public:
    /// Columns all at -infinity. Throws std::invalid_argument unless width, height >= 1 and cellSize is
    /// finite and positive.
    Heightfield(int width, int height, float cellSize, glm::dvec2 origin);

    int width() const { return width_; }          ///< cells along x
    int height() const { return height_; }        ///< cells along y
    float cellSize() const { return cellSize_; }  ///< metres
    /// South-west corner, world metres.
    glm::dvec2 origin() const { return origin_; }

    float at(int i, int j) const { return cells_[index(i, j)]; }
    void set(int i, int j, float z) { cells_[index(i, j)] = z; }
    std::span<const float> cells() const { return cells_; }
    std::span<float> cells() { return cells_; }

    /// Height under a world position; -infinity outside the grid.
    float heightAt(double x, double y) const;
    /// Highest finite column, or -infinity where there is none.
    float highest() const;

  private:
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(i);
    }

    int width_;
    int height_;
    float cellSize_;
    glm::dvec2 origin_;
    std::vector<float> cells_;
};

}  // namespace city
