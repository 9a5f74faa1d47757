// The leaping walk of one ray (LeapWalk.h). Its time is what its instructions and their latencies take, not
// the branches or the memory, so x and y share vectors of two doubles. Compiled once for each instruction
// set; the best one present is chosen when a grid is made.
#include "reflection/tracing/LeapWalk.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

// Vectors without a fixed size cannot be captured by lambdas; processors with SVE have NEON too.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/tracing/LeapWalk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace reflection::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
/// Processors without vectors (x86 without SSSE3, before 2007) walk exactly, cell by cell.
TraceResult walk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    return carefulWalk(grid, ray, tMax);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

using Pair = hn::FixedTag<double, 2>;  ///< x and y
using Cells = hn::FixedTag<std::int32_t, 2>;
using Floats = hn::FixedTag<float, 2>;
using VP = hn::Vec<Pair>;
using MP = hn::Mask<Pair>;

/// Which coordinates are certainly within their cells. False for a NaN.
HWY_INLINE MP within(VP place, VP cell) {
    const Pair p;
    return hn::Lt(hn::Abs(hn::Sub(hn::Sub(place, cell), hn::Set(p, 0.5))), hn::Set(p, 0.5 - leapLateral));
}

HWY_INLINE glm::ivec2 cellAt(VP cell) {
    const auto both = hn::DemoteTo(Cells(), cell);
    return {hn::GetLane(both), hn::ExtractLane(both, 1)};
}

/// TracedGrid::index of a cell within the grid.
HWY_INLINE std::size_t indexOf(const TracedGrid& grid, VP cell) {
    const glm::ivec2 at = cellAt(cell);
    return static_cast<std::size_t>(static_cast<std::uint32_t>(at.y) >> 2) * grid.tileRow +
           static_cast<std::uint32_t>(4 * at.x + (at.y & 3));
}

