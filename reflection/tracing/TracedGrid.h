#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "city/terrain/Heightfield.h"

namespace reflection {

/// What the tracer keeps of a heightfield: its planes, its columns, and (see OpenRectangles) where it may
/// leap.
struct TracedGrid {
    int width = 0;
    int height = 0;
    double cellSize = 1;         ///< metres; a float's value
    glm::dvec2 origin{0};        ///< south-west corner, world metres
    float top = 0;               ///< highest column, -infinity when all are empty; may be +infinity
    float bottom = 0;            ///< lowest column that is neither empty nor endless; 0 when there is none
    std::vector<float> columns;  ///< row-major; empty ones at -infinity, never NaN

    /// Cell borders. These doubles *are* the borders: i * cellSize is exact (at most 17 + 24 bits), the sum
    /// rounds once, and the constructor of GridTracer has made sure that the borders increase.
    double planeX(int i) const { return origin.x + static_cast<double>(i) * cellSize; }
    double planeY(int j) const { return origin.y + static_cast<double>(j) * cellSize; }
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
    }
    float column(int i, int j) const { return columns[index(i, j)]; }
};

}  // namespace reflection
