// The leaping walk (LeapWalk.h) for as many rays at a time as the processor's vectors hold. Compiled once for
// each instruction set; the widest one present is chosen at run time.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "reflection/tracing/LeapWalk.h"

// Vectors without a fixed size cannot be captured by lambdas; processors with SVE have NEON too.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/tracing/LeapFan.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace reflection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Bits = hn::RebindToUnsigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
using MF = hn::Mask<Floats>;
using MI = hn::Mask<Ints>;

constexpr std::size_t widest = 16;  ///< lanes used at most

/// What all rays of the fan share.
struct FanStart {
    const TracedGrid& grid;
    glm::vec3 origin;
    int i0, j0;
    float fu, fv;                  ///< start within its cell
    float fuMirrored, fvMirrored;  ///< 1 - fu, 1 - fv, rounded from double
};

constexpr int missed = 16;
constexpr int undecided = 17;              ///< left to leapWalk
constexpr std::size_t stragglerShare = 6;  ///< of the lanes: when no more are busy, the vector is given up

/// entryParameter for the hits of one vector of rays. `a` and `b` are cells passed, `column` is wanted where
/// face is top.
void finish(const FanStart& fan, const float* dx, const float* dy, const float* dz, const std::int32_t* face,
            const std::int32_t* a, const std::int32_t* b, const float* column, float* t) {
    const hn::ScalableTag<double> d;
    const hn::Rebind<float, decltype(d)> f;
    const hn::Rebind<std::int32_t, decltype(d)> i;
    const TracedGrid& grid = fan.grid;
    const auto zero = hn::Zero(d);
    const auto cellSize = hn::Set(d, grid.cellSize);
    // The border crossed last, in cells of the grid: the start's own border and as many onwards as cells were
    // passed.
    const auto crossing = [&](const std::int32_t* passed, int start, auto direction, double first,
                              float from) {
        const auto count = hn::PromoteTo(d, hn::Load(i, passed));
        const auto border = hn::IfThenElse(hn::Lt(direction, zero), hn::Sub(hn::Set(d, start + 1.0), count),
                                           hn::Add(hn::Set(d, static_cast<double>(start)), count));
        const auto plane = hn::Add(hn::Set(d, first), hn::Mul(border, cellSize));
        return hn::Sub(plane, hn::Set(d, static_cast<double>(from)));
    };
    for (std::size_t k = 0; k < hn::Lanes(Floats()); k += hn::Lanes(d)) {
        const auto code = hn::PromoteTo(d, hn::Load(i, face + k));
        const auto is = [&](EntryFace which) { return hn::Eq(code, hn::Set(d, static_cast<double>(which))); };
        const auto directionX = hn::PromoteTo(d, hn::LoadU(f, dx + k));
        const auto directionY = hn::PromoteTo(d, hn::LoadU(f, dy + k));
        auto length =
            hn::Sub(hn::PromoteTo(d, hn::Load(f, column + k)), hn::Set(d, static_cast<double>(fan.origin.z)));
        auto speed = hn::PromoteTo(d, hn::LoadU(f, dz + k));
        length = hn::IfThenElse(is(EntryFace::x),
                                crossing(a + k, fan.i0, directionX, grid.origin.x, fan.origin.x), length);
        speed = hn::IfThenElse(is(EntryFace::x), directionX, speed);
        length = hn::IfThenElse(is(EntryFace::y),
                                crossing(b + k, fan.j0, directionY, grid.origin.y, fan.origin.y), length);
        speed = hn::IfThenElse(is(EntryFace::y), directionY, speed);
        auto result = hn::Add(hn::Div(length, speed), zero);
        result = hn::IfThenElse(is(EntryFace::start), zero, result);
        result = hn::IfThenElse(hn::Ge(code, hn::Set(d, static_cast<double>(missed))),
                                hn::Set(d, std::numeric_limits<double>::infinity()), result);
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
        // Highway's emulation would turn infinity into the largest float.
        alignas(64) double wide[widest];
        hn::Store(result, d, wide);
        for (std::size_t n = 0; n < hn::Lanes(d); ++n) t[k + n] = static_cast<float>(wide[n]);
#else
        hn::Store(hn::DemoteTo(f, result), f, t + k);
#endif
    }
}