TraceResult walk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    const Pair p;
    const LeapScale& scale = grid.scale;
    const VP zero = hn::Zero(p);
    const VP origin = hn::PromoteTo(p, hn::LoadU(Floats(), &ray.origin.x));
    const VP direction = hn::Add(hn::PromoteTo(p, hn::LoadU(Floats(), &ray.direction.x)), zero);  // no -0
    const double oz = static_cast<double>(ray.origin.z);
    const double dz = static_cast<double>(ray.direction.z);
    const VP corner = hn::LoadU(p, &grid.origin.x);
    const VP size = hn::LoadU(p, &scale.size.x);
    // In cells and levels; t is the ray's own parameter.
    const VP start = hn::Mul(hn::Sub(origin, corner), hn::Set(p, grid.perCell));
    const VP speed = hn::Mul(direction, hn::Set(p, grid.perCell));
    const VP inverse = hn::Div(hn::Set(p, 1.0), speed);
    const double startLevel = (oz - static_cast<double>(grid.open.base)) * scale.perLevel;
    const double rise = dz * scale.perLevel + 0.0;  // no -0

    const VP speeds = hn::Abs(speed);
    const VP others = hn::Reverse(p, speeds);
    const double sum = hn::GetLane(hn::Add(speeds, others));
    const double slower = hn::GetLane(hn::Min(speeds, others));
    // One of the comparisons fails for every NaN.
    const bool measured = ((sum + std::abs(rise)) * scale.steepest < (slower > 0 ? slower : sum)) &
                          (std::abs(startLevel) < leapFarthest);
    VP cell = hn::Floor(start);
    const MP inGrid = hn::And(hn::Ge(start, zero), hn::Lt(start, size));
    if (!(measured & hn::AllTrue(p, hn::And(within(start, cell), inGrid)))) [[unlikely]] {
        const int i = grid.cellX(static_cast<double>(ray.origin.x));
        const int j = grid.cellY(static_cast<double>(ray.origin.y));
        if (!measured | (i < 0) | (i >= grid.width) | (j < 0) | (j >= grid.height))
            return carefulWalk(grid, ray, tMax);
        // So near to a border that only the rule itself can tell the cell.
        alignas(16) const double known[2] = {static_cast<double>(i), static_cast<double>(j)};
        cell = hn::Load(p, known);
        // A start that rounding has put on its cell's far border, along which the ray runs: 0 / 0.
        const MP crossesOrBefore =
            hn::Or(hn::Gt(speeds, zero), hn::Lt(start, hn::Add(cell, hn::Set(p, 1.0))));
        if (!hn::AllTrue(p, crossesOrBefore)) return carefulWalk(grid, ray, tMax);
    }
    const double inverseRise = 1 / rise;
    // Nothing is hit after tLast. The slack is for the rounding of a hit's t to float, and for that of the
    // walk's own t: b / s is less than 2^-19 / (s + s' + |r|), see LeapWalk.h.
    const VP inverses = hn::Abs(inverse);
    const double late = 0x1p-19 * hn::GetLane(hn::Min(inverses, hn::Reverse(p, inverses)));
    const double limit = static_cast<double>(tMax) * (1 + 1e-6) + (late + 1e-40);
    const double tLast = rise < 0 ? limit : std::min((scale.top - startLevel) * inverseRise, limit);

    const MP backwards = hn::Lt(direction, zero);
    std::uint8_t quadrant[8];
    hn::StoreMaskBits(p, backwards, quadrant);
    const std::uint32_t* tables = grid.tables.data();
    const OpenRectangles::Entry* entries = tables + grid.entriesOf(quadrant[0]);
    const VP nearSide = hn::IfThenElseZero(backwards, hn::Set(p, 1.0));  // of a cell: where the ray comes in
    // From an entry's fields of 6 bits to cells, with the ray's signs.
    alignas(8) static constexpr std::int32_t fields[2] = {63, 63 << 6};
    alignas(16) static constexpr double units[2] = {1, 1.0 / 64};
    const VP unit = hn::CopySign(hn::Load(p, units), direction);
    const VP one = hn::CopySign(hn::Set(p, 1.0), direction);
    const TraceResult miss{TraceStatus::miss, std::numeric_limits<float>::infinity(), glm::ivec2(-1)};

    bool atStart = true;
    MP crossed = backwards;  // by which axis the cell was entered, unless atStart
    double level = startLevel;
    VP exit, exitTimes, otherTimes;
    double t = 0;
    const auto hit = [&](double exactT) HWY_ATTR {  // entryParameter's double
        const float rounded = static_cast<float>(exactT + 0.0);
        return rounded <= tMax ? TraceResult{TraceStatus::hit, rounded, cellAt(cell)} : miss;
    };
    const auto hitTop = [&](double column) HWY_ATTR { return hit((column - oz) / dz); };
    const auto hitWall = [&]() HWY_ATTR {
        if (atStart) return hit(0);
        const VP plane = hn::Add(corner, hn::Mul(hn::Add(cell, nearSide), hn::Set(p, grid.cellSize)));
        const VP times = hn::Div(hn::Sub(plane, origin), direction);
        return hit(hn::GetLane(hn::IfThenElse(crossed, times, hn::Reverse(p, times))));
    };
    /// To the border so many cells ahead.
    const auto advance = [&](VP cells) HWY_ATTR {
        exit = hn::Add(hn::Add(cell, nearSide), cells);
        exitTimes = hn::Mul(hn::Sub(exit, start), inverse);
        otherTimes = hn::Reverse(p, exitTimes);
        t = hn::GetLane(hn::Min(exitTimes, otherTimes));
        level = startLevel + t * rise;
    };

    for (;;) {
        const std::size_t at = indexOf(grid, cell);
        const OpenRectangles::Entry entry = entries[at];
        const double own = static_cast<double>(static_cast<int>(entry >> 16));
        const double floor = own + scale.lifts[(entry >> 12) & 15];
        const bool known = (entry & 63) != 0;
        if (level > floor + scale.clearance && known) [[likely]] {
            const auto extent =
                hn::And(hn::Set(Cells(), static_cast<std::int32_t>(entry)), hn::Load(Cells(), fields));
            advance(hn::Mul(hn::PromoteTo(p, extent), unit));
            if (level <= floor + scale.slack) {
                // To a point certainly above the level, and no farther than the rectangle. Most often the
                // cell's column is about as high, and the ray sinks through its top before the cell ends.
                const double tLanding = (floor + scale.landing - startLevel) * inverseRise;
                const VP place = hn::MulAdd(hn::Set(p, tLanding), speed, start);
                cell = hn::Floor(place);
                if (!hn::AllTrue(p, within(place, cell))) [[unlikely]]
                    return carefulWalk(grid, ray, tMax);
                const double column = static_cast<double>(grid.column(indexOf(grid, cell)));
                const double tTop = (column - oz) / dz;
                if (hn::AllTrue(p, within(hn::MulAdd(hn::Set(p, tTop), speed, start), cell)))
                    return hit(tTop);
                advance(one);
                if (level <= (column - static_cast<double>(grid.open.base)) * scale.perLevel + scale.slack)
                    return carefulWalk(grid, ray, tMax);
            }
        } else {
            // The column is less than a step below its level: a wall is known without a look at it.
            if ((level + scale.wall <= own) & known) return hitWall();
            const double column = static_cast<double>(grid.column(at));
            const double columnLevel = (column - static_cast<double>(grid.open.base)) * scale.perLevel;
            if (level <= columnLevel + scale.slack) {
                if (level <= columnLevel - scale.slack) return hitWall();
                return carefulWalk(grid, ray, tMax);
            }
            advance(one);
            if (level <= columnLevel + scale.slack) {
                if (level <= columnLevel - scale.slack) return hitTop(column);
                return carefulWalk(grid, ray, tMax);
            }
        }
        atStart = false;
        crossed = hn::Lt(exitTimes, otherTimes);
        // Across the border that is being crossed the cell is known; only the other coordinate has to be
        // certain.
        const VP place = hn::MulAdd(hn::Set(p, t), speed, start);
        const VP under = hn::Floor(place);
        if (!(t <= tLast)) return miss;
        cell = hn::IfThenElse(crossed, hn::Sub(exit, nearSide), under);
        const MP certain = hn::Or(within(place, under), crossed);
        if (!hn::AllTrue(p, hn::And(certain, hn::And(hn::Ge(cell, zero), hn::Lt(cell, size))))) [[unlikely]]
            return hn::AllTrue(p, certain) ? miss : carefulWalk(grid, ray, tMax);
    }
}

