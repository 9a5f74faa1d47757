#include "reflection/tracing/ExactWalk.h"

#include <cmath>
#include <limits>

#include "reflection/tracing/ExactSign.h"

namespace reflection {

namespace {

/// One horizontal axis of the walk.
struct Axis {
    double origin = 0;  ///< of the grid
    double cellSize = 1;
    int cells = 0;
    double start = 0;      ///< of the ray
    double direction = 0;  ///< of the ray

    double plane(int k) const { return origin + static_cast<double>(k) * cellSize; }
    double sign() const { return direction > 0 ? 1.0 : -1.0; }
    int step() const { return direction > 0 ? 1 : -1; }
    /// The border through which the ray leaves cell k.
    int exitPlane(int k) const { return direction > 0 ? k + 1 : k; }
    /// The border through which the ray came into cell k.
    int entryPlane(int k) const { return direction > 0 ? k : k + 1; }

    int startCell = 0;  ///< under the half-open rule: -1 below the grid, `cells` above it
};

/// Sign of (parameter at a's border ka) - (parameter at b's border kb); both directions are non-zero.
/// (A - oa) / da - (B - ob) / db, multiplied by |da db|.
int compareParameters(const Axis& a, int ka, const Axis& b, int kb) {
    return signOfDifference(a.plane(ka), a.start, a.sign() * std::abs(b.direction), b.plane(kb), b.start,
                            b.sign() * std::abs(a.direction));
}

/// The cell of `axis` in which the ray is when it crosses border k of `other`. Steps of `axis` at the very
/// same parameter have been made already if `ownStepsFirst`. -1 or `cells` when that is outside the grid.
int cellAtCrossing(const Axis& axis, const Axis& other, int k, bool ownStepsFirst) {
    const int from = axis.startCell;
    if (axis.direction == 0) return from;
    const auto passed = [&](int border) {
        const int order = compareParameters(axis, border, other, k);
        return order < 0 || (order == 0 && ownStepsFirst);
    };
    if (axis.direction > 0) {
        // Borders from+1 ... cells lie ahead (from >= -1): find how many were passed.
        int low = from, high = axis.cells;  // border `low` is passed (or is where the ray starts)
        while (low < high) {
            const int middle = low + (high - low + 1) / 2;
            if (passed(middle))
                low = middle;
            else
                high = middle - 1;
        }
        return low;
    }
    int low = -1, high = from;  // in cell k: border k+1 passed, border k not
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (passed(middle + 1))
            high = middle;
        else
            low = middle + 1;
    }
    return high;
}

/// Is the ray at or below height h when it crosses border k of `axis`?  oz + dz (X - o) / d <= h, multiplied
/// by |d|.
bool atOrBelow(const city::Ray& ray, const Axis& axis, int k, float h) {
    return signOfDifference(axis.plane(k), axis.start, axis.sign() * static_cast<double>(ray.direction.z), h,
                            ray.origin.z, std::abs(axis.direction)) <= 0;
}

TraceResult entered(const TracedGrid& grid, const city::Ray& ray, EntryFace face, int i, int j, float tMax) {
    const float t = entryParameter(grid, ray, face, i, j);
    if (!(t <= tMax)) return {TraceStatus::miss, std::numeric_limits<float>::infinity(), glm::ivec2(-1)};
    return {TraceStatus::hit, t, {i, j}};
}

}  // namespace

float entryParameter(const TracedGrid& grid, const city::Ray& ray, EntryFace face, int i, int j) {
    double t = 0;
    switch (face) {
        case EntryFace::start:
            return 0;
        case EntryFace::x:
            t = (grid.planeX(ray.direction.x > 0 ? i : i + 1) - static_cast<double>(ray.origin.x)) /
                static_cast<double>(ray.direction.x);
            break;
        case EntryFace::y:
            t = (grid.planeY(ray.direction.y > 0 ? j : j + 1) - static_cast<double>(ray.origin.y)) /
                static_cast<double>(ray.direction.y);
            break;
        case EntryFace::top:
            t = (static_cast<double>(grid.column(i, j)) - static_cast<double>(ray.origin.z)) /
                static_cast<double>(ray.direction.z);
            break;
    }
    return static_cast<float>(t + 0.0);  // + 0.0: a start on the border gives 0, never -0
}

