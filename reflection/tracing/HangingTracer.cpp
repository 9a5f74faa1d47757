#include "reflection/tracing/HangingTracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace reflection {

namespace {

/// Of a cell: the shortest way through one from whose middle a walk may begin anew. The middle is rounded by
/// less than `startRounding` of it, or walks do not begin anew.
constexpr double shortestWay = 0x1p-6;
constexpr double startRounding = 0x1p-9;
/// Of a float's last place, relative.
constexpr double floatRounding = 0x1p-23;

bool sameCells(const city::Heightfield& a, const city::Heightfield& b) {
    return a.width() == b.width() && a.height() == b.height() && a.cellSize() == b.cellSize() &&
           a.origin() == b.origin();
}

const city::Heightfield& withCellsOf(const city::Overhang& hanging, const city::Heightfield& solid) {
    if (!sameCells(solid, hanging.underside) || !sameCells(solid, hanging.top))
        throw std::invalid_argument(
            "columns that hang must have the cells of the heightfield that they hang above");
    return solid;
}

bool hangsAbove(const city::Heightfield& solid, const city::Overhang& hanging, int i, int j) {
    return hanging.hangs(i, j) && !(hanging.top.at(i, j) <= solid.at(i, j));
}

city::Heightfield filled(const city::Heightfield& solid, const city::Overhang& hanging) {
    city::Heightfield field = solid;
    for (int j = 0; j < solid.height(); ++j)
        for (int i = 0; i < solid.width(); ++i)
            if (hangsAbove(solid, hanging, i, j)) field.set(i, j, hanging.top.at(i, j));
    return field;
}

}  // namespace

HangingTracer::HangingTracer(const city::Heightfield& solid, const city::Overhang& hanging)
    : width_(solid.width()),
      height_(solid.height()),
      cellSize_(static_cast<double>(solid.cellSize())),
      origin_(solid.origin()),
      solid_(withCellsOf(hanging, solid)),
      filled_(filled(solid, hanging)),
      columns_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      marks_(columns_.size(), 0) {
    for (int j = 0; j < height_; ++j)
        for (int i = 0; i < width_; ++i) {
            if (!hangsAbove(solid, hanging, i, j)) continue;
            columns_[index({i, j})] = {hanging.underside.at(i, j), hanging.top.at(i, j)};
            marks_[index({i, j})] |= hangs;
            for (int v = std::max(j - 1, 0); v <= std::min(j + 1, height_ - 1); ++v)
                for (int u = std::max(i - 1, 0); u <= std::min(i + 1, width_ - 1); ++u)
                    marks_[index({u, v})] |= near;
        }
}

TraceResult HangingTracer::trace(const city::Ray& ray, float tMax) const {
    const TraceResult entered = filled_.trace(ray, tMax);
    if (entered.status != TraceStatus::hit || (marks_[index(entered.cell)] & hangs) == 0) return entered;
    if (ray.origin.z + entered.t * ray.direction.z >= columns_[index(entered.cell)].underside) return entered;
    return below(ray, tMax, entered);
}

TraceResult HangingTracer::below(const city::Ray& ray, float tMax, const TraceResult& entered) const {
    const TraceResult solid = solid_.trace(ray, tMax);
    const float limit = solid.status == TraceStatus::hit ? solid.t : tMax;
    const auto within = [limit](double t) { return static_cast<float>(t) <= limit; };
    const glm::dvec3 o(ray.origin), d(ray.direction);
    const double fastest = std::max(std::abs(d.x), std::abs(d.y));
    const auto heightAt = [&](double t) { return o.z + t * d.z; };
    // Where the ray leaves a cell along an axis.
    const auto leaves = [&](int axis, int cell) {
        return d[axis] == 0
                   ? std::numeric_limits<double>::infinity()
                   : (origin_[axis] + (cell + (d[axis] > 0 ? 1 : 0)) * cellSize_ - o[axis]) / d[axis];
    };
    constexpr double never = std::numeric_limits<double>::infinity();
    glm::ivec2 cell = entered.cell;
    double t = static_cast<double>(entered.t);
    bool grazes = false;
    while (within(t) && inside(cell)) {
        const double x = leaves(0, cell.x), y = leaves(1, cell.y), end = std::max(std::min(x, y), t);
        if ((marks_[index(cell)] & hangs) != 0) {
            const Column& column = columns_[index(cell)];
            const double low = static_cast<double>(column.underside), high = static_cast<double>(column.top);
            const double first = heightAt(t), last = heightAt(end);
            double enters = t;
            if (first < low)
                enters = last >= low ? std::max((low - o.z) / d.z, t) : never;
            else if (first > high)
                enters = last <= high ? std::max((high - o.z) / d.z, t) : never;
            if (within(enters)) return {TraceStatus::hit, static_cast<float>(enters), cell};
        } else if (!grazes && (end - t) * fastest > shortestWay * cellSize_) {
            const double middle = 0.5 * (t + end);
            const glm::dvec3 from = o + middle * d;
            const double rounding = floatRounding * std::max(std::abs(from.x), std::abs(from.y));
            if (within(middle) && rounding < startRounding * cellSize_) {
                const TraceResult next = filled_.trace({glm::vec3(from), ray.direction}, limit);
                if (next.status != TraceStatus::hit) return solid;
                cell = next.cell;
                t = middle + static_cast<double>(next.t);
                // The start was rounded: a ray that grazes a column's top may seem to meet it.
                grazes = (marks_[index(cell)] & hangs) == 0;
                if (grazes && cell == solid.cell) return solid;
                continue;
            }
        }
        // Through a corner in x first, as GridTracer does.
        if (x <= y)
            cell.x += d.x > 0 ? 1 : -1;
        else
            cell.y += d.y > 0 ? 1 : -1;
        t = end;
        grazes = false;
    }
    return solid;
}

void HangingTracer::traceFan(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy,
                             std::span<const float> dz, std::span<float> t) const {
    filled_.traceFan(origin, dx, dy, dz, t);
    const glm::dvec2 from = (glm::dvec2(origin) - origin_) / cellSize_;
    for (std::size_t k = 0; k < t.size(); ++k) {
        if (!std::isfinite(t[k])) continue;
        const glm::dvec2 at = from + static_cast<double>(t[k]) / cellSize_ * glm::dvec2(dx[k], dy[k]);
        const glm::ivec2 cell(glm::clamp(glm::floor(at), glm::dvec2(0), glm::dvec2(width_ - 1, height_ - 1)));
        // Where rounding may be off by a cell, the walk that knows its cell says.
        const bool sure = floatRounding * std::max(std::abs(at.x - from.x), std::abs(at.y - from.y)) < 1;
        if (sure && (marks_[index(cell)] & near) == 0) continue;
        const TraceResult met = trace({origin, {dx[k], dy[k], dz[k]}}, std::numeric_limits<float>::max());
        t[k] = met.status == TraceStatus::hit ? met.t : std::numeric_limits<float>::infinity();
    }
}

}  // namespace reflection
