// Per-instruction-set part of the reflection-point search: the first round on convex pieces. Included once
// per target by ReflectionSearch.cpp.
#if defined(REFLECTION_CHROME_QUICK_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_CHROME_QUICK_SEARCH_INL_H
#undef REFLECTION_CHROME_QUICK_SEARCH_INL_H
#else
#define REFLECTION_CHROME_QUICK_SEARCH_INL_H
#endif

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>

#include "reflection/chrome/ReflectionSearch.h"
#include "reflection/chrome/SearchLanes-inl.h"
#include "reflection/chrome/SearchStart-inl.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Cosine between normal and line of sight below which what has arrived is asked all the same: there rounding
/// tells.
constexpr double surelyFaces = 1e-3;

/// Steps in floats end at this sine between bisector and normal, well above their rounding (5e-7 at distances
/// of one radius); Newton's step in doubles from there ends at its square.
constexpr double floatTolerance = 1e-4;

/// Lookups in floats after which a vertex is left to the second round: hidden ones have no point to arrive
/// at. Most others arrive in four.
constexpr int floatLookups = 14;

/// Halvings in a row after which a descent in floats ends.
constexpr double mostFloatHalvings = 4;

/// Lookups of a descent in doubles from where floats arrived and one step did not do.
constexpr int polishLookups = 6;

/// Of a blended coverage: nearer to the rim, a point is left to the second round, which converges as far as
/// doubles go, so that on which side it ends does not hang on where descents begin.
constexpr double coverageDoubt = 1e-3;

/// Full vectors of 512 bits are written past the end.
constexpr std::size_t spare = 16;

/// A block of vertices in the map's frame and units, what is not finite at the origin, and where descents in
/// floats arrived.
struct SearchBlock {
    static constexpr std::size_t most = 256;
    HWY_ALIGN std::array<double, most + spare> x, y, z;
    HWY_ALIGN std::array<float, most + spare> floatX, floatY, floatZ;
    HWY_ALIGN std::array<float, most + spare> finite;
    /// Directions, stretch taken out; not a number where a descent did not arrive.
    HWY_ALIGN std::array<float, most + spare> atX, atY, atZ;
    std::array<std::uint8_t, most + spare> lookups;
    std::size_t count = 0;

    /// Vertices in the reflector's frame, at most `most`.
    SearchBlock(const MapFrame& frame, std::span<const glm::dvec3> vertices) : count(vertices.size()) {
        const Doubles d;
        const HalfFloats half;
        const std::size_t lanes = hn::Lanes(d);
        const Num3 centre = num3(frame.centre), axisX = num3(frame.axes[0]), axisY = num3(frame.axes[1]),
                   axisZ = num3(frame.axes[2]);
        const Num perScale = num(1 / frame.scale);
        for (std::size_t first = 0; first < count + spare && first < most + spare; first += lanes) {
            Num3 p;
            if (first + lanes <= count) {
                hn::LoadInterleaved3(d, &vertices[first].x, p.x.v, p.y.v, p.z.v);
            } else {
                Values3 last;
                for (std::size_t k = 0; k < lanes; ++k) last.set(k, vertices[std::min(first + k, count - 1)]);
                p = last.load();
            }
            const MD is = size(p.x) + size(p.y) + size(p.z) <= num(DBL_MAX);
            const Num3 from = p - centre;
            const auto put = [&](Num n, double* at, float* low) {
                n.v = hn::IfThenElseZero(is, n.v);
                hn::StoreU(n.v, d, at + first);
                hn::StoreU(hn::DemoteTo(half, n.v), half, low + first);
            };
            put(perScale * dot(from, axisX), x.data(), floatX.data());
            put(perScale * dot(from, axisY), y.data(), floatY.data());
            put(perScale * dot(from, axisZ), z.data(), floatZ.data());
            hn::StoreU(hn::DemoteTo(half, choose(is, num(1), num(0)).v), half, finite.data() + first);
        }
        std::fill_n(atX.begin(), count + spare, std::numeric_limits<float>::quiet_NaN());
        std::fill_n(lookups.begin(), count + spare, std::uint8_t{0});
    }
};

/// Descents in floats that are under way, side by side: what has ended makes room, so vectors stay full.
struct Walkers {
    HWY_ALIGN std::array<float, SearchBlock::most + spare> vertexX, vertexY, vertexZ, cubeX, cubeY, cubeZ,
        stepX, stepY, stepZ, error, halvings;
    HWY_ALIGN std::array<std::int32_t, SearchBlock::most + spare> index;

    using Floats3 = Real3<float>;
    static HWY_INLINE Floats3 load(const float* x, const float* y, const float* z) {
        const Floats f;
        return {{hn::LoadU(f, x)}, {hn::LoadU(f, y)}, {hn::LoadU(f, z)}};
    }
    HWY_INLINE Floats3 vertices(std::size_t k) const { return load(&vertexX[k], &vertexY[k], &vertexZ[k]); }
    HWY_INLINE Floats3 cubes(std::size_t k) const { return load(&cubeX[k], &cubeY[k], &cubeZ[k]); }
    HWY_INLINE Floats3 steps(std::size_t k) const { return load(&stepX[k], &stepY[k], &stepZ[k]); }

