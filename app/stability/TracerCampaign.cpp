// Rays that are hard on grid walks, alone and in fans, against an exact reference.
#include <tbb/parallel_for.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "app/stability/AdversarialRays.h"
#include "app/stability/ExactReference.h"
#include "app/stability/Stability.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

using reflection::GridTracer;
using reflection::TraceResult;
using reflection::TraceStatus;

constexpr std::size_t familyCount = static_cast<std::size_t>(RayFamily::count);
constexpr std::uint64_t raysOfFamily = 512;  ///< in one field, before the next one is made
constexpr int longestFan = 96;

/// A street's ray visits some tens of cells at about 10 ns each. A fan of 96 rays that takes this long on the
/// processor hangs; a ray that never comes back is told by the test's or the caller's time limit.
constexpr double hangs = 1.0;  // seconds

double threadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// How the rays of one family fared in one kind of field.
struct Tally {
    std::uint64_t rays = 0, hits = 0;
    std::uint64_t missed = 0;   ///< the reference hits, the tracer does not
    std::uint64_t wrong = 0;    ///< another status or cell
    std::uint64_t inexact = 0;  ///< t beyond its bound
    std::uint64_t notNumbers = 0;
    std::uint64_t fansDiffer = 0;    ///< the fan's t is not, bit for bit, that of the single ray
    std::uint64_t limitsDiffer = 0;  ///< a limit at the hit, or just before it, is not kept
    double worst = 0;                ///< share of t's bound
    std::string example;

    std::uint64_t failures() const {
        return missed + wrong + inexact + notNumbers + fansDiffer + limitsDiffer;
    }
    void add(const Tally& other) {
        rays += other.rays;
        hits += other.hits;
        missed += other.missed;
        wrong += other.wrong;
        inexact += other.inexact;
        notNumbers += other.notNumbers;
        fansDiffer += other.fansDiffer;
        limitsDiffer += other.limitsDiffer;
        worst = std::max(worst, other.worst);
        if (example.empty()) example = other.example;
    }
};

/// One field with rays of every family.
struct Work {
    std::array<Tally, familyCount> tallies;
    std::uint64_t fans = 0, hanging = 0;
    double slowestFan = 0;  ///< seconds
};

void judge(const ExactReference::Answer& truth, const TraceResult& result, float fanT, Tally& tally) {
    ++tally.rays;
    if (std::isnan(result.t) || std::isnan(fanT)) ++tally.notNumbers;
    if (std::bit_cast<std::uint32_t>(result.t) != std::bit_cast<std::uint32_t>(fanT)) ++tally.fansDiffer;
    if (truth.status != result.status) {
        ++(truth.status == TraceStatus::hit ? tally.missed : tally.wrong);
        return;
    }
    if (truth.status != TraceStatus::hit) return;
    ++tally.hits;
    if (truth.cell != result.cell) {
        ++tally.wrong;
        return;
    }
    const double share = ExactReference::shareOfBound(result.t, truth);
    tally.worst = std::max(tally.worst, share);
    if (!(share <= 1)) ++tally.inexact;
}

void tryLimits(const GridTracer& tracer, const city::Ray& ray, const TraceResult& hit, Tally& tally) {
    const TraceResult reached = tracer.trace(ray, hit.t);
    if (reached.status != TraceStatus::hit || reached.t != hit.t) ++tally.limitsDiffer;
    if (hit.t > 0 && tracer.trace(ray, std::nextafter(hit.t, -1.0f)).status != TraceStatus::miss)
        ++tally.limitsDiffer;
}

Work tryField(const FieldKind& kind, std::uint64_t seed, std::uint64_t stream) {
    Work work;
    SeededRandom random(seed, stream);
    const city::Heightfield field = makeField(kind, random);
    const GridTracer tracer(field);
    const ExactReference reference(field);
    std::vector<float> dx, dy, dz, t;
    for (std::size_t f = 0; f < familyCount; ++f) {
        Tally& tally = work.tallies[f];
        const auto family = static_cast<RayFamily>(f);
        while (tally.rays < raysOfFamily) {
            const glm::vec3 start = startOf(family, field, random);
            const auto count = static_cast<std::size_t>(1 + random.below(random.oneIn(2) ? longestFan : 4));
            for (auto* column : {&dx, &dy, &dz}) column->clear();
            for (std::size_t k = 0; k < count; ++k) {
                const glm::vec3 d = directionOf(family, field, start, random);
                dx.push_back(d.x);
                dy.push_back(d.y);
                dz.push_back(d.z);
            }
            t.assign(count, -1);
            std::vector<TraceResult> singles(count);
            const double before = threadSeconds();
            tracer.traceFan(start, dx, dy, dz, t);
            for (std::size_t k = 0; k < count; ++k) singles[k] = tracer.trace({start, {dx[k], dy[k], dz[k]}});
            const double taken = threadSeconds() - before;
            ++work.fans;
            work.hanging += taken > hangs ? 1 : 0;
            work.slowestFan = std::max(work.slowestFan, taken);
            for (std::size_t k = 0; k < count; ++k) {
                const city::Ray ray{start, {dx[k], dy[k], dz[k]}};
                judge(reference.trace(ray), singles[k], t[k], tally);
                if (k % 8 == 0 && singles[k].status == TraceStatus::hit)
                    tryLimits(tracer, ray, singles[k], tally);
                if (tally.failures() > 0 && tally.example.empty())
                    tally.example = described(ray, kind.name, stream);
            }
        }
    }
    return work;
}

