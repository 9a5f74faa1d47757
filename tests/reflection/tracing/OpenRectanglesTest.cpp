#include "reflection/tracing/OpenRectangles.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "reflection/tracing/TracedGrid.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Flat streets with kerbs, blocks of several heights, bumpy ground, and columns that are empty or endless.
TracedGrid streets(int width, int height, std::uint64_t seed) {
    SeededRandom random(seed);
    TracedGrid grid;
    grid.width = width;
    grid.height = height;
    grid.tileRow = (static_cast<std::size_t>(width) + 3) / 4 * 16;
    grid.cells = (static_cast<std::size_t>(height) + 3) / 4 * grid.tileRow;
    grid.tables = LargeArray<std::uint32_t>(5 * grid.cells);
    std::fill_n(grid.tables.data(), grid.cells, std::bit_cast<std::uint32_t>(-infinity));
    grid.bottom = infinity;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            float h = i % 31 < 2 ? 0.15f : 0;
            if (i % 31 > 18 && j % 27 > 12) h = 6.0f + 3.0f * static_cast<float>((i / 31 + j / 27) % 3);
            if (i > width / 2 && j > height / 2) h += static_cast<float>(random.between(0, 3));
            switch (random.below(400)) {
                case 0:
                    h = infinity;
                    break;
                case 1:
                    h = -infinity;
                    break;
                default:
                    break;
            }
            grid.tables[grid.index(i, j)] = std::bit_cast<std::uint32_t>(h);
            if (std::isfinite(h)) grid.bottom = std::min(grid.bottom, h);
        }
    return grid;
}

TEST(OpenRectanglesTest, noColumnStandsAboveItsRectanglesLevel) {
    TracedGrid grid = streets(110, 90, 1);
    findOpenRectangles(grid);
    std::int64_t area = 0;
    for (std::size_t q = 0; q < 4; ++q)
        for (int j = 0; j < grid.height; ++j)
            for (int i = 0; i < grid.width; ++i) {
                const OpenRectangles::Entry entry = grid.tables[grid.entriesOf(q) + grid.index(i, j)];
                const float own = grid.column(i, j);
                const int width = static_cast<int>(entry & 63), height = static_cast<int>((entry >> 6) & 63);
                if (!std::isfinite(own)) {
                    ASSERT_EQ(entry, 0u);
                    continue;
                }
                ASSERT_GE(width, 1);
                ASSERT_GE(height, 1);
                const int ownLevel = static_cast<int>(entry >> 16),
                          lift = static_cast<int>((entry >> 12) & 15);
                ASSERT_LE(own, grid.open.levelHeight(ownLevel));
                ASSERT_TRUE(ownLevel == 0 || own > grid.open.levelHeight(ownLevel - 1));
                const float level = grid.open.levelHeight(ownLevel + lift * lift * grid.open.lift);
                area += width * height;
                for (int b = 0; b < height; ++b)
                    for (int a = 0; a < width; ++a) {
                        const int x = (q & 1) != 0 ? i - a : i + a, y = (q & 2) != 0 ? j - b : j + b;
                        ASSERT_TRUE(x >= 0 && x < grid.width && y >= 0 && y < grid.height);
                        ASSERT_LE(grid.column(x, y), level)
                            << "quadrant " << q << ", cell " << i << ", " << j;
                    }
            }
    EXPECT_GT(area, 40 * 4 * 110 * 90) << "rectangles must be worth their memory";
}

/// What is best, tried rectangle by rectangle: rows are added while the nearest of each is within the band,
/// and each row is as long as its cells stay within the band of its own nearest.
float bestLeap(const TracedGrid& grid, std::size_t q, int i, int j, float band) {
    const int stepX = (q & 1) != 0 ? -1 : 1, stepY = (q & 2) != 0 ? -1 : 1;
    const float own = grid.column(i, j);
    int narrowest = OpenRectangles::longest;
    float best = 0;
    for (int b = 0; b < OpenRectangles::longest; ++b) {
        const int y = j + b * stepY;
        if (y < 0 || y >= grid.height || grid.column(i, y) > own + band) break;
        int a = 0;
        for (; a < narrowest; ++a) {
            const int x = i + a * stepX;
            if (x < 0 || x >= grid.width ||
                grid.column(x, y) > std::max(grid.column(i, y), grid.bottom) + band)
                break;
        }
        narrowest = a;
        best = std::max(best, static_cast<float>(a * (b + 1)) / static_cast<float>(a + b + 1));
    }
    return best;
}

TEST(OpenRectanglesTest, rectanglesLeapAsFarAsTheBestOfTheNarrowBand) {
    TracedGrid grid = streets(100, 95, 2);
    findOpenRectangles(grid);
    for (std::size_t q = 0; q < 4; ++q)
        for (int j = 0; j < grid.height; ++j)
            for (int i = 0; i < grid.width; ++i) {
                if (!std::isfinite(grid.column(i, j))) continue;
                const OpenRectangles::Entry entry = grid.tables[grid.entriesOf(q) + grid.index(i, j)];
                const auto width = static_cast<float>(entry & 63),
                           height = static_cast<float>((entry >> 6) & 63);
                // Levels are rounded: a band a thousandth narrower is within any rounding.
                ASSERT_GE(width * height / (width + height) * 1.000001f, bestLeap(grid, q, i, j, 0.249f))
                    << "quadrant " << q << ", cell " << i << ", " << j;
            }
}

TEST(OpenRectanglesTest, everyInstructionSetFindsTheSame) {
    TracedGrid best = streets(77, 130, 3);
    findOpenRectangles(best);
    const std::int64_t all = hwy::SupportedTargets();
    for (int bit = 0; bit < 63; ++bit) {
        const std::int64_t target = std::int64_t{1} << bit;
        if ((all & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        TracedGrid grid = streets(77, 130, 3);
        findOpenRectangles(grid);
        EXPECT_TRUE(
            std::equal(grid.tables.data(), grid.tables.data() + grid.tables.size(), best.tables.data()))
            << hwy::TargetName(target);
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace reflection