    /// Those of a vector that go on, from place `to`; returns how many.
    HWY_INLINE std::size_t keep(std::size_t to, MF going, const Floats3& vertex, const Floats3& cube,
                                const Floats3& step, Real<float> off, Real<float> halved,
                                hn::Vec<hn::Rebind<std::int32_t, Floats>> number) {
        const Floats f;
        const hn::Rebind<std::int32_t, Floats> ints;
        const auto put = [&](Real<float> n, float* at) { hn::StoreU(hn::Compress(n.v, going), f, at + to); };
        put(vertex.x, vertexX.data()), put(vertex.y, vertexY.data()), put(vertex.z, vertexZ.data());
        put(cube.x, cubeX.data()), put(cube.y, cubeY.data()), put(cube.z, cubeZ.data());
        put(step.x, stepX.data()), put(step.y, stepY.data()), put(step.z, stepZ.data());
        put(off, error.data()), put(halved, halvings.data());
        hn::StoreU(hn::Compress(number, hn::RebindMask(ints, going)), ints, index.data() + to);
        return hn::CountTrue(f, going);
    }
};

/// Descents in floats from the guesses (directions, stretch taken out), or where there are none (empty, or
/// not a number) from a start of its own. Fills the block's `at` and `lookups`.
inline void descendInFloats(const ReflectorMap& map, const EyeSide& eyeSide,
                            std::span<const glm::dvec3> guesses, SearchBlock& block) {
    const Floats f;
    const hn::Rebind<std::int32_t, Floats> ints;
    const std::size_t lanes = hn::Lanes(f);
    const Real3<float> eye = real3<float>(eyeSide.eye);
    const StretchOf<float> stretch(map);
    const Real<float> enough = real<float>(floatTolerance * floatTolerance), zero = real<float>(0);
    Walkers walkers;
    std::size_t walking = 0;
    const auto arrive = [&](MF arrived, const Real3<float>& cube, hn::Vec<decltype(ints)> index,
                            int lookups) {
        if (hn::AllFalse(f, arrived)) return;
        HWY_ALIGN std::array<float, spare> x, y, z;
        HWY_ALIGN std::array<std::int32_t, spare> number;
        hn::StoreU(hn::Compress(cube.x.v, arrived), f, x.data());
        hn::StoreU(hn::Compress(cube.y.v, arrived), f, y.data());
        hn::StoreU(hn::Compress(cube.z.v, arrived), f, z.data());
        hn::StoreU(hn::Compress(index, hn::RebindMask(ints, arrived)), ints, number.data());
        const std::size_t n = hn::CountTrue(f, arrived);
        for (std::size_t k = 0; k < n; ++k) {
            const auto to = static_cast<std::size_t>(number[k]);
            block.atX[to] = x[k], block.atY[to] = y[k], block.atZ[to] = z[k];
            block.lookups[to] = static_cast<std::uint8_t>(lookups);
        }
    };
    for (std::size_t first = 0; first < block.count; first += lanes) {
        const Real3<float> vertex =
            Walkers::load(&block.floatX[first], &block.floatY[first], &block.floatZ[first]);
        Real3<float> start;
        MF own = zero < real<float>(1);
        if (!guesses.empty()) {
            HWY_ALIGN std::array<float, spare> x, y, z;
            for (std::size_t k = 0; k < lanes; ++k) {
                const glm::dvec3& guess = guesses[std::min(first + k, block.count - 1)];
                x[k] = static_cast<float>(guess.x);
                y[k] = static_cast<float>(guess.y);
                z[k] = static_cast<float>(guess.z);
            }
            start = stretch.takeOut(Walkers::load(x.data(), y.data(), z.data()));
            own = hn::Not(dot(start, start) > zero);
        }
        if (!hn::AllFalse(f, own)) {
            const Real3<float> made = startFor(map, eyeSide, vertex);
            start = guesses.empty() ? made : choose(own, made, start);
        }
        const MF open = hn::AndNot(surelyEnters(map, stretch.takeOut(eye), stretch.takeOut(vertex)),
                                   hn::And(hn::FirstN(f, block.count - first),
                                           Real<float>{hn::LoadU(f, &block.finite[first])} > zero));
        const JudgedOf<float> judged = judge(map, eye, vertex, start, true);
        const auto index = hn::Iota(ints, static_cast<std::int32_t>(first));
        const MF arrived = hn::And(open, judged.error <= enough);
        arrive(arrived, judged.onCube, index, 1);
        walking += walkers.keep(walking, hn::AndNot(arrived, open), vertex, judged.onCube, judged.step,
                                judged.error, zero, index);
    }
    for (int lookups = 2; lookups <= floatLookups && walking > 0; ++lookups) {
        std::size_t left = 0;
        for (std::size_t first = 0; first < walking; first += lanes) {
            const MF active = hn::FirstN(f, walking - first);
            const Real3<float> vertex = walkers.vertices(first), before = walkers.cubes(first);
            Real3<float> step = walkers.steps(first);
            const Real<float> error{hn::LoadU(f, &walkers.error[first])};
            const auto index = hn::LoadU(ints, &walkers.index[first]);
            const JudgedOf<float> next = judge(map, eye, vertex, before + step, true);
            const MF better = next.error < error;
            const Real3<float> cube = choose(better, next.onCube, before);
            step = choose(better, next.step, real<float>(0.5) * step);
            const Real<float> halved =
                choose(better, zero, Real<float>{hn::LoadU(f, &walkers.halvings[first])} + real<float>(1));
            const Real<float> off = choose(better, next.error, error);
            const MF arrived = hn::And(active, off <= enough);
            arrive(arrived, cube, index, lookups);
            const MF going = hn::And(hn::AndNot(arrived, active), halved < real<float>(mostFloatHalvings));
            left += walkers.keep(left, going, vertex, cube, step, off, halved, index);
        }
        walking = left;
    }
}

