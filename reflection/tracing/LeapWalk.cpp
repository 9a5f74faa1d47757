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

TraceResult leapWalk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    if (!grid.leaps) return exactWalk(grid, ray, tMax);
    const int i0 = grid.cellX(ray.origin.x);
    const int j0 = grid.cellY(ray.origin.y);
    const float da = std::abs(ray.direction.x);
    const float db = std::abs(ray.direction.y);
    const float fastest = std::max(da, db);
    const float dz = ray.direction.z * static_cast<float>(grid.cellSize);
    const float oz = ray.origin.z;
    const bool ordinary = static_cast<unsigned>(i0) < static_cast<unsigned>(grid.width) &&
                          static_cast<unsigned>(j0) < static_cast<unsigned>(grid.height) &&
                          fastest >= leapSlowest && fastest <= leapFastest && std::abs(dz) <= leapHighest &&
                          std::abs(oz) <= leapHighest;
    if (!ordinary) return exactWalk(grid, ray, tMax);

    const bool west = ray.direction.x < 0;
    const bool south = ray.direction.y < 0;
    const double fu = (static_cast<double>(ray.origin.x) - grid.planeX(i0)) * grid.perCell;
    const double fv = (static_cast<double>(ray.origin.y) - grid.planeY(j0)) * grid.perCell;
    const float fa = static_cast<float>(west ? 1 - fu : fu);
    const float fb = static_cast<float>(south ? 1 - fv : fv);
    const bool crossesA = da >= negligibleSlope * fastest;
    const bool crossesB = db >= negligibleSlope * fastest;
    // A ray that never crosses borders of one axis must stay clear of them, or `never` would meet a distance
    // of 0.
    const float never = 0x1p100f;
    if ((!crossesA && std::min(fa, 1 - fa) <= 4 * leapError) ||
        (!crossesB && std::min(fb, 1 - fb) <= 4 * leapError))
        return exactWalk(grid, ray, tMax);
    const float inverseA = crossesA ? 1 / da : never;
    const float inverseB = crossesB ? 1 / db : never;
    const float inverseMax = std::max(crossesA ? inverseA : 0, crossesB ? inverseB : 0);
    const float lateral1 = leapError * fastest;
    const float lateral0 = lateral1 * inverseMax + 2 * leapError;
    const float vertical1 = leapError * std::abs(dz);
    const float vertical0 = vertical1 * inverseMax + leapError * (std::abs(oz) + grid.largest);
    const float inverseZ = 1 / dz;
    const bool sinks = dz < 0;
    const float tEnd = tMax * static_cast<float>(grid.perCell) * 1.00001f;

    const OpenRectangles& open = grid.open;
    const OpenRectangles::Entry* entries =
        open.entries.data() + ((west ? 1u : 0u) + (south ? 2u : 0u)) * grid.columns.size();
    const float* columns = grid.columns.data();
    const std::ptrdiff_t strideA = west ? -1 : 1;
    const std::ptrdiff_t strideB = south ? -static_cast<std::ptrdiff_t>(grid.width) : grid.width;
    const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(grid.index(i0, j0));
    const int endA = west ? i0 + 1 : grid.width - i0;
    const int endB = south ? j0 + 1 : grid.height - j0;
    const TraceResult miss{TraceStatus::miss, std::numeric_limits<float>::infinity(), glm::ivec2(-1)};

    int a = 0, b = 0;
    float t = 0;
    EntryFace face = EntryFace::start;
    bool justSank = false;  // to the level of a rectangle, inside cell (a, b)
    const auto hit = [&](EntryFace through) {
        const int i = west ? i0 - a : i0 + a;
        const int j = south ? j0 - b : j0 + b;
        const float exactT = entryParameter(grid, ray, through, i, j);
        return exactT <= tMax ? TraceResult{TraceStatus::hit, exactT, {i, j}} : miss;
    };

    for (;;) {
        const std::ptrdiff_t at = start + a * strideA + b * strideB;
        const OpenRectangles::Entry entry = entries[at];
        const float z = oz + t * dz;
        const float vertical = vertical0 + vertical1 * t;
        float level = open.levelHeight(entry >> 16);
        int columnsAhead = static_cast<int>(entry & 255);
        int rowsAhead = static_cast<int>((entry >> 8) & 255);
        const bool leap = z > level + 4 * vertical && columnsAhead != 0 && !justSank;
        if (!leap) {
            level = columns[at];
            if (!justSank) {
                if (z <= level - vertical) return hit(face);
                if (z <= level + vertical) return exactWalk(grid, ray, tMax);
            }
            columnsAhead = rowsAhead = 1;
        }
        justSank = false;
        const int borderA = a + columnsAhead;
        const int borderB = b + rowsAhead;
        const float tA = (static_cast<float>(borderA) - fa) * inverseA;
        const float tB = (static_cast<float>(borderB) - fb) * inverseB;
        const float tOut = std::min(tA, tB);
        const float verticalOut = vertical0 + vertical1 * tOut;
        const float zOut = oz + tOut * dz;
        if (sinks && zOut <= level + verticalOut) {
            if (!leap) {
                if (zOut <= level - verticalOut) return hit(EntryFace::top);
                return exactWalk(grid, ray, tMax);
            }
            // To a point certainly above the level, and no farther than the rectangle: the error grows on the
            // way there.
            t = (level + 3 * vertical - oz) * inverseZ;
            if (!(t < tOut)) return exactWalk(grid, ray, tMax);
            const float pa = fa + t * da;
            const float pb = fb + t * db;
            a = static_cast<int>(pa);
            b = static_cast<int>(pb);
            const float lateral = lateral0 + lateral1 * t;
            const float ra = pa - static_cast<float>(a);
            const float rb = pb - static_cast<float>(b);
            if (std::min(std::min(ra, 1 - ra), std::min(rb, 1 - rb)) <= lateral)
                return exactWalk(grid, ray, tMax);
            justSank = true;
            continue;
        }
        t = tOut;
        if (!(t <= tEnd)) return miss;
        const bool byA = tA < tB;
        const float across = byA ? fb + t * db : fa + t * da;
        const int cell = static_cast<int>(across);
        const float rest = across - static_cast<float>(cell);
        if (std::min(rest, 1 - rest) <= lateral0 + lateral1 * t) return exactWalk(grid, ray, tMax);
        a = byA ? borderA : cell;
        b = byA ? cell : borderB;
        face = byA ? EntryFace::x : EntryFace::y;
        if (a >= endA || b >= endB) return miss;
        if (!sinks && zOut - verticalOut > grid.top) return miss;
    }
}

}  // namespace reflection
