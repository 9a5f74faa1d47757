#include "reflection/tracing/OpenRectangles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reflection/tracing/TracedGrid.h"

namespace reflection {

namespace {

/// How much higher than its corner cell a rectangle's columns may be: kerbs and low steps (0.15 m) must not
/// end it, but a ray that sinks below the level walks cell by cell.
constexpr float bandMetres = 0.25f;
constexpr float bandPerCellSize = 0.25f;
/// On bumpy ground (pitched roofs, crowns of trees) such rectangles shrink to a few cells. There a wider band
/// serves better, for the rays that pass well above.
constexpr float wideBand = 2.0f;
/// The wider band is taken where its leaps are more than this many times as long.
constexpr int worthWidening = 2;
constexpr int small = 8;  ///< cells; larger ones are left as they are
constexpr int longest = OpenRectangles::longest;
constexpr int highestLevel = 65534;
constexpr int endless = 65535;  ///< a column without a top

/// Level of each cell: the lowest whose height, as the walks compute it, is not below the column.
std::vector<std::uint16_t> levelsOf(const TracedGrid& grid, const OpenRectangles& scale) {
    std::vector<std::uint16_t> levels(static_cast<std::size_t>(grid.width) *
                                      static_cast<std::size_t>(grid.height));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, levels.size(), 65536), [&](const auto& range) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
            const std::size_t width = static_cast<std::size_t>(grid.width);
            const float h = grid.column(static_cast<int>(k % width), static_cast<int>(k / width));
            if (h == std::numeric_limits<float>::infinity()) {
                levels[k] = endless;
                continue;
            }
            int level = 0;
            if (h > scale.base) {
                level = static_cast<int>(
                    std::min((h - scale.base) / scale.step, static_cast<float>(highestLevel)));
                while (level > 0 && scale.levelHeight(level - 1) >= h) --level;
                while (level < endless && scale.levelHeight(level) < h) ++level;
            }
            levels[k] = static_cast<std::uint16_t>(level);
        }
    });
    return levels;
}

/// One row's runs: from each cell onwards in the direction of x, how many cells stay within the band, and
/// their highest.
struct Run {
    std::uint8_t length;
    std::uint16_t highest;
};

void findRuns(const std::uint16_t* levels, int width, int step, int band, Run* runs) {
    const int first = step > 0 ? width - 1 : 0;
    for (int n = 0, i = first; n < width; ++n, i -= step) {
        const int limit = levels[i] + band;
        int length = 1;
        int highest = levels[i];
        const int available = std::min(n + 1, longest);
        while (length < available) {
            const int k = i + step * length;
            if (levels[k] > limit) break;
            if (runs[k].highest <= limit) {  // the whole run from there fits
                highest = std::max<int>(highest, runs[k].highest);
                length += runs[k].length;
            } else {
                highest = std::max<int>(highest, levels[k]);
                ++length;
            }
        }
        runs[i] = {static_cast<std::uint8_t>(std::min(length, available)),
                   static_cast<std::uint16_t>(highest)};
    }
}

struct Rectangle {
    int width;
    int height;
    int level;
};

/// Of all rectangles in the staircase of runs, the one with the longest leap averaged over directions: w h /
/// (w + h) ranks them nearly as the integral of min(w / cos, h / sin) does. `stride` leads to the next row.
Rectangle bestRectangle(const std::uint16_t* levels, const Run* runs, std::ptrdiff_t corner,
                        std::ptrdiff_t stride, int rows, int band) {
    const int limit = levels[corner] + band;
    int narrowest = longest;
    int highest = levels[corner];
    Rectangle best{1, 1, levels[corner]};
    std::ptrdiff_t at = corner;
    for (int k = 1; k <= rows; ++k, at += stride) {
        if (levels[at] > limit || runs[at].highest >= endless) break;
        narrowest = std::min<int>(narrowest, runs[at].length);
        highest = std::max<int>(highest, runs[at].highest);
        const int area = best.width * best.height;
        const int sum = best.width + best.height;
        if (narrowest * k * sum > area * (narrowest + k)) best = {narrowest, k, highest};
        // Even with all rows left, nothing this narrow can win any more.
        if (narrowest * rows * sum <= area * (narrowest + rows)) break;
    }
    return best;
}

}  // namespace

