#pragma once

#include <cstdint>
#include <vector>

namespace reflection {

struct TracedGrid;

/// For every cell and each of the four quadrants of directions, a rectangle of cells with its corner in that
/// cell and no column in it higher than a level little above the cell's own: the stretch over which a ray
/// from there, above that level, can leap. In a street that is the way to the facades; on a roof the way to
/// its edge. The idea is that of empty-space skipping by distance fields (Cohen & Sheffer 1994, "Proximity
/// clouds"), with a rectangle a quadrant in place of one distance for all.
struct OpenRectangles {
    /// Bits 0-7: cells along x (0: no leap from here), 8-15: cells along y, 16-31: level, rounded up.
    using Entry = std::uint32_t;

    float base = 0;  ///< metres
    float step = 1;  ///< metres a level
    /// Four times the grid's cells: one after the other the quadrants (bit 0: towards -x, bit 1: towards -y),
    /// each in the order of the grid's columns.
    std::vector<Entry> entries;

    /// The level's height in metres, as the walks compute it: never below any column of the rectangle.
    float levelHeight(std::uint32_t level) const { return base + static_cast<float>(level) * step; }
};

/// Cost: about 0.1 us a cell, on all cores. Memory: 16 bytes a cell.
OpenRectangles findOpenRectangles(const TracedGrid& grid);

}  // namespace reflection
