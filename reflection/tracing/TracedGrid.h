#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>

#include "city/terrain/Heightfield.h"
#include "reflection/tracing/LargeArray.h"
#include "reflection/tracing/OpenRectangles.h"

namespace reflection {

/// What the tracer keeps of a heightfield: its planes, its columns, and where it may leap.
struct TracedGrid {
    int width = 0;
    int height = 0;
    double cellSize = 1;   ///< metres; a float's value
    double perCell = 1;    ///< 1 / cellSize
    glm::dvec2 origin{0};  ///< south-west corner, world metres
    float top = 0;         ///< highest column, -infinity when all are empty; may be +infinity
    float bottom = 0;      ///< lowest column that is neither empty nor endless; 0 when there is none
    float largest = 0;     ///< largest absolute height of those
    LargeArray<float>
        columns;  ///< by `index`; empty ones, and those that fill the last tiles, at -infinity; never NaN
    std::size_t tileRow = 0;  ///< cells in a row of tiles
    bool leaps = false;       ///< is `open` filled, and are the borders regular enough for LeapWalk?
    OpenRectangles open;

    /// Cell borders. These doubles *are* the borders: i * cellSize is exact (at most 17 + 24 bits), the sum
    /// rounds once, and the constructor of GridTracer has made sure that the borders increase.
    double planeX(int i) const { return origin.x + static_cast<double>(i) * cellSize; }
    double planeY(int j) const { return origin.y + static_cast<double>(j) * cellSize; }
    /// Column or row of a coordinate under the half-open rule: -1 below the grid, `width` or `height` above
    /// it.
    int cellX(double x) const { return cellOf(x, origin.x, width); }
    int cellY(double y) const { return cellOf(y, origin.y, height); }
    /// Tiles of 4 x 4 cells, row by row, and so are the cells in a tile: 16 neighbours share a cache line.
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j >> 2) * tileRow +
               static_cast<std::size_t>((j & 3) * 4 + 4 * i - 3 * (i & 3));
    }
    float column(int i, int j) const { return columns[index(i, j)]; }

  private:
    int cellOf(double value, double first, int cells) const {
        const auto border = [&](int k) { return first + static_cast<double>(k) * cellSize; };
        if (value < border(0)) return -1;
        if (value >= border(cells)) return cells;
        // A guess that rounding may have put into a neighbour, then the rule itself.
        int k = static_cast<int>((value - first) * perCell);
        if (k > cells - 1) k = cells - 1;
        while (value < border(k)) --k;
        while (value >= border(k + 1)) ++k;
        return k;
    }
};

}  // namespace reflection