TraceResult exactWalk(const TracedGrid& grid, const city::Ray& ray, float tMax) {
    const TraceResult miss{TraceStatus::miss, std::numeric_limits<float>::infinity(), glm::ivec2(-1)};
    const Axis x{grid.origin.x, grid.cellSize,   grid.width,
                 ray.origin.x,  ray.direction.x, grid.cellX(ray.origin.x)};
    const Axis y{grid.origin.y, grid.cellSize,   grid.height,
                 ray.origin.y,  ray.direction.y, grid.cellY(ray.origin.y)};
    int i = x.startCell;
    int j = y.startCell;
    EntryFace face = EntryFace::start;

    const auto outside = [](const Axis& axis, int k) { return k < 0 || k >= axis.cells; };
    const auto headsAway = [](const Axis& axis, int k) {
        return (k < 0 && !(axis.direction > 0)) || (k >= axis.cells && !(axis.direction < 0));
    };
    if (headsAway(x, i) || headsAway(y, j)) return miss;
    if (outside(x, i) || outside(y, j)) {
        // Cross the empty plain around the grid in one stride: the later of the two crossings into its ranges
        // is the entry.
        const int borderX = x.direction > 0 ? 0 : x.cells;
        const int borderY = y.direction > 0 ? 0 : y.cells;
        const bool entersByX =
            outside(x, i) && (!outside(y, j) || compareParameters(x, borderX, y, borderY) > 0);
        if (entersByX) {
            // Equal parameters: x steps first, so the y steps of this instant are still to come.
            j = cellAtCrossing(y, x, borderX, false);
            i = x.direction > 0 ? 0 : x.cells - 1;
            face = EntryFace::x;
        } else {
            i = cellAtCrossing(x, y, borderY, true);
            j = y.direction > 0 ? 0 : y.cells - 1;
            face = EntryFace::y;
        }
        if (outside(x, i) || outside(y, j)) return miss;
    }

    for (;;) {
        const float h = grid.column(i, j);
        if (h > -std::numeric_limits<float>::infinity()) {
            const bool inside = h == std::numeric_limits<float>::infinity() ? true
                                : face == EntryFace::start                  ? ray.origin.z <= h
                                : face == EntryFace::x ? atOrBelow(ray, x, x.entryPlane(i), h)
                                                       : atOrBelow(ray, y, y.entryPlane(j), h);
            if (inside) return entered(grid, ray, face, i, j, tMax);
        }
        const bool leavesByX =
            x.direction != 0 &&
            (y.direction == 0 || compareParameters(x, x.exitPlane(i), y, y.exitPlane(j)) <= 0);
        const bool leavesByY = !leavesByX && y.direction != 0;
        if (ray.direction.z < 0 && h > -std::numeric_limits<float>::infinity()) {
            const bool sinksIn = leavesByX   ? atOrBelow(ray, x, x.exitPlane(i), h)
                                 : leavesByY ? atOrBelow(ray, y, y.exitPlane(j), h)
                                             : true;
            if (sinksIn) return entered(grid, ray, EntryFace::top, i, j, tMax);
        }
        if (!leavesByX && !leavesByY) return miss;  // straight up or down
        const Axis& axis = leavesByX ? x : y;
        const int border = axis.exitPlane(leavesByX ? i : j);
        // Nothing more to find above the highest column or beyond tMax. Three roundings: a slack of 2^-48 is
        // plenty. To float a parameter is rounded by 2^-24 of itself, or by 2^-150 where it is subnormal.
        const double t = (axis.plane(border) - axis.start) / axis.direction;
        const double climb = static_cast<double>(ray.direction.z) * t;
        const double z = static_cast<double>(ray.origin.z) + climb;
        if (ray.direction.z >= 0 && z - 0x1p-48 * (std::abs(static_cast<double>(ray.origin.z)) + climb) >
                                        static_cast<double>(grid.top))
            return miss;
        if (t * (1 - 1e-6) - 0x1p-149 > static_cast<double>(tMax)) return miss;
        if (leavesByX) {
            i += x.step();
            face = EntryFace::x;
            if (outside(x, i)) return miss;
        } else {
            j += y.step();
            face = EntryFace::y;
            if (outside(y, j)) return miss;
        }
    }
}

}  // namespace reflection
