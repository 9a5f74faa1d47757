#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"
#include "reflection/tracing/LargeArray.h"
#include "reflection/tracing/OpenRectangles.h"

namespace reflection {

struct TraceResult;
struct TracedGrid;

/// Numbers that leapWalk needs for every ray of a grid (derived in LeapWalk.h). A ray's height is counted in
/// levels of OpenRectangles: (z - base) / step.
struct LeapScale {
    glm::dvec2 size{0};    ///< cells
    double steepest = 0;   ///< least share of a ray's speed that its slower horizontal axis must have
    double perLevel = 1;   ///< levels a metre
    double slack = 0;      ///< levels: a height this near to a level cannot be told from it
    double landing = 0;    ///< levels above a rectangle's to which a ray may leap
    double clearance = 0;  ///< levels above a rectangle's from which it may leap; more than `landing`
    double wall = 0;       ///< levels below a cell's at which a ray is certainly inside it
    double top = 0;        ///< level above which there is certainly no column
    std::array<double, 16> lifts{};  ///< levels of a rectangle above its cell, by bits 12-15 of its entry
    /// leapWalk, compiled for this processor.
    TraceResult (*walk)(const TracedGrid&, const city::Ray&, float) = nullptr;
};

/// What the tracer keeps of a heightfield: its planes, its columns, and where it may leap.
struct TracedGrid {
    int width = 0;
    int height = 0;
    double cellSize = 1;      ///< metres; a float's value
    double perCell = 1;       ///< 1 / cellSize
    glm::dvec2 origin{0};     ///< south-west corner, world metres
    float top = 0;            ///< highest column, -infinity when all are empty; may be +infinity
    float bottom = 0;         ///< lowest column that is neither empty nor endless; 0 when there is none
    float largest = 0;        ///< largest absolute height of those
    std::size_t tileRow = 0;  ///< cells in a row of tiles
    std::size_t cells = 0;    ///< in all tiles; those beyond the grid are empty
    /// By `index`: the bits of the columns' heights, empty ones at -infinity, never NaN; behind them, if
    /// `leaps`, the OpenRectangles::Entry of each quadrant (bit 0: towards -x, bit 1: towards -y). One array,
    /// so that rays that need a height and rays that need a rectangle can be gathered from together.
    LargeArray<std::uint32_t> tables;
    bool leaps = false;  ///< are there rectangles, and are the borders regular enough for LeapWalk?
    OpenRectangles open;
    LeapScale scale;

    /// Cell borders. These doubles *are* the borders: i * cellSize is exact (at most 17 + 24 bits), the sum
    /// rounds once, and the constructor of GridTracer has made sure that the borders increase.
    double planeX(int i) const { return origin.x + static_cast<double>(i) * cellSize; }
    double planeY(int j) const { return origin.y + static_cast<double>(j) * cellSize; }
    /// Column or row of a coordinate under the half-open rule: -1 below the grid, `width` or `height` above
    /// it.
    int cellX(double x) const { return cellOf(x, origin.x, width); }
    int cellY(double y) const { return cellOf(y, origin.y, height); }
    /// Tiles of 4 x 4 cells, row by row, and in a tile column by column: 16 neighbours share a cache line.
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j >> 2) * tileRow + static_cast<std::size_t>(4 * i + (j & 3));
    }
    float column(std::size_t at) const { return std::bit_cast<float>(tables[at]); }
    float column(int i, int j) const { return column(index(i, j)); }
    /// Where a quadrant's entries begin in `tables`.
    std::size_t entriesOf(std::size_t quadrant) const { return (quadrant + 1) * cells; }

  private:
    int cellOf(double value, double first, int count) const {
        const auto border = [&](int k) { return first + static_cast<double>(k) * cellSize; };
        if (value < border(0)) return -1;
        if (value >= border(count)) return count;
        // A guess that rounding may have put into a neighbour, then the rule itself.
        int k = static_cast<int>((value - first) * perCell);
        if (k > count - 1) k = count - 1;
        while (value < border(k)) --k;
        while (value >= border(k + 1)) ++k;
        return k;
    }
};

}  // namespace reflection
