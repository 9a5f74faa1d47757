#include "reflection/tracing/HangingTracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace reflection {

namespace {

/// Turns after which a ray that skims along crowns counts as having met one.
constexpr int mostTurns = 32;
constexpr float farAbove = 64;      ///< metres above all crowns
constexpr float leastGain = 1e-4f;  ///< cells of a metre: coordinates of 1 km are rounded by half of it

city::Heightfield only(const city::Overhang& hanging, const city::Heightfield& of, float sign) {
    city::Heightfield field(of.width(), of.height(), of.cellSize(), of.origin());
    // Nothing hangs there: columns far beyond all others instead of none, so that heights are told apart in
    // steps that the leaping walks can use. They have no top, so nothing counts as met in them.
    if (sign < 0) {
        float highest = 0;
        for (int j = 0; j < of.height(); ++j)
            for (int i = 0; i < of.width(); ++i)
                if (hanging.hangs(i, j)) highest = std::max(highest, hanging.top.at(i, j));
        for (float& z : field.cells()) z = -(highest + farAbove);
    }
    for (int j = 0; j < of.height(); ++j)
        for (int i = 0; i < of.width(); ++i)
            if (hanging.hangs(i, j)) field.set(i, j, sign * of.at(i, j));
    return field;
}

city::Ray upsideDown(const city::Ray& ray) {
    return {{ray.origin.x, ray.origin.y, -ray.origin.z},
            {ray.direction.x, ray.direction.y, -ray.direction.z}};
}

}  // namespace

HangingTracer::HangingTracer(const city::Overhang& hanging)
    : hanging_(hanging),
      undersides_(only(hanging, hanging.underside, -1)),
      tops_(only(hanging, hanging.top, 1)) {}

TraceResult HangingTracer::trace(const city::Ray& ray, float tMax) const {
    TraceResult none;
    none.t = std::numeric_limits<float>::infinity();
    TraceResult entered = undersides_.trace(upsideDown(ray), tMax);
    if (entered.status == TraceStatus::invalid) return entered;
    // A place computed on a border may lie before it: a turn that gains less than this share of a cell is
    // moved on by as much, so that no two columns hand a ray to and fro.
    const float across = std::max(std::abs(ray.direction.x), std::abs(ray.direction.y));
    const float least = across > 0 ? leastGain * hanging_.top.cellSize() / across : 0;
    float t = 0;
    for (int turn = 0; turn < mostTurns; ++turn) {
        if (entered.status != TraceStatus::hit) return none;
        t += entered.t;
        if (ray.origin.z + t * ray.direction.z <= hanging_.top.at(entered.cell.x, entered.cell.y))
            return {TraceStatus::hit, t, entered.cell};
        // Above that crown: on to where it comes to the side of a higher one, or sinks into this.
        entered = tops_.trace({ray.origin + t * ray.direction, ray.direction}, tMax - t);
        if (entered.status != TraceStatus::hit) return none;
        t += entered.t;
        if (ray.origin.z + t * ray.direction.z >= hanging_.underside.at(entered.cell.x, entered.cell.y))
            return {TraceStatus::hit, t, entered.cell};
        if (entered.t < least) t += least;
        entered = undersides_.trace(upsideDown({ray.origin + t * ray.direction, ray.direction}), tMax - t);
    }
    return {TraceStatus::hit, t, entered.cell};
}

void HangingTracer::lower(glm::vec3 origin, std::span<const float> dx, std::span<const float> dy,
                          std::span<const float> dz, std::span<float> t) const {
    // Reused: a local map asks for thousands of small fans.
    thread_local std::vector<float> down, first;
    down.resize(t.size());
    first.resize(t.size());
    for (std::size_t k = 0; k < t.size(); ++k) down[k] = -dz[k];
    undersides_.traceFan({origin.x, origin.y, -origin.z}, dx, dy, down, first);
    for (std::size_t k = 0; k < t.size(); ++k) {
        // Not for what is invalid: NaN is not below anything.
        if (!(first[k] < t[k])) continue;
        const float most = std::min(t[k], std::numeric_limits<float>::max());
        const TraceResult met = trace({origin, {dx[k], dy[k], dz[k]}}, most);
        if (met.status == TraceStatus::hit && met.t < t[k]) t[k] = met.t;
    }
}

}  // namespace reflection