constexpr const char* boundOfT = "|t - t*| <= (2^-24 + 2^-51) |t*| + 2^-150, derived in ExactWalk.h";

Row rowOf(const std::string& what, const Tally& tally) {
    Row row{"tracer", what,           tally.rays, tally.failures(), tally.worst,
            1,        "of t's bound", boundOfT,   tally.example};
    return row;
}

Row counted(const std::string& what, std::uint64_t tried, std::uint64_t failures,
            const std::string& boundFrom) {
    return {"tracer", what, tried, failures, static_cast<double>(failures), 0, "of them", boundFrom, ""};
}

}  // namespace

std::vector<Row> tryTracer(const Options& options) {
    const std::span<const FieldKind> kinds = fieldKinds();
    const std::uint64_t raysOfField = raysOfFamily * familyCount;
    const std::uint64_t rounds = std::max<std::uint64_t>(
        1, (options.rays + raysOfField * kinds.size() - 1) / (raysOfField * kinds.size()));
    std::array<Tally, familyCount> byFamily;
    std::vector<Tally> byField(kinds.size());
    Tally all;
    std::uint64_t fans = 0, hanging = 0;
    double slowest = 0;
    // Some rounds at a time, so that progress is told and an interrupt is heard; merged in order, so that the
    // result does not depend on the number of threads.
    constexpr std::uint64_t together = 4;
    for (std::uint64_t first = 0; first < rounds && !options.stop(); first += together) {
        const std::uint64_t count = std::min(together, rounds - first);
        std::vector<Work> works(count * kinds.size());
        tbb::parallel_for(std::size_t{0}, works.size(), [&](std::size_t w) {
            works[w] = tryField(kinds[w % kinds.size()], options.seed, first * kinds.size() + w);
        });
        for (std::size_t w = 0; w < works.size(); ++w) {
            for (std::size_t f = 0; f < familyCount; ++f) {
                byFamily[f].add(works[w].tallies[f]);
                byField[w % kinds.size()].add(works[w].tallies[f]);
                all.add(works[w].tallies[f]);
            }
            fans += works[w].fans;
            hanging += works[w].hanging;
            slowest = std::max(slowest, works[w].slowestFan);
        }
        options.tell(static_cast<double>(first + count) / static_cast<double>(rounds));
    }

    std::vector<Row> rows;
    for (std::size_t f = 0; f < familyCount; ++f)
        rows.push_back(rowOf("rays " + std::string(nameOf(static_cast<RayFamily>(f))), byFamily[f]));
    for (std::size_t k = 0; k < kinds.size(); ++k)
        rows.push_back(rowOf("fields with " + std::string(kinds[k].name), byField[k]));
    const std::string exact = "the rules of GridTracer.h, decided exactly";
    rows.push_back(counted("all rays: missed though they hit", all.rays, all.missed, exact));
    rows.push_back(counted("all rays: another status or cell", all.rays, all.wrong, exact));
    rows.push_back(counted("all rays: not a number", all.rays, all.notNumbers, exact));
    rows.push_back(counted("all rays: fan and single ray differ in a bit", all.rays, all.fansDiffer,
                           "GridTracer.h: they agree bit for bit"));
    rows.push_back(counted("hits with a limit at and a float before them", all.hits / 8, all.limitsDiffer,
                           "GridTracer.h: entries with t > tMax are misses"));
    rows.push_back({"tracer", "fans of up to 96 rays: time on the processor", fans, hanging, slowest, hangs,
                    "s", "a thousand times what their cells take", ""});
    return rows;
}

}  // namespace app::stability