#endif

decltype(LeapScale::walk) chooseWalk() {
    return &walk;
}

}  // namespace reflection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(chooseWalk);

LeapScale leapScale(const TracedGrid& grid) {
    LeapScale scale;
    scale.walk = grid.leaps ? HWY_DYNAMIC_DISPATCH(chooseWalk)() : &carefulWalk;
    if (!grid.leaps) return scale;
    scale.size = {grid.width, grid.height};
    const double farthest = std::max({std::abs(grid.origin.x), std::abs(grid.origin.y),
                                      std::abs(grid.planeX(grid.width)), std::abs(grid.planeY(grid.height))});
    scale.steepest = (farthest * grid.perCell + grid.width + grid.height) * 0x1p-50 * 0x1p19;
    scale.perLevel = 1 / static_cast<double>(grid.open.step);
    scale.slack = static_cast<double>(grid.largest) * 0x1p-22 * scale.perLevel + 0x1p-8;
    scale.landing = 3 * scale.slack;
    scale.clearance = 4 * scale.slack;
    scale.wall = 1 + scale.slack;
    scale.top =
        (static_cast<double>(grid.top) - static_cast<double>(grid.open.base)) * scale.perLevel + scale.slack;
    for (std::size_t k = 0; k < scale.lifts.size(); ++k)
        scale.lifts[k] = static_cast<double>(k * k) * static_cast<double>(grid.open.lift);
    return scale;
}

TraceResult carefulWalk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    const glm::vec3& o = ray.origin;
    const glm::vec3& d = ray.direction;
    const bool valid = std::isfinite(o.x) && std::isfinite(o.y) && std::isfinite(o.z) && std::isfinite(d.x) &&
                       std::isfinite(d.y) && std::isfinite(d.z) && d != glm::vec3(0);
    if (!valid) return {TraceStatus::invalid, std::numeric_limits<float>::quiet_NaN(), glm::ivec2(-1)};
    return exactWalk(grid, ray, tMax);
}

}  // namespace reflection
#endif
