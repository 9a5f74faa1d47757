// The hard rays again, where crowns hang above the columns: against the columns alone, against the same with
// crowns down to the ground, and against the entered crown itself.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "app/stability/AdversarialRays.h"
#include "app/stability/Stability.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

using reflection::GridTracer;
using reflection::TraceResult;
using reflection::TraceStatus;

constexpr std::size_t familyCount = static_cast<std::size_t>(RayFamily::count);
constexpr std::uint64_t raysOfFamily = 128;  ///< in one field
constexpr int longestFan = 64;

struct Crowned {
    city::Overhang hanging;
    city::Heightfield filled;  ///< with crowns down to the ground
};

/// Crowns over a third of the cells, some of them touching the column below, some upside down (none).
Crowned crowned(const city::Heightfield& field, SeededRandom& random) {
    const city::Heightfield empty(field.width(), field.height(), field.cellSize(), field.origin());
    Crowned crowns{{empty, empty}, field};
    const double cell = static_cast<double>(field.cellSize());
    for (int j = 0; j < field.height(); ++j)
        for (int i = 0; i < field.width(); ++i) {
            if (!random.oneIn(3)) continue;
            const float ground = field.at(i, j);
            const float from = std::isfinite(ground) ? ground : 0;
            const auto underside =
                random.oneIn(8) ? from : from + static_cast<float>(cell * random.magnitude(1e-4, 20));
            const float top =
                underside + static_cast<float>(cell * (random.oneIn(8) ? 0 : random.magnitude(1e-4, 20)));
            crowns.hanging.underside.set(i, j, underside);
            crowns.hanging.top.set(i, j, top);
            if (crowns.hanging.hangs(i, j) && !(top <= ground)) crowns.filled.set(i, j, top);
        }
    return crowns;
}

struct Tally {
    std::uint64_t rays = 0, entered = 0;
    std::uint64_t notNumbers = 0, fansDiffer = 0, limits = 0, early = 0, late = 0, offCrown = 0, through = 0;
    double worst = 0;
    std::string example;

    std::uint64_t failures() const {
        return notNumbers + fansDiffer + limits + early + late + offCrown + through;
    }
    void add(const Tally& b) {
        rays += b.rays, entered += b.entered, notNumbers += b.notNumbers, fansDiffer += b.fansDiffer;
        through += b.through, limits += b.limits, early += b.early, late += b.late, offCrown += b.offCrown;
        worst = std::max(worst, b.worst);
        if (example.empty()) example = b.example;
    }
};

/// Of coordinates, heights and the way along each: t is a float, and so are crowns.
constexpr double rounding = 0x1p-21;

/// Whether the ray is well inside a crown there: no rounding decides it.
bool deepInside(const city::Overhang& hanging, const city::Ray& ray, double t) {
    const city::Heightfield& tops = hanging.top;
    const double cell = static_cast<double>(tops.cellSize()), margin = 0x1p-8;
    const glm::dvec3 p = glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction);
    const glm::dvec2 at = (glm::dvec2(p) - tops.origin()) / cell;
    // The walk computes places to 2^-40 of them, starts anew at floats.
    const double rounded = rounding * std::max(std::abs(p.x), std::abs(p.y)) / cell;
    if (!(rounded < margin) || !(at.x >= 0 && at.y >= 0 && at.x < tops.width() && at.y < tops.height()))
        return false;
    const glm::dvec2 inside = at - glm::floor(at);
    if (std::min({inside.x, inside.y, 1 - inside.x, 1 - inside.y}) < margin) return false;
    const int i = static_cast<int>(at.x), j = static_cast<int>(at.y);
    if (!hanging.hangs(i, j)) return false;
    const double low = static_cast<double>(hanging.underside.at(i, j)),
                 high = static_cast<double>(tops.at(i, j));
    const double slack = rounding * (std::abs(static_cast<double>(ray.origin.z)) + std::abs(low) +
                                     std::abs(high) + std::abs(t * static_cast<double>(ray.direction.z)));
    return p.z > low + slack && p.z < high - slack;
}

