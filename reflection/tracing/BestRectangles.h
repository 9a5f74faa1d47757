#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflection/tracing/OpenRectangles.h"

namespace reflection {

/// Rows of cells one after the other, with room for a vector behind the last.
template <class T>
struct CellRows {
    int width = 0;
    std::vector<T> cells;

    CellRows(int columns, int rows)
        : width(columns), cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) + 64) {}
    T* row(int j) { return cells.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(width); }
    const T* row(int j) const {
        return cells.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(width);
    }
};

/// Runs along a row: from each cell onwards in the quadrant's direction of x, how many cells are no more than
/// `band` levels above it (at most OpenRectangles::longest), and the highest of them.
struct Runs {
    int band = 0;
    CellRows<std::uint8_t> length;
    CellRows<std::uint16_t> highest;

    Runs(int levels, int columns, int rows) : band(levels), length(columns, rows), highest(columns, rows) {}
};

constexpr int highestLevel = 65534;
constexpr int endlessLevel = 65535;  ///< of a column without a top

/// What the rectangles of one quadrant are made from.
struct RectangleSource {
    const CellRows<std::uint16_t>& levels;
    const Runs& runs;
    const Runs& wideRuns;
    int height;         ///< rows
    int stepY;          ///< 1 or -1: the quadrant's direction of y
    std::int32_t lift;  ///< OpenRectangles::lift
};

/// Entries of the cells of row j; 0 for endless ones. `entries` has room for a vector behind the row's last
/// cell. Cost: as many steps for a vector of cells as its longest search has rows, at most 63; with the
/// widest vectors that the processor has.
void findRowOfRectangles(const RectangleSource& source, int j, OpenRectangles::Entry* entries);

}  // namespace reflection
