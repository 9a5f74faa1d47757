#include "reflection/tracing/OpenRectangles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "reflection/tracing/BestRectangles.h"
#include "reflection/tracing/TracedGrid.h"

namespace reflection {

namespace {

/// How much higher than its corner cell a rectangle's columns may be: kerbs and low steps (0.15 m) must not
/// end it, but a ray that sinks below the level walks cell by cell.
constexpr float bandMetres = 0.25f;
constexpr float bandPerCellSize = 0.25f;
constexpr float wideBand = 2.0f;  ///< metres: what BestRectangles tries where the former gives little

/// Level of a column: the lowest whose height, as the walks compute it, is not below it.
std::uint16_t levelOf(float h, const OpenRectangles& scale) {
    if (h == std::numeric_limits<float>::infinity()) return endlessLevel;
    if (!(h > scale.base)) return 0;
    int level = static_cast<int>(std::min((h - scale.base) / scale.step, static_cast<float>(highestLevel)));
    while (level > 0 && scale.levelHeight(level - 1) >= h) --level;
    while (level < endlessLevel && scale.levelHeight(level) < h) ++level;
    return static_cast<std::uint16_t>(level);
}

void findRuns(const std::uint16_t* levels, int step, int j, Runs& runs) {
    std::uint8_t* lengths = runs.length.row(j);
    std::uint16_t* highests = runs.highest.row(j);
    const int width = runs.length.width;
    const int first = step > 0 ? width - 1 : 0;
    for (int n = 0, i = first; n < width; ++n, i -= step) {
        const int limit = std::min(levels[i] + runs.band, highestLevel);  // never an endless column
        int length = 1;
        int highest = levels[i];
        const int available = std::min(n + 1, OpenRectangles::longest);
        while (length < available) {
            const int k = i + step * length;
            if (levels[k] > limit) break;
            if (highests[k] <= limit) {  // the whole run from there fits
                highest = std::max<int>(highest, highests[k]);
                length += lengths[k];
            } else {
                highest = std::max<int>(highest, levels[k]);
                ++length;
            }
        }
        lengths[i] = static_cast<std::uint8_t>(std::min(length, available));
        highests[i] = static_cast<std::uint16_t>(highest);
    }
}

template <class Each>
void forEachRow(int height, Each each) {
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& range) {
        for (int j = range.begin(); j != range.end(); ++j) each(j);
    });
}

}  // namespace

void findOpenRectangles(TracedGrid& grid) {
    OpenRectangles& open = grid.open;
    float top = grid.bottom;
    for (std::size_t k = 0; k < grid.cells; ++k)
        if (std::isfinite(grid.column(k))) top = std::max(top, grid.column(k));
    open.base = grid.bottom;
    // A little coarser than range / highestLevel, so that the top fits in spite of rounding.
    open.step = std::max((top - grid.bottom) / 65000.0f, 1e-4f);
    while (open.levelHeight(highestLevel) < top) open.step *= 1.01f;

    const int width = grid.width;
    const int height = grid.height;
    CellRows<std::uint16_t> levels(width, height);
    forEachRow(height, [&](int j) {
        for (int i = 0; i < width; ++i) levels.row(j)[i] = levelOf(grid.column(i, j), open);
    });
    const float bandHeight = std::max(bandMetres, bandPerCellSize * static_cast<float>(grid.cellSize));
    const int band = static_cast<int>(std::min(bandHeight / open.step, 60000.0f));
    const int wide = std::max(band, static_cast<int>(std::min(wideBand / open.step, 30000.0f)));
    Runs runs(band, width, height);
    Runs wideRuns(wide, width, height);
    // A rectangle's level is at most two bands above its corner: the limit of a row's own run, which starts
    // within the band.
    constexpr int lifts = 15;
    open.lift = std::max(1, (2 * wide + lifts * lifts - 1) / (lifts * lifts));

    for (std::size_t q = 0; q < 4; ++q) {
        const int stepX = (q & 1) != 0 ? -1 : 1;
        const int stepY = (q & 2) != 0 ? -1 : 1;
        forEachRow(height, [&](int j) {
            findRuns(levels.row(j), stepX, j, runs);
            findRuns(levels.row(j), stepX, j, wideRuns);
        });
        OpenRectangles::Entry* entries = grid.tables.data() + grid.entriesOf(q);
        const RectangleSource source{levels, runs, wideRuns, height, stepY, open.lift};
        forEachRow(height, [&](int j) {
            std::vector<OpenRectangles::Entry> row(static_cast<std::size_t>(width) + 64);
            findRowOfRectangles(source, j, row.data());
            for (int i = 0; i < width; ++i)  // entry 0 for endless and empty columns
                if (std::isfinite(grid.column(i, j)))
                    entries[grid.index(i, j)] = row[static_cast<std::size_t>(i)];
        });
    }
}

}  // namespace reflection