/// Convex pieces, first round. A point before whose tangent plane eye and vertex both lie shows that a convex
/// body does not stand between them, so what arrives is answered, in the reflector's frame. Returns how many
/// are not; which goes to `rest`. Eye and guesses: in the map's frame; vertices: in the reflector's.
std::size_t searchQuickly(const ReflectorMap& map, const glm::dvec3& mapEye,
                          std::span<const glm::dvec3> guesses, std::span<const glm::dvec3> vertices,
                          std::span<ReflectionPoint> points, std::span<std::uint32_t> rest,
                          const SearchOptions& options) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    const EyeSide eyeSide(map, mapEye);
    SearchBlock block(map.frame(), vertices);
    const Num3 eye = num3(mapEye);
    const Num enough = num(options.tolerance * options.tolerance);
    descendInFloats(map, eyeSide, guesses, block);
    SearchOptions polish = options;
    polish.lookups = polishLookups;
    const MapFrame& frame = map.frame();
    const Num3 axisX = num3(frame.axes[0]), axisY = num3(frame.axes[1]), axisZ = num3(frame.axes[2]);
    const auto turnedOut = [&](const Num3& p) { return p.x * axisX + (p.y * axisY + p.z * axisZ); };
    std::size_t left = 0;
    for (std::size_t first = 0; first < block.count; first += lanes) {
        const HalfFloats half;
        const auto direction = [&](const auto& from) {
            return Num{hn::PromoteTo(tag, hn::LoadU(half, &from[first]))};
        };
        const Num3 start{direction(block.atX), direction(block.atY), direction(block.atZ)};
        MD open = hn::Not(hn::IsNaN(start.x.v));
        std::uint8_t lookups = 0;
        Judged best;
        if (hn::AllFalse(tag, open)) {
            best.error = num(2);
            best.point = best.normal = {num(0), num(0), num(0)};
            best.path = num(0);
        } else {
            const Num3 vertex{{hn::LoadU(tag, &block.x[first])},
                              {hn::LoadU(tag, &block.y[first])},
                              {hn::LoadU(tag, &block.z[first])}};
            best = judge(map, eye, vertex, start, true);
            lookups = 1;
            MD walking = hn::And(open, best.error > enough);
            if (!hn::AllFalse(tag, walking)) {
                const Judged end = judgeEnd(map, eye, vertex, best.onCube + best.step);
                lookups = 2;
                const MD arrived = hn::And(walking, end.error <= enough);
                walking = hn::AndNot(arrived, walking);
                if (!hn::AllFalse(tag, walking)) {
                    const Descent descent = descend(map, eye, vertex, best, walking, polish, true);
                    best = choose(walking, descent.best, best);
                    lookups += polishLookups;
                }
                best = choose(arrived, end, best);
            }
            const Num3 toEye = eye - best.point;
            const MD faces = dot(toEye, best.normal) > num(surelyFaces) * root(dot(toEye, toEye));
            open = hn::And(hn::And(open, faces), best.error <= enough);
        }
        Values3 at, up, inMap;
        Values path, residual;
        inMap.store(best.point);
        at.store(num3(frame.centre) + turnedOut(num(frame.scale) * best.point));
        up.store(turnedOut(best.normal));
        path.store(num(frame.scale) * best.path);
        // The sine is the angle to 1e-21.
        residual.store(choose(open, root(best.error), num(4)));
        const std::size_t n = std::min(lanes, block.count - first);
        for (std::size_t k = 0; k < n; ++k) {
            ReflectionPoint& r = points[first + k];
            r.lookups = static_cast<std::uint8_t>(block.lookups[first + k] + lookups);
            if (!(residual.at[k] < 4)) {
                rest[left++] = static_cast<std::uint32_t>(first + k);
                continue;
            }
            const double share = map.closed() ? 1 : map.coveredShare(inMap.get(k));
            if (std::abs(share - 0.5) < coverageDoubt) {
                rest[left++] = static_cast<std::uint32_t>(first + k);
                continue;
            }
            r.point = at.get(k);
            r.normal = up.get(k);
            r.residual = residual.at[k];
            r.path = path.at[k];
            r.status = share >= 0.5 ? ReflectionStatus::found : ReflectionStatus::unreflected;
        }
    }
    return left;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