/// Walks one vector of rays; t is aligned. Returns whether some are undecided, with their `face` so marked.
/// The comments of leapWalk apply line by line.
bool walkVector(const FanStart& fan, const float* directionX, const float* directionY,
                const float* directionZ, std::int32_t* faces, float* parameters) {
    const Floats f;
    const VF dx = hn::LoadU(f, directionX);
    const VF dy = hn::LoadU(f, directionY);
    const VF dzWorld = hn::LoadU(f, directionZ);
    const Ints i;
    const Bits u;
    const TracedGrid& grid = fan.grid;
    const VF zero = hn::Zero(f);
    const VF one = hn::Set(f, 1.0f);
    const VI oneInt = hn::Set(i, 1);
    const VF error = hn::Set(f, leapError);

    const VF da = hn::Abs(dx);
    const VF db = hn::Abs(dy);
    const VF fastest = hn::Max(da, db);
    const VF dz = hn::Mul(dzWorld, hn::Set(f, static_cast<float>(grid.cellSize)));
    const MF west = hn::Lt(dx, zero);
    const MF south = hn::Lt(dy, zero);
    const MF sinks = hn::Lt(dz, zero);
    const VF fa = hn::IfThenElse(west, hn::Set(f, fan.fuMirrored), hn::Set(f, fan.fu));
    const VF fb = hn::IfThenElse(south, hn::Set(f, fan.fvMirrored), hn::Set(f, fan.fv));
    const VF negligible = hn::Mul(fastest, hn::Set(f, negligibleSlope));
    const MF crossesA = hn::Ge(da, negligible);
    const MF crossesB = hn::Ge(db, negligible);
    const VF never = hn::Set(f, 0x1p100f);
    const VF inverseA = hn::IfThenElse(crossesA, hn::Div(one, da), never);
    const VF inverseB = hn::IfThenElse(crossesB, hn::Div(one, db), never);
    const VF inverseMax =
        hn::Max(hn::IfThenElseZero(crossesA, inverseA), hn::IfThenElseZero(crossesB, inverseB));
    const VF inverseZ = hn::Div(one, dz);
    const VF oz = hn::Set(f, fan.origin.z);
    const VF lateral1 = hn::Mul(error, fastest);
    const VF lateral0 = hn::Add(hn::Mul(lateral1, inverseMax), hn::Set(f, 2 * leapError));
    const VF vertical1 = hn::Mul(error, hn::Abs(dz));
    const VF vertical0 = hn::Add(hn::Mul(vertical1, inverseMax),
                                 hn::Set(f, leapError * (std::abs(fan.origin.z) + grid.largest)));

    // NaN components fail these comparisons, whatever Max made of them.
    const VF roomA = hn::Min(fa, hn::Sub(one, fa));
    const VF roomB = hn::Min(fb, hn::Sub(one, fb));
    const VF clear = hn::Set(f, 4 * leapError);
    MF active = hn::And(hn::Ge(fastest, hn::Set(f, leapSlowest)), hn::Le(fastest, hn::Set(f, leapFastest)));
    active = hn::And(active, hn::And(hn::Le(da, fastest), hn::Le(db, fastest)));
    active = hn::And(active, hn::Le(hn::Abs(dz), hn::Set(f, leapHighest)));
    active = hn::And(active, hn::Or(crossesA, hn::Gt(roomA, clear)));
    active = hn::And(active, hn::Or(crossesB, hn::Gt(roomB, clear)));
    VF face = hn::IfThenElse(active, hn::Set(f, static_cast<float>(missed)),
                             hn::Set(f, static_cast<float>(undecided)));

    const auto cells = static_cast<std::int32_t>(grid.columns.size());
    const VI signA = hn::IfThenElse(hn::RebindMask(i, west), hn::Set(i, -1), oneInt);
    const VI signB = hn::IfThenElse(hn::RebindMask(i, south), hn::Set(i, -1), oneInt);
    const VI i0 = hn::Set(i, fan.i0);
    const VI j0 = hn::Set(i, fan.j0);
    const VI three = hn::Set(i, 3);
    const VI tileRow = hn::Set(i, static_cast<std::int32_t>(grid.tileRow));
    const auto indexOf = [&](VI passedA, VI passedB) {  // TracedGrid::index
        const VI x = hn::Add(i0, hn::Mul(signA, passedA));
        const VI y = hn::Add(j0, hn::Mul(signB, passedB));
        const VI inTile = hn::Sub(hn::And(y, three), hn::And(x, three));
        const VI row = hn::Mul(hn::ShiftRight<2>(y), tileRow);
        return hn::Add(hn::Add(row, hn::And(x, three)), hn::ShiftLeft<2>(hn::Add(x, inTile)));
    };
    const VI endA =
        hn::IfThenElse(hn::RebindMask(i, west), hn::Set(i, fan.i0 + 1), hn::Set(i, grid.width - fan.i0));
    const VI endB =
        hn::IfThenElse(hn::RebindMask(i, south), hn::Set(i, fan.j0 + 1), hn::Set(i, grid.height - fan.j0));
    const VI quadrant = hn::Add(hn::IfThenElseZero(hn::RebindMask(i, west), hn::Set(i, cells)),
                                hn::IfThenElseZero(hn::RebindMask(i, south), hn::Set(i, 2 * cells)));
    const VF levelBase = hn::Set(f, grid.open.base);
    const VF levelStep = hn::Set(f, grid.open.step);
    const VI lift = hn::Set(i, grid.open.lift);
    const VF top = hn::Set(f, grid.top);

    VI a = hn::Zero(i);
    VI b = hn::Zero(i);
    VF t = zero;
    VF lastFace = hn::Set(f, static_cast<float>(EntryFace::start));
    VF columnHit = zero;  // of the lanes that went through a top
    MF justSank = hn::Lt(one, zero);
    const auto settle = [&](MF which, int code) {
        face = hn::IfThenElse(which, hn::Set(f, static_cast<float>(code)), face);
        active = hn::AndNot(which, active);
    };

    const std::size_t fewLanes = hn::Lanes(f) / stragglerShare;
    // All rays start in one cell: four entries, one for each quadrant.
    const std::size_t startCell = grid.index(fan.i0, fan.j0);
    const auto startEntry = [&](std::size_t q) {
        return hn::Set(i, static_cast<std::int32_t>(grid.open.entries[q * grid.columns.size() + startCell]));
    };
    const MI westInt = hn::RebindMask(i, west);
    VI entry = hn::IfThenElse(hn::RebindMask(i, south), hn::IfThenElse(westInt, startEntry(3), startEntry(2)),
                              hn::IfThenElse(westInt, startEntry(1), startEntry(0)));
    for (;;) {  // inactive lanes come along and change nothing
        const VF z = hn::Add(oz, hn::Mul(t, dz));
        const VF vertical = hn::Add(vertical0, hn::Mul(vertical1, t));
        const VI own = hn::BitCast(i, hn::ShiftRight<16>(hn::BitCast(u, entry)));
        const VI lifts = hn::And(hn::ShiftRight<12>(entry), hn::Set(i, 15));
        const VI lifted = hn::Add(own, hn::Mul(hn::Mul(lifts, lifts), lift));
        VF level = hn::Add(levelBase, hn::Mul(hn::ConvertTo(f, lifted), levelStep));
        VI aheadA = hn::And(entry, hn::Set(i, 63));
        VI aheadB = hn::And(hn::ShiftRight<6>(entry), hn::Set(i, 63));
        const MF known = hn::RebindMask(f, hn::Gt(aheadA, hn::Zero(i)));
        MF leap = hn::And(hn::Gt(z, hn::Add(level, hn::Mul(hn::Set(f, 4.0f), vertical))), known);
        leap = hn::AndNot(justSank, leap);
        const VF ownHeight = hn::Add(levelBase, hn::Mul(hn::ConvertTo(f, own), levelStep));
        MF wall = hn::And(hn::Le(z, hn::Sub(hn::Sub(ownHeight, levelStep), vertical)), known);
        wall = hn::AndNot(justSank, hn::And(wall, active));
        face = hn::IfThenElse(wall, lastFace, face);
        active = hn::AndNot(wall, active);
        const MF single = hn::AndNot(leap, active);
        if (!hn::AllFalse(f, single)) {
            const VF column = hn::GatherIndex(f, grid.columns.data(), indexOf(a, b));
            columnHit = hn::IfThenElse(single, column, columnHit);
            level = hn::IfThenElse(leap, level, column);
            aheadA = hn::IfThenElse(hn::RebindMask(i, leap), aheadA, oneInt);
            aheadB = hn::IfThenElse(hn::RebindMask(i, leap), aheadB, oneInt);
            const MF fresh = hn::AndNot(justSank, single);
            const MF notAbove = hn::And(fresh, hn::Le(z, hn::Add(column, vertical)));
            if (!hn::AllFalse(f, notAbove)) {
                const MF inside = hn::And(notAbove, hn::Le(z, hn::Sub(column, vertical)));
                face = hn::IfThenElse(notAbove, hn::Set(f, static_cast<float>(undecided)), face);
                face = hn::IfThenElse(inside, lastFace, face);
                active = hn::AndNot(notAbove, active);
            }
        }
        const VI borderA = hn::Add(a, aheadA);
        const VI borderB = hn::Add(b, aheadB);
        const VF tA = hn::Mul(hn::Sub(hn::ConvertTo(f, borderA), fa), inverseA);
        const VF tB = hn::Mul(hn::Sub(hn::ConvertTo(f, borderB), fb), inverseB);
        const MF byA = hn::Lt(tA, tB);
        const VF tOut = hn::Min(tA, tB);
        const VF verticalOut = hn::Add(vertical0, hn::Mul(vertical1, tOut));
        const VF zOut = hn::Add(oz, hn::Mul(tOut, dz));
        const MF below = hn::And(hn::And(active, sinks), hn::Le(zOut, hn::Add(level, verticalOut)));
        const MF through = hn::AndNot(leap, below);
        if (!hn::AllFalse(f, through)) {
            const MF certain = hn::Le(zOut, hn::Sub(level, verticalOut));
            face = hn::IfThenElse(through, hn::Set(f, static_cast<float>(undecided)), face);
            face = hn::IfThenElse(hn::And(through, certain), hn::Set(f, static_cast<float>(EntryFace::top)),
                                  face);
            active = hn::AndNot(through, active);
        }
        const MF descends = hn::And(leap, below);
        const MF leaves = hn::AndNot(below, active);
        const VF tLevel = hn::Mul(hn::Sub(hn::Add(level, hn::Mul(hn::Set(f, 3.0f), vertical)), oz), inverseZ);
        const VF tNext = hn::IfThenElse(descends, tLevel, tOut);
        const VF pa = hn::Add(fa, hn::Mul(tNext, da));
        const VF pb = hn::Add(fb, hn::Mul(tNext, db));
        const VI ca = hn::ConvertTo(i, pa);
        const VI cb = hn::ConvertTo(i, pb);
        const VF ra = hn::Sub(pa, hn::ConvertTo(f, ca));
        const VF rb = hn::Sub(pb, hn::ConvertTo(f, cb));
        const VF lateral = hn::Add(lateral0, hn::Mul(lateral1, tNext));
        // Across the border that is being crossed the cell is known; only the other coordinate has to be
        // certain.
        const MF throughA = hn::And(leaves, byA);
        const MF throughB = hn::AndNot(byA, leaves);
        const VF nearA = hn::IfThenElse(throughA, one, hn::Min(ra, hn::Sub(one, ra)));
        const VF nearB = hn::IfThenElse(throughB, one, hn::Min(rb, hn::Sub(one, rb)));
        const VF room = hn::Sub(hn::Min(nearA, nearB), lateral);
        MF unclear = hn::Not(hn::Gt(room, zero));
        unclear = hn::Or(unclear, hn::Not(hn::Le(tNext, tOut)));
        settle(hn::And(active, unclear), undecided);
        const VI nextA = hn::IfThenElse(hn::RebindMask(i, throughA), borderA, ca);
        const VI nextB = hn::IfThenElse(hn::RebindMask(i, throughB), borderB, cb);
        const MF inside = hn::RebindMask(f, hn::And(hn::Lt(nextA, endA), hn::Lt(nextB, endB)));
        const MF above = hn::And(hn::AndNot(sinks, leaves), hn::Gt(hn::Sub(zOut, verticalOut), top));
        active = hn::And(active,
                         hn::AndNot(above, inside));  // the others have missed, as `face` says from the start

        a = hn::IfThenElse(hn::RebindMask(i, active), nextA, a);
        b = hn::IfThenElse(hn::RebindMask(i, active), nextB, b);
        const MF sank = hn::And(active, descends);
        if (!hn::AllFalse(f, sank)) {
            // Through the top of the cell below well before its border?
            const VF column = hn::GatherIndex(f, grid.columns.data(), indexOf(a, b));
            const VF gap = hn::Add(hn::Sub(level, column), hn::Mul(hn::Set(f, 4.0f), vertical));
            columnHit = hn::IfThenElse(sank, column, columnHit);
            const MF lands = hn::And(sank, hn::Lt(hn::Mul(gap, fastest), hn::Mul(room, hn::Neg(dz))));
            settle(lands, static_cast<int>(EntryFace::top));
        }
        t = tNext;
        lastFace = hn::IfThenElse(byA, hn::Set(f, static_cast<float>(EntryFace::x)),
                                  hn::Set(f, static_cast<float>(EntryFace::y)));
        justSank = descends;
        // Few rays need many steps: let the single walk finish them, not the whole vector.
        if (hn::CountTrue(f, active) <= fewLanes) {
            settle(active, undecided);
            break;
        }
        entry =
            hn::BitCast(i, hn::GatherIndex(u, grid.open.entries.data(), hn::Add(indexOf(a, b), quadrant)));
    }
    alignas(64) std::int32_t passedA[widest];
    alignas(64) std::int32_t passedB[widest];
    alignas(64) float columns[widest];
    hn::Store(a, i, passedA);
    hn::Store(b, i, passedB);
    hn::Store(columnHit, f, columns);
    hn::Store(hn::ConvertTo(i, face), i, faces);
    finish(fan, directionX, directionY, directionZ, faces, passedA, passedB, columns, parameters);
    return !hn::AllFalse(f, hn::Eq(face, hn::Set(f, static_cast<float>(undecided))));
}

