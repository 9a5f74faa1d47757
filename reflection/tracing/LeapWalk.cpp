#include "reflection/tracing/LeapWalk.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reflection {

bool validRay(const city::Ray& ray) {
    const glm::vec3& o = ray.origin;
    const glm::vec3& d = ray.direction;
    return std::isfinite(o.x) && std::isfinite(o.y) && std::isfinite(o.z) && std::isfinite(d.x) &&
           std::isfinite(d.y) && std::isfinite(d.z) && d != glm::vec3(0);
}

float exactAnswer(const TracedGrid& grid, const city::Ray& ray) {
    if (!validRay(ray)) return std::numeric_limits<float>::quiet_NaN();
    return exactWalk(grid, ray, std::numeric_limits<float>::max()).t;
}

namespace {

/// A coordinate's cell and the part behind it, in cells.
struct Place {
    int cell;
    double rest;
};

/// Outside the grid, and for a NaN, the cell is -1.
inline Place place(double value, double first, double perCell, int cells) {
    const double u = (value - first) * perCell;
    if (!(u >= 0 && u < cells)) return {-1, 0};
    const int cell = static_cast<int>(u);
    return {cell, u - cell};
}

/// Is a place so near its cell's border that only the rule itself (TracedGrid::cellX) can tell the cell?
inline bool borderline(double rest) {
    return std::abs(rest - 0.5) > 0.5 - 0x1p-28;
}

/// Distance to the nearest border, in cells.
inline float room(float value, int cell) {
    const float rest = value - static_cast<float>(cell);
    return std::min(rest, 1 - rest);
}

/// Rays that the leaping walk's arithmetic is not made for.
[[gnu::noinline]] TraceResult oddRay(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    if (!validRay(ray))
        return {TraceStatus::invalid, std::numeric_limits<float>::quiet_NaN(), glm::ivec2(-1)};
    return exactWalk(grid, ray, tMax);
}

}  // namespace