void judge(const city::Ray& ray, const TraceResult& met, float inFan, const GridTracer& bare,
           const GridTracer& filled, const city::Overhang& hanging, const GridTracer& tracer,
           SeededRandom& random, Tally& tally) {
    ++tally.rays;
    const TraceResult solid = bare.trace(ray), first = filled.trace(ray);
    if (met.status == TraceStatus::invalid || std::isnan(met.t)) {
        tally.notNumbers += 1;
        return;
    }
    const auto parameter = [](const TraceResult& r) {
        return r.status == TraceStatus::hit ? r.t : std::numeric_limits<float>::infinity();
    };
    const float t = parameter(met);
    tally.fansDiffer += t != inFan ? 1 : 0;
    tally.late += t > parameter(solid) ? 1 : 0;
    tally.early += t < parameter(first) ? 1 : 0;
    const double across = std::max(std::abs(static_cast<double>(ray.direction.x)),
                                   std::abs(static_cast<double>(ray.direction.y)));
    const double farthest = 2.0 * std::max(hanging.top.width(), hanging.top.height()) *
                            static_cast<double>(hanging.top.cellSize());
    // What lies beyond the largest float is not met.
    const double until = std::min(std::isfinite(t) ? static_cast<double>(t)
                                  : across > 0     ? farthest / across
                                                   : 0,
                                  static_cast<double>(std::numeric_limits<float>::max()));
    for (int k = 0; k < 4; ++k) {
        const double s = until * random.unit();
        if (s < 0.999 * until) tally.through += deepInside(hanging, ray, s) ? 1 : 0;
    }
    if (met.status != TraceStatus::hit) return;
    const TraceResult again = tracer.trace(ray, met.t);
    tally.limits += parameter(again) != met.t ? 1 : 0;
    if (met.t == parameter(solid)) return;
    ++tally.entered;
    if (!hanging.hangs(met.cell.x, met.cell.y)) {
        ++tally.offCrown;
        return;
    }
    const double along = static_cast<double>(met.t) * static_cast<double>(ray.direction.z);
    const double z = static_cast<double>(ray.origin.z) + along;
    const double low = static_cast<double>(hanging.underside.at(met.cell.x, met.cell.y)),
                 high = static_cast<double>(hanging.top.at(met.cell.x, met.cell.y));
    const double off = std::max({low - z, z - high, 0.0});
    // Rounding t moves the place along the ray by as much; below the normal floats by half of the smallest.
    const double ofT = std::abs(static_cast<double>(ray.direction.z)) * 0x1p-150;
    const double heights = std::abs(static_cast<double>(ray.origin.z)) + std::abs(along) +
                           std::max(std::abs(low), std::abs(high));
    const double share = off / (rounding * heights + ofT + 0x1p-149);
    tally.worst = std::max(tally.worst, share);
    tally.offCrown += share > 1 ? 1 : 0;
}

Tally tryField(const FieldKind& kind, std::uint64_t seed, std::uint64_t stream) {
    Tally tally;
    SeededRandom random(seed, stream);
    const city::Heightfield field = makeField(kind, random);
    const Crowned crowns = crowned(field, random);
    const GridTracer tracer(field, crowns.hanging), bare(field), filled(crowns.filled);
    std::vector<float> dx, dy, dz, t;
    for (std::size_t f = 0; f < familyCount; ++f) {
        const auto family = static_cast<RayFamily>(f);
        for (std::uint64_t done = 0; done < raysOfFamily;) {
            const glm::vec3 start = startOf(family, random.oneIn(2) ? field : crowns.filled, random);
            const auto count = static_cast<std::size_t>(1 + random.below(longestFan));
            for (auto* column : {&dx, &dy, &dz}) column->clear();
            for (std::size_t k = 0; k < count; ++k) {
                const glm::vec3 d = directionOf(family, crowns.filled, start, random);
                dx.push_back(d.x);
                dy.push_back(d.y);
                dz.push_back(d.z);
            }
            t.assign(count, -1);
            tracer.traceFan(start, dx, dy, dz, t);
            for (std::size_t k = 0; k < count; ++k) {
                const city::Ray ray{start, {dx[k], dy[k], dz[k]}};
                const std::uint64_t before = tally.failures();
                judge(ray, tracer.trace(ray), t[k], bare, filled, crowns.hanging, tracer, random, tally);
                if (tally.failures() == before || !tally.example.empty()) continue;
                tally.example =
                    described(ray, std::string(kind.name) + ", " + std::string(nameOf(family)), stream);
            }
            done += count;
        }
    }
    return tally;
}

}  // namespace

std::vector<Row> tryHanging(const Options& options) {
    const std::span<const FieldKind> kinds = fieldKinds();
    const auto rounds = static_cast<std::uint64_t>(std::max(1, 4 * options.effort()));
    Tally all;
    for (std::uint64_t round = 0; round < rounds && !options.stop(); ++round) {
        std::vector<Tally> tallies(kinds.size());
        tbb::parallel_for(std::size_t{0}, kinds.size(), [&](std::size_t k) {
            tallies[k] = tryField(kinds[k], options.seed, 7'000'000 + round * kinds.size() + k);
        });
        for (const Tally& tally : tallies) all.add(tally);
        options.tell(static_cast<double>(round + 1) / static_cast<double>(rounds));
    }
    const auto counted = [&](const std::string& what, std::uint64_t failures, const std::string& from) {
        return Row{"hanging",
                   what,
                   all.rays,
                   failures,
                   static_cast<double>(failures),
                   0,
                   "of them",
                   from,
                   failures > 0 ? all.example : ""};
    };
    return {
        counted("rays among crowns: not a number", all.notNumbers, "every ray of theirs is finite"),
        counted("rays among crowns: fan and single ray differ in a bit", all.fansDiffer,
                "GridTracer.h: they agree bit for bit"),
        counted("rays among crowns: not met with a limit where they are met", all.limits,
                "GridTracer.h: only entries with t > tMax are misses"),
        counted("rays among crowns: met behind what is solid", all.late, "crowns take nothing away"),
        counted("rays among crowns: met before crowns down to the ground", all.early,
                "air beneath crowns stops nothing"),
        counted("rays among crowns: four places before where they are met that lie in one", all.through,
                "a place more than 2^-8 of a cell from its borders, told in doubles"),
        {"hanging", "rays that enter a crown: off its height there", all.entered, all.offCrown, all.worst, 1,
         "of 2^-21 of the heights", "t and heights are floats, four roundings; t may be denormal",
         all.offCrown > 0 ? all.example : ""},
    };
}

}  // namespace app::stability