void fan(const TracedGrid& grid, const glm::vec3& origin, const float* dx, const float* dy, const float* dz,
         std::size_t count, float* t) {
    const Floats f;
    const std::size_t lanes = hn::Lanes(f);
    FanStart start{grid, origin, grid.cellX(origin.x), grid.cellY(origin.y), 0, 0, 0, 0};
    const double fu = (static_cast<double>(origin.x) - grid.planeX(start.i0)) * grid.perCell;
    const double fv = (static_cast<double>(origin.y) - grid.planeY(start.j0)) * grid.perCell;
    start.fu = static_cast<float>(fu);
    start.fv = static_cast<float>(fv);
    start.fuMirrored = static_cast<float>(1 - fu);
    start.fvMirrored = static_cast<float>(1 - fv);
    alignas(64) float padded[3][widest];
    alignas(64) float parameters[widest];
    alignas(64) std::int32_t faces[widest];
    for (std::size_t first = 0; first < count; first += lanes) {
        const std::size_t used = std::min(lanes, count - first);
        const float* d[3] = {dx + first, dy + first, dz + first};
        if (used < lanes)
            for (int c = 0; c < 3; ++c) {
                for (std::size_t k = 0; k < lanes; ++k) padded[c][k] = d[c][std::min(k, used - 1)];
                d[c] = padded[c];
            }
        if (walkVector(start, d[0], d[1], d[2], faces, parameters))
            for (std::size_t k = 0; k < used; ++k)
                if (faces[k] == undecided)
                    parameters[k] = leapWalk(grid, {origin, {d[0][k], d[1][k], d[2][k]}},
                                             std::numeric_limits<float>::max())
                                        .t;
        std::copy_n(parameters, used, t + first);
    }
}

}  // namespace reflection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(fan);

void leapFan(const TracedGrid& grid, const glm::vec3& origin, std::span<const float> dx,
             std::span<const float> dy, std::span<const float> dz, std::span<float> t) {
    const bool ordinary = grid.leaps && std::abs(origin.z) <= leapHighest &&
                          static_cast<unsigned>(grid.cellX(origin.x)) < static_cast<unsigned>(grid.width) &&
                          static_cast<unsigned>(grid.cellY(origin.y)) < static_cast<unsigned>(grid.height);
    if (ordinary) {
        HWY_DYNAMIC_DISPATCH(fan)(grid, origin, dx.data(), dy.data(), dz.data(), t.size(), t.data());
        return;
    }
    for (std::size_t k = 0; k < t.size(); ++k) t[k] = exactAnswer(grid, {origin, {dx[k], dy[k], dz[k]}});
}

}  // namespace reflection
#endif