void findOpenRectangles(TracedGrid& grid) {
    OpenRectangles result;
    float top = grid.bottom;
    for (std::size_t k = 0; k < grid.cells; ++k)
        if (std::isfinite(grid.column(k))) top = std::max(top, grid.column(k));
    result.base = grid.bottom;
    // A little coarser than range / highestLevel, so that the top fits in spite of rounding.
    result.step = std::max((top - grid.bottom) / 65000.0f, 1e-4f);
    while (result.levelHeight(highestLevel) < top) result.step *= 1.01f;

    const std::vector<std::uint16_t> levels = levelsOf(grid, result);
    const int width = grid.width;
    const int height = grid.height;
    const float bandHeight = std::max(bandMetres, bandPerCellSize * static_cast<float>(grid.cellSize));
    const int band = static_cast<int>(std::min(bandHeight / result.step, 60000.0f));
    const int wide = std::max(band, static_cast<int>(std::min(wideBand / result.step, 30000.0f)));
    std::vector<Run> runs(levels.size());
    std::vector<Run> wideRuns(levels.size());
    // A rectangle's level is at most two bands above its corner: the limit of a row's own run, which starts
    // within the band.
    constexpr int lifts = 15;
    result.lift = std::max(1, (2 * wide + lifts * lifts - 1) / (lifts * lifts));
    grid.open = result;
    const auto rowStart = [&](int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width);
    };

    for (int q = 0; q < 4; ++q) {
        const int stepX = (q & 1) != 0 ? -1 : 1;
        const int stepY = (q & 2) != 0 ? -1 : 1;
        OpenRectangles::Entry* entries = grid.tables.data() + grid.entriesOf(static_cast<std::size_t>(q));
        tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& range) {
            for (int j = range.begin(); j != range.end(); ++j) {
                findRuns(&levels[rowStart(j)], width, stepX, band, &runs[rowStart(j)]);
                findRuns(&levels[rowStart(j)], width, stepX, wide, &wideRuns[rowStart(j)]);
            }
        });
        tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& range) {
            for (int j = range.begin(); j != range.end(); ++j) {
                const int rows = std::min(longest, stepY > 0 ? height - j : j + 1);
                for (int i = 0; i < width; ++i) {
                    const std::size_t corner = rowStart(j) + static_cast<std::size_t>(i);
                    // Entry 0 for endless and empty columns.
                    if (levels[corner] == endless || !std::isfinite(grid.column(i, j))) continue;
                    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(stepY) * width;
                    const auto from = static_cast<std::ptrdiff_t>(corner);
                    Rectangle best = bestRectangle(levels.data(), runs.data(), from, stride, rows, band);
                    if (std::min(best.width, best.height) < small) {
                        const Rectangle wider =
                            bestRectangle(levels.data(), wideRuns.data(), from, stride, rows, wide);
                        if (wider.width * wider.height * (best.width + best.height) >
                            worthWidening * best.width * best.height * (wider.width + wider.height))
                            best = wider;
                    }
                    int lift = 0;
                    while (levels[corner] + lift * lift * result.lift < best.level) ++lift;
                    entries[grid.index(i, j)] = static_cast<OpenRectangles::Entry>(best.width) |
                                                static_cast<OpenRectangles::Entry>(best.height) << 6 |
                                                static_cast<OpenRectangles::Entry>(lift) << 12 |
                                                static_cast<OpenRectangles::Entry>(levels[corner]) << 16;
                }
            }
        });
    }
}

}  // namespace reflection