TraceResult leapWalk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    const glm::vec3 origin = ray.origin;
    const glm::vec3 direction = ray.direction;
    Place x = place(origin.x, grid.origin.x, grid.perCell, grid.width);
    Place y = place(origin.y, grid.origin.y, grid.perCell, grid.height);
    const float da = std::abs(direction.x);
    const float db = std::abs(direction.y);
    const float fastest = std::max(da, db);
    const float dz = direction.z * static_cast<float>(grid.cellSize);
    const float oz = origin.z;
    // One of the comparisons fails for every NaN.
    const bool ordinary = ((x.cell | y.cell) >= 0) & (fastest >= leapSlowest) & (da + db <= leapFastest) &
                          (std::min(da, db) >= negligibleSlope * fastest) & (std::abs(dz) <= leapHighest) &
                          (std::abs(oz) <= leapHighest) & grid.leaps;
    if (!ordinary) [[unlikely]]
        return oddRay(grid, ray, tMax);
    if (borderline(x.rest) || borderline(y.rest)) [[unlikely]] {
        x.cell = grid.cellX(origin.x);
        y.cell = grid.cellY(origin.y);
        if (x.cell < 0 || x.cell >= grid.width || y.cell < 0 || y.cell >= grid.height)
            return exactWalk(grid, ray, tMax);
        x.rest = (static_cast<double>(origin.x) - grid.planeX(x.cell)) * grid.perCell;
        y.rest = (static_cast<double>(origin.y) - grid.planeY(y.cell)) * grid.perCell;
    }

    const int west = direction.x < 0;
    const int south = direction.y < 0;
    const int signA = 1 - 2 * west;
    const int signB = 1 - 2 * south;
    const float fa = static_cast<float>(west + signA * x.rest);
    const float fb = static_cast<float>(south + signB * y.rest);
    const float inverseA = 1 / da;
    const float inverseB = 1 / db;
    const float lateral1 = leapError * fastest;
    const float lateral0 = lateral1 * std::max(inverseA, inverseB) + 2 * leapError;
    const float vertical1 = leapError * std::abs(dz);
    const float vertical0 =
        vertical1 * std::max(inverseA, inverseB) + leapError * (std::abs(oz) + grid.largest);
    const bool sinks = dz < 0;
    const float tEnd = tMax * static_cast<float>(grid.perCell) * 1.00001f;

    const OpenRectangles& open = grid.open;
    const OpenRectangles::Entry* entries =
        open.entries.data() + static_cast<std::size_t>(west + 2 * south) * grid.columns.size();
    const float* columns = grid.columns.data();
    const auto indexOf = [&](int passedA, int passedB) {
        return grid.index(x.cell + signA * passedA, y.cell + signB * passedB);
    };
    const int endA = west ? x.cell + 1 : grid.width - x.cell;
    const int endB = south ? y.cell + 1 : grid.height - y.cell;
    const TraceResult miss{TraceStatus::miss, std::numeric_limits<float>::infinity(), glm::ivec2(-1)};

    int a = 0, b = 0;
    float t = 0;
    EntryFace face = EntryFace::start;
    const auto hit = [&](EntryFace through) {
        const int i = x.cell + signA * a;
        const int j = y.cell + signB * b;
        const float exactT = entryParameter(grid, ray, through, i, j);
        return exactT <= tMax ? TraceResult{TraceStatus::hit, exactT, {i, j}} : miss;
    };

    for (;;) {
        const std::size_t at = indexOf(a, b);
        const OpenRectangles::Entry entry = entries[at];
        const float z = oz + t * dz;
        const float vertical = vertical0 + vertical1 * t;
        const int own = static_cast<int>(entry >> 16);
        const int width = static_cast<int>(entry & 63);
        const float ownHeight = open.levelHeight(own);
        const int lift = static_cast<int>((entry >> 12) & 15);
        const float level = open.levelHeight(own + lift * lift * open.lift);
        const bool leap = (z > level + 4 * vertical) & (width != 0);
        float floor = level;
        if (!leap) {
            // The column is less than a step below its level: a wall is known without a look at it.
            if ((z <= ownHeight - open.step - vertical) & (width != 0)) return hit(face);
            floor = columns[at];
            if (z <= floor + vertical) {
                if (z <= floor - vertical) return hit(face);
                return exactWalk(grid, ray, tMax);
            }
        }
        int borderA = a + (leap ? width : 1);
        int borderB = b + (leap ? static_cast<int>((entry >> 6) & 63) : 1);
        float tA = (static_cast<float>(borderA) - fa) * inverseA;
        float tB = (static_cast<float>(borderB) - fb) * inverseB;
        float tOut = std::min(tA, tB);
        float zOut = oz + tOut * dz;
        float verticalOut = vertical0 + vertical1 * tOut;
        if (sinks && zOut <= floor + verticalOut) {
            float reached = floor;
            if (leap) {
                // To a point certainly above the level, and no farther than the rectangle: the error grows on
                // the way.
                t = (level + 3 * vertical - oz) / dz;
                const float pa = fa + t * da;
                const float pb = fb + t * db;
                a = static_cast<int>(pa);
                b = static_cast<int>(pb);
                const float clear = std::min(room(pa, a), room(pb, b)) - (lateral0 + lateral1 * t);
                if (!(clear > 0 && t < tOut)) [[unlikely]]
                    return exactWalk(grid, ray, tMax);
                // Most often the cell's column is about as high, and the ray sinks through its top well
                // before the cell ends: it still has at most `gap` to fall, and `clear` to go.
                reached = columns[indexOf(a, b)];
                const float gap = level - reached + 4 * vertical;
                if (gap * fastest < clear * -dz) return hit(EntryFace::top);
                borderA = a + 1;
                borderB = b + 1;
                tA = (static_cast<float>(borderA) - fa) * inverseA;
                tB = (static_cast<float>(borderB) - fb) * inverseB;
                tOut = std::min(tA, tB);
                zOut = oz + tOut * dz;
                verticalOut = vertical0 + vertical1 * tOut;
            }
            if (zOut <= reached + verticalOut) {
                if (zOut <= reached - verticalOut) return hit(EntryFace::top);
                return exactWalk(grid, ray, tMax);
            }
        }
        t = tOut;
        const bool byA = tA < tB;
        const float pa = fa + t * da;
        const float pb = fb + t * db;
        const int cellA = static_cast<int>(pa);
        const int cellB = static_cast<int>(pb);
        // Across the border that is being crossed the cell is known; only the other coordinate has to be
        // certain.
        const float lateral = lateral0 + lateral1 * t;
        if (!((room(pa, cellA) > lateral) | byA) | !((room(pb, cellB) > lateral) | !byA)) [[unlikely]]
            return exactWalk(grid, ray, tMax);
        a = byA ? borderA : cellA;
        b = byA ? cellB : borderB;
        face = byA ? EntryFace::x : EntryFace::y;
        if ((a >= endA) | (b >= endB) | !(t <= tEnd)) return miss;
        if (!sinks & (zOut - verticalOut > grid.top)) return miss;
    }
}

}  // namespace reflection
