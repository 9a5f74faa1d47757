#include "reflection/tracing/GridTracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "reflection/tracing/HangingTracer.h"
#include "reflection/tracing/LeapWalk.h"
#include "reflection/tracing/TracedGrid.h"

namespace reflection {

namespace {

double normalisedOrigin(double value) {
    return std::abs(value) < 0x1p-500 ? 0 : value;
}

void requireDistinctBorders(double origin, double cellSize, int cells) {
    if (!(std::abs(origin) <= 1e30))
        throw std::invalid_argument("a heightfield to be traced must lie within 1e30 m of the origin");
    double previous = origin;
    for (int k = 1; k <= cells; ++k) {
        const double next = origin + static_cast<double>(k) * cellSize;
        if (!(next > previous))
            throw std::invalid_argument(
                "a heightfield to be traced is too far from the origin for its cell size: move it nearer");
        previous = next;
    }
}

}  // namespace

GridTracer::GridTracer(const city::Heightfield& field) {
    const glm::dvec2 origin(normalisedOrigin(field.origin().x), normalisedOrigin(field.origin().y));
    requireDistinctBorders(origin.x, field.cellSize(), field.width());
    requireDistinctBorders(origin.y, field.cellSize(), field.height());

    auto grid = std::make_shared<TracedGrid>();
    grid->width = field.width();
    grid->height = field.height();
    grid->cellSize = field.cellSize();
    grid->perCell = 1 / grid->cellSize;
    grid->origin = origin;
    const std::size_t tilesX = (static_cast<std::size_t>(grid->width) + 3) / 4;
    const std::size_t tilesY = (static_cast<std::size_t>(grid->height) + 3) / 4;
    grid->tileRow = tilesX * 16;
    grid->cells = tilesY * grid->tileRow;
    grid->top = -std::numeric_limits<float>::infinity();
    float bottom = std::numeric_limits<float>::infinity();
    for (const float h : field.cells()) {
        if (std::isnan(h)) continue;
        grid->top = std::max(grid->top, h);
        if (!std::isfinite(h)) continue;
        bottom = std::min(bottom, h);
        grid->largest = std::max(grid->largest, std::abs(h));
    }
    grid->bottom = std::isfinite(bottom) ? bottom : 0;
    // Borders that rounding shifts by no more than 2^-30 of a cell, heights far from overflow, indices of 31
    // bits.
    const double farthest =
        std::max({std::abs(origin.x), std::abs(origin.y), std::abs(grid->planeX(grid->width)),
                  std::abs(grid->planeY(grid->height))});
    grid->leaps = farthest * 0x1p-52 <= grid->cellSize * 0x1p-30 && grid->largest <= leapHighest &&
                  grid->cellSize >= 0x1p-20 && grid->cellSize <= 0x1p20 && grid->cells <= 0x7fffffff / 5;
    grid->tables = LargeArray<std::uint32_t>((grid->leaps ? 5 : 1) * grid->cells);
    std::fill_n(grid->tables.data(), grid->cells,
                std::bit_cast<std::uint32_t>(-std::numeric_limits<float>::infinity()));
    for (int j = 0; j < grid->height; ++j)
        for (int i = 0; i < grid->width; ++i)
            if (const float h = field.at(i, j); !std::isnan(h))
                grid->tables[grid->index(i, j)] = std::bit_cast<std::uint32_t>(h);
    if (grid->leaps) findOpenRectangles(*grid);
    grid->scale = leapScale(*grid);
    grid_ = std::move(grid);
}

GridTracer::GridTracer(const city::Heightfield& field, const city::Overhang& hanging) : GridTracer(field) {
    for (int j = 0; j < hanging.top.height() && !hanging_; ++j)
        for (int i = 0; i < hanging.top.width() && !hanging_; ++i)
            if (hanging.hangs(i, j)) hanging_ = std::make_shared<HangingTracer>(field, hanging);
}

TraceResult GridTracer::trace(const city::Ray& ray, float tMax) const {
    // A NaN limit reaches nothing; an infinite one reaches what a float can express.
    const float most = tMax > std::numeric_limits<float>::max() ? std::numeric_limits<float>::max() : tMax;
    return hanging_ ? hanging_->trace(ray, most) : leapWalk(*grid_, ray, most);
}

bool GridTracer::occluded(glm::vec3 from, glm::vec3 to, float slack) const {
    const glm::vec3 direction = to - from;
    const float length = glm::length(direction);
    if (!(length > slack)) return false;
    const float reach = slack > 0 ? 1 - slack / length : 1;
    const TraceResult result = trace({from, direction}, reach);
    return result.status == TraceStatus::hit && result.t < reach;
}

void GridTracer::traceFan(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy,
                          std::span<const float> dz, std::span<float> t) const {
    const std::size_t count = std::min({dx.size(), dy.size(), dz.size(), t.size()});
    const auto first = [count](auto span) { return span.first(count); };
    if (hanging_)
        hanging_->traceFan(origin, first(dx), first(dy), first(dz), first(t));
    else
        leapFan(*grid_, origin, first(dx), first(dy), first(dz), first(t));
}

}  // namespace reflection
