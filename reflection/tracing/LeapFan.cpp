// The leaping walk (LeapWalk.h) for as many rays at a time as the processor's vectors hold. Compiled once for
// each instruction set; the widest one present is chosen at run time.
//
// Some rays end with their first leap, a few walk ten times as far: rays of one vector seldom end together.
// So the walk goes in waves. The first step of all rays is made vector by vector, as they come, and needs
// nothing from the large tables. What is then under way is packed into a list (a column for each variable),
// and the list is walked one step at a time, packed again behind the reader, until it is short. A wave first
// gathers what all its rays read from the tables, one value for each: a rectangle, or a column's height for
// those that have come down to their rectangle's level; so that the reads wait for each other as little as
// may be. Parameters are divided out at the end, in double, for all rays as they lie.
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

constexpr std::size_t widest = 16;          ///< lanes used at most
constexpr std::size_t largestBatch = 1024;  ///< rays walked together: their lists stay in the nearest caches
constexpr std::size_t stragglerShare = 6;   ///< of the lanes: when no more are busy, leapWalk is as fast

/// What all rays of the fan share.
struct FanStart {
    const TracedGrid& grid;
    glm::vec3 origin;
    int i0, j0;
    float fu, fv;                  ///< start within its cell
    float fuMirrored, fvMirrored;  ///< 1 - fu, 1 - fv, rounded from double
    std::int32_t entries[4];       ///< of the start's cell, by quadrant
};

/// How a ray ended, or came into its cell.
enum Way : std::int32_t { fromStart = 0, throughX = 1, throughY = 2, throughTop = 3, missed = 4 };

/// Marks of a ray under way, in its tag below its number.
constexpr std::int32_t wayMask = 3;  ///< how it came into its cell: fromStart, throughX or throughY
constexpr std::int32_t look = 4;     ///< its next step asks the column, not the rectangle
constexpr int markBits = 3;

/// One vector of rays under way.
struct Walkers {
    VF dx, dy, dz;
    VF t;
    VI a, b;  ///< cells passed
    VI tag;
    VI at;  ///< in TracedGrid::tables: what the next step reads
};

/// How a vector of rays fared in a step.
struct Outcome {
    MF underway;
    MF undecided;
    MF ended;
    VI way;   ///< of those ended
    VI what;  ///< the border, in cells of the grid, or the bits of the column's height
};

/// Takes each of the rays in `active` one leap or cell further, or marks it to look at its column. `entry` is
/// what it read: its cell's rectangle, or its column's height where the tag says so; in the first step
/// nothing is read.
template <bool first>
HWY_INLINE Outcome step(const FanStart& fan, Walkers& w, VI entry, MF active) {
    const Floats f;
    const Ints i;
    const Bits u;
    const TracedGrid& grid = fan.grid;
    const VF zero = hn::Zero(f);
    const VF one = hn::Set(f, 1.0f);
    const VI oneInt = hn::Set(i, 1);
    const VF error = hn::Set(f, leapError);

    const VF da = hn::Abs(w.dx);
    const VF db = hn::Abs(w.dy);
    const VF fastest = hn::Max(da, db);
    const VF dz = hn::Mul(w.dz, hn::Set(f, static_cast<float>(grid.cellSize)));
    const MF west = hn::Lt(w.dx, zero);
    const MF south = hn::Lt(w.dy, zero);
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
    const VF oz = hn::Set(f, fan.origin.z);
    const VF lateral1 = hn::Mul(error, fastest);
    const VF lateral0 = hn::MulAdd(lateral1, inverseMax, hn::Set(f, 2 * leapError));
    const VF vertical1 = hn::Mul(error, hn::Abs(dz));
    const VF vertical0 = hn::MulAdd(
        vertical1, inverseMax, hn::Set(f, leapError * (std::abs(fan.origin.z) + grid.largest) + leapTiny));

    MF undecided = hn::Lt(one, zero);
    if constexpr (first) {
        // NaN components fail these comparisons, whatever Max made of them.
        const VF roomA = hn::Min(fa, hn::Sub(one, fa));
        const VF roomB = hn::Min(fb, hn::Sub(one, fb));
        const VF clear = hn::Set(f, 4 * leapError);
        MF ordinary =
            hn::And(hn::Ge(fastest, hn::Set(f, leapSlowest)), hn::Le(fastest, hn::Set(f, leapFastest)));
        ordinary = hn::And(ordinary, hn::And(hn::Le(da, fastest), hn::Le(db, fastest)));
        ordinary = hn::And(ordinary, hn::Le(hn::Abs(dz), hn::Set(f, leapHighest)));
        ordinary = hn::And(ordinary, hn::Or(crossesA, hn::Gt(roomA, clear)));
        ordinary = hn::And(ordinary, hn::Or(crossesB, hn::Gt(roomB, clear)));
        undecided = hn::AndNot(ordinary, active);
        active = hn::And(ordinary, active);
    }

    const MI westInts = hn::RebindMask(i, west);
    const MI southInts = hn::RebindMask(i, south);
    const VI i0 = hn::Set(i, fan.i0);
    const VI j0 = hn::Set(i, fan.j0);
    MF looks = hn::Lt(one, zero);
    if constexpr (first) {
        const auto of = [&](int quadrant) { return hn::Set(i, fan.entries[quadrant]); };
        entry = hn::IfThenElse(southInts, hn::IfThenElse(westInts, of(3), of(2)),
                               hn::IfThenElse(westInts, of(1), of(0)));
    } else {
        looks = hn::And(active, hn::RebindMask(f, hn::Ne(hn::And(w.tag, hn::Set(i, look)), hn::Zero(i))));
    }
    const VF levelBase = hn::Set(f, grid.open.base);
    const VF levelStep = hn::Set(f, grid.open.step);
    const VF z = hn::MulAdd(w.t, dz, oz);
    const VF vertical = hn::MulAdd(vertical1, w.t, vertical0);
    const VI own = hn::BitCast(i, hn::ShiftRight<16>(hn::BitCast(u, entry)));
    const VI lifts = hn::And(hn::ShiftRight<12>(entry), hn::Set(i, 15));
    const VI lifted = hn::Add(own, hn::Mul(hn::Mul(lifts, lifts), hn::Set(i, grid.open.lift)));
    VF level = hn::Add(levelBase, hn::Mul(hn::ConvertTo(f, lifted), levelStep));
    const VF ownHeight = hn::Add(levelBase, hn::Mul(hn::ConvertTo(f, own), levelStep));
    VI aheadA = hn::And(entry, hn::Set(i, 63));
    VI aheadB = hn::And(hn::ShiftRight<6>(entry), hn::Set(i, 63));
    const MF known = hn::And(hn::AndNot(looks, active), hn::RebindMask(f, hn::Gt(aheadA, hn::Zero(i))));
    const MF leap = hn::And(known, hn::Gt(z, hn::MulAdd(hn::Set(f, 4.0f), vertical, level)));
    MF inWall = hn::And(known, hn::Le(z, hn::Sub(hn::Sub(ownHeight, levelStep), vertical)));
    MF stays = hn::AndNot(looks, hn::AndNot(hn::Or(leap, inWall), active));  // must ask the column
    MF moving = leap;
    if constexpr (!first) {
        level = hn::IfThenElse(looks, hn::BitCast(f, entry), level);
        aheadA = hn::IfThenElse(hn::RebindMask(i, looks), oneInt, aheadA);
        aheadB = hn::IfThenElse(hn::RebindMask(i, looks), oneInt, aheadB);
        const MF notAbove = hn::And(looks, hn::Le(z, hn::Add(level, vertical)));
        const MF inside = hn::And(notAbove, hn::Le(z, hn::Sub(level, vertical)));
        inWall = hn::Or(inWall, inside);
        undecided = hn::Or(undecided, hn::AndNot(inside, notAbove));
        moving = hn::Or(moving, hn::AndNot(notAbove, looks));
    }
    const VI borderA = hn::Add(w.a, aheadA);
    const VI borderB = hn::Add(w.b, aheadB);
    const VF tA = hn::Mul(hn::Sub(hn::ConvertTo(f, borderA), fa), inverseA);
    const VF tB = hn::Mul(hn::Sub(hn::ConvertTo(f, borderB), fb), inverseB);
    const MF byA = hn::Lt(tA, tB);
    const VF tOut = hn::Min(tA, tB);
    const VF verticalOut = hn::MulAdd(vertical1, tOut, vertical0);
    const VF zOut = hn::MulAdd(tOut, dz, oz);
    const MF sinks = hn::Lt(dz, zero);
    const MF below = hn::And(hn::And(moving, sinks), hn::Le(zOut, hn::Add(level, verticalOut)));
    const MF descends = hn::And(leap, below);
    const MF leaves = hn::AndNot(below, moving);
    MF hitTop = looks;
    if constexpr (!first) {
        const MF through = hn::And(looks, below);
        hitTop = hn::And(through, hn::Le(zOut, hn::Sub(level, verticalOut)));
        undecided = hn::Or(undecided, hn::AndNot(hitTop, through));
    }

    const VF tLevel = hn::Div(hn::Sub(hn::MulAdd(hn::Set(f, 3.0f), vertical, level), oz), dz);
    const VF tNext = hn::IfThenElse(descends, tLevel, tOut);
    const VF pa = hn::MulAdd(tNext, da, fa);
    const VF pb = hn::MulAdd(tNext, db, fb);
    const VI ca = hn::ConvertTo(i, pa);
    const VI cb = hn::ConvertTo(i, pb);
    const VF ra = hn::Sub(pa, hn::ConvertTo(f, ca));
    const VF rb = hn::Sub(pb, hn::ConvertTo(f, cb));
    const VF lateral = hn::MulAdd(lateral1, tNext, lateral0);
    // Across the border that is being crossed the cell is known; only the other coordinate has to be
    // certain.
    const MF acrossA = hn::And(leaves, byA);
    const MF acrossB = hn::AndNot(byA, leaves);
    const VF nearA = hn::IfThenElse(acrossA, one, hn::Min(ra, hn::Sub(one, ra)));
    const VF nearB = hn::IfThenElse(acrossB, one, hn::Min(rb, hn::Sub(one, rb)));
    const MF clear = hn::And(hn::Gt(hn::Min(nearA, nearB), lateral), hn::Le(tNext, tOut));
    const MF going = hn::Or(leaves, descends);
    undecided = hn::Or(undecided, hn::AndNot(clear, going));
    const MF sound = hn::And(going, clear);
    const VI nextA = hn::IfThenElse(hn::RebindMask(i, acrossA), borderA, ca);
    const VI nextB = hn::IfThenElse(hn::RebindMask(i, acrossB), borderB, cb);
    const VI endA = hn::IfThenElse(westInts, hn::Set(i, fan.i0 + 1), hn::Set(i, grid.width - fan.i0));
    const VI endB = hn::IfThenElse(southInts, hn::Set(i, fan.j0 + 1), hn::Set(i, grid.height - fan.j0));
    const MF inGrid = hn::RebindMask(f, hn::And(hn::Lt(nextA, endA), hn::Lt(nextB, endB)));
    const MF above = hn::AndNot(sinks, hn::Gt(hn::Sub(zOut, verticalOut), hn::Set(f, grid.top)));
    const MF misses = hn::And(hn::And(sound, leaves), hn::Or(above, hn::Not(inGrid)));
    const MF moved = hn::AndNot(misses, sound);

    Outcome outcome;
    outcome.underway = hn::Or(stays, moved);
    outcome.undecided = undecided;
    outcome.ended = hn::Or(hn::Or(inWall, hitTop), misses);
    // The border crossed last: the start's own and as many onwards as cells were passed.
    const VI came = hn::And(w.tag, hn::Set(i, wayMask));
    const MI cameByY = hn::Eq(came, hn::Set(i, throughY));
    const VI passed = hn::IfThenElse(cameByY, w.b, w.a);
    const VI from = hn::IfThenElse(cameByY, j0, i0);
    const MI back = hn::Or(hn::And(cameByY, southInts), hn::AndNot(cameByY, westInts));
    outcome.what = hn::IfThenElse(back, hn::Sub(hn::Add(from, oneInt), passed), hn::Add(from, passed));
    outcome.what = hn::IfThenElse(hn::RebindMask(i, hitTop), entry, outcome.what);
    outcome.way = hn::IfThenElse(hn::RebindMask(i, hitTop), hn::Set(i, throughTop), came);
    outcome.way = hn::IfThenElse(hn::RebindMask(i, misses), hn::Set(i, missed), outcome.way);

    const MI movedInts = hn::RebindMask(i, moved);
    w.a = hn::IfThenElse(movedInts, nextA, w.a);
    w.b = hn::IfThenElse(movedInts, nextB, w.b);
    w.t = hn::IfThenElse(moved, tNext, w.t);
    const VI number = hn::ShiftLeft<markBits>(hn::ShiftRight<markBits>(w.tag));
    const VI crossed = hn::IfThenElse(hn::RebindMask(i, byA), hn::Set(i, throughX), hn::Set(i, throughY));
    const VI marks = hn::IfThenElse(hn::RebindMask(i, descends), hn::Set(i, look | throughX), crossed);
    w.tag = hn::IfThenElse(movedInts, hn::Or(number, marks), hn::Or(w.tag, hn::Set(i, look)));
    // TracedGrid::index
    const VI x = hn::IfThenElse(westInts, hn::Sub(i0, w.a), hn::Add(i0, w.a));
    const VI y = hn::IfThenElse(southInts, hn::Sub(j0, w.b), hn::Add(j0, w.b));
    const VI row = hn::Mul(hn::ShiftRight<2>(y), hn::Set(i, static_cast<std::int32_t>(grid.tileRow)));
    const VI index = hn::Add(hn::Add(row, hn::And(y, hn::Set(i, 3))), hn::ShiftLeft<2>(x));
    const auto cells = static_cast<std::int32_t>(grid.cells);
    const VI quadrant = hn::Add(hn::IfThenElse(westInts, hn::Set(i, 2 * cells), hn::Set(i, cells)),
                                hn::IfThenElseZero(southInts, hn::Set(i, 2 * cells)));
    const MI looksNext = hn::Or(hn::RebindMask(i, stays), hn::RebindMask(i, descends));
    w.at = hn::IfThenElse(looksNext, index, hn::Add(index, quadrant));
    return outcome;
}

/// Up to largestBatch rays of the fan on their way.
class Batch {
  public:
    Batch(const FanStart& start, const float* dx, const float* dy, const float* dz, float* t)
        : fan_(start), dx_(dx), dy_(dy), dz_(dz), t_(t) {}

    void walk(std::size_t count) {
        const std::size_t lanes = hn::Lanes(Floats());
        for (std::size_t first = 0; first < count; first += lanes)
            begin(first, std::min(lanes, count - first));
        while (underway_ > lanes / stragglerShare) wave();
        for (std::size_t k = 0; k < underway_; ++k) alone_[aloneCount_++] = tagAt_[k];
        for (std::size_t k = 0; k < endedCount_; ++k) {
            const std::int32_t number = endedTag_[k] >> markBits;
            way_[number] = endedWay_[k];
            what_[number] = endedWhat_[k];
        }
        const std::size_t doubles = hn::Lanes(hn::ScalableTag<double>());
        for (std::size_t first = 0; first < count; first += doubles) {
            if (count - first >= doubles) {
                finish(dx_ + first, dy_ + first, dz_ + first, first, t_ + first);
                continue;
            }
            float padded[4][widest];
            const float* d[3] = {dx_, dy_, dz_};
            for (int c = 0; c < 3; ++c) {
                std::fill_n(padded[c], widest, 1.0f);
                std::copy_n(d[c] + first, count - first, padded[c]);
            }
            finish(padded[0], padded[1], padded[2], first, padded[3]);
            std::copy_n(padded[3], count - first, t_ + first);
        }
        for (std::size_t k = 0; k < aloneCount_; ++k) {
            const std::int32_t n = alone_[k] >> markBits;
            t_[n] = leapWalk(fan_.grid, {fan_.origin, {dx_[n], dy_[n], dz_[n]}},
                             std::numeric_limits<float>::max())
                        .t;
        }
    }

  private:
    static constexpr std::size_t room = largestBatch + widest;

    /// The first step of up to a vector of rays.
    HWY_INLINE void begin(std::size_t first, std::size_t used) {
        const Floats f;
        const Ints i;
        const std::size_t lanes = hn::Lanes(f);
        alignas(64) float padded[3][widest];
        const float* d[3] = {dx_ + first, dy_ + first, dz_ + first};
        if (used < lanes)
            for (int c = 0; c < 3; ++c) {
                std::fill_n(padded[c], widest, 1.0f);
                std::copy_n(d[c], used, padded[c]);
                d[c] = padded[c];
            }
        const VI number = hn::Add(hn::Iota(i, 0), hn::Set(i, static_cast<std::int32_t>(first)));
        Walkers w{hn::LoadU(f, d[0]),
                  hn::LoadU(f, d[1]),
                  hn::LoadU(f, d[2]),
                  hn::Zero(f),
                  hn::Zero(i),
                  hn::Zero(i),
                  hn::ShiftLeft<markBits>(number),
                  hn::Zero(i)};
        const Outcome outcome = step<true>(fan_, w, hn::Zero(i), hn::FirstN(f, used));
        hn::StoreU(outcome.way, i, way_ + first);
        hn::StoreU(outcome.what, i, what_ + first);
        leave(w, outcome);
    }

    /// One step of every ray under way.
    void wave() {
        const Floats f;
        const Ints i;
        const Bits u;
        const std::size_t count = underway_;
        underway_ = 0;
        // All that is read from the large tables first: nothing waits for a single one.
        for (std::size_t first = 0; first < count; first += hn::Lanes(f)) {
            const VI at = hn::IfThenElseZero(hn::RebindMask(i, hn::FirstN(f, count - first)),
                                             hn::Load(i, atAt_ + first));
            hn::Store(hn::GatherIndex(u, fan_.grid.tables.data(), at), u, entryAt_ + first);
        }
        for (std::size_t first = 0; first < count; first += hn::Lanes(f)) {
            const MF present = hn::FirstN(f, count - first);
            Walkers w{hn::Load(f, dxAt_ + first),  hn::Load(f, dyAt_ + first),
                      hn::Load(f, dzAt_ + first),  hn::Load(f, tAt_ + first),
                      hn::Load(i, aAt_ + first),   hn::Load(i, bAt_ + first),
                      hn::Load(i, tagAt_ + first), hn::Zero(i)};
            const Outcome outcome =
                step<false>(fan_, w, hn::BitCast(i, hn::Load(u, entryAt_ + first)), present);
            const MI ended = hn::RebindMask(i, outcome.ended);
            hn::StoreU(hn::Compress(w.tag, ended), i, endedTag_ + endedCount_);
            hn::StoreU(hn::Compress(outcome.way, ended), i, endedWay_ + endedCount_);
            hn::StoreU(hn::Compress(outcome.what, ended), i, endedWhat_ + endedCount_);
            endedCount_ += hn::CountTrue(i, ended);
            leave(w, outcome);
        }
    }

    /// Packs what is not finished behind what is packed already. Overwrites a vector from there on.
    HWY_INLINE void leave(const Walkers& w, const Outcome& outcome) {
        const Floats f;
        const Ints i;
        const MF go = outcome.underway;
        const MI goInts = hn::RebindMask(i, go);
        hn::StoreU(hn::Compress(w.dx, go), f, dxAt_ + underway_);
        hn::StoreU(hn::Compress(w.dy, go), f, dyAt_ + underway_);
        hn::StoreU(hn::Compress(w.dz, go), f, dzAt_ + underway_);
        hn::StoreU(hn::Compress(w.t, go), f, tAt_ + underway_);
        hn::StoreU(hn::Compress(w.a, goInts), i, aAt_ + underway_);
        hn::StoreU(hn::Compress(w.b, goInts), i, bAt_ + underway_);
        hn::StoreU(hn::Compress(w.tag, goInts), i, tagAt_ + underway_);
        hn::StoreU(hn::Compress(w.at, goInts), i, atAt_ + underway_);
        underway_ += hn::CountTrue(f, go);
        if (hn::AllFalse(f, outcome.undecided)) return;
        hn::StoreU(hn::Compress(w.tag, hn::RebindMask(i, outcome.undecided)), i, alone_ + aloneCount_);
        aloneCount_ += hn::CountTrue(f, outcome.undecided);
    }

    /// entryParameter for the rays of one vector of doubles that have ended, +infinity for those that missed.
    HWY_INLINE void finish(const float* dx, const float* dy, const float* dz, std::size_t first,
                           float* t) const {
        const hn::ScalableTag<double> d;
        const hn::Rebind<float, decltype(d)> f;
        const hn::Rebind<std::int32_t, decltype(d)> i;
        const TracedGrid& grid = fan_.grid;
        const auto way = hn::LoadU(i, way_ + first);
        const auto what = hn::LoadU(i, what_ + first);
        const auto is = [&](Way one) { return hn::RebindMask(f, hn::Eq(way, hn::Set(i, one))); };
        auto speed = hn::IfThenElse(is(throughY), hn::LoadU(f, dy), hn::LoadU(f, dx));
        speed = hn::IfThenElse(is(throughTop), hn::LoadU(f, dz), speed);
        const auto steps = hn::Mul(hn::PromoteTo(d, what), hn::Set(d, grid.cellSize));
        const auto column = hn::PromoteTo(d, hn::BitCast(f, what));
        const auto wide = hn::PromoteTo(d, way);
        const auto isWide = [&](Way one) { return hn::Eq(wide, hn::Set(d, static_cast<double>(one))); };
        const auto origin = [&](int c) { return hn::Set(d, static_cast<double>(fan_.origin[c])); };
        auto length = hn::Sub(hn::Add(hn::Set(d, grid.origin.x), steps), origin(0));
        length = hn::IfThenElse(isWide(throughY),
                                hn::Sub(hn::Add(hn::Set(d, grid.origin.y), steps), origin(1)), length);
        length = hn::IfThenElse(isWide(throughTop), hn::Sub(column, origin(2)), length);
        const auto quotient = hn::Add(hn::Div(length, hn::PromoteTo(d, speed)), hn::Zero(d));
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
        // Highway's emulation would turn infinity into the largest float.
        float narrow[widest];
        alignas(64) double all[widest];
        hn::Store(quotient, d, all);
        for (std::size_t n = 0; n < hn::Lanes(d); ++n) narrow[n] = static_cast<float>(all[n]);
        auto result = hn::LoadU(f, narrow);
#else
        auto result = hn::DemoteTo(f, quotient);
#endif
        result = hn::IfThenElse(is(fromStart), hn::Zero(f), result);
        result = hn::IfThenElse(is(missed), hn::Set(f, std::numeric_limits<float>::infinity()), result);
        hn::StoreU(result, f, t);
    }

    const FanStart& fan_;
    const float* dx_;
    const float* dy_;
    const float* dz_;
    float* t_;

    std::size_t underway_ = 0;
    std::size_t endedCount_ = 0;
    std::size_t aloneCount_ = 0;
    /// Rays under way, packed.
    alignas(64) float dxAt_[room], dyAt_[room], dzAt_[room], tAt_[room];
    alignas(64) std::int32_t aAt_[room], bAt_[room], tagAt_[room], atAt_[room];
    alignas(64) std::uint32_t entryAt_[room];
    /// Rays that ended in a wave, in the order in which they did.
    alignas(64) std::int32_t endedTag_[room], endedWay_[room], endedWhat_[room];
    /// Rays that the vectors leave to leapWalk.
    alignas(64) std::int32_t alone_[room];
    /// By number.
    alignas(64) std::int32_t way_[room], what_[room];
};

void fan(const TracedGrid& grid, const glm::vec3& origin, const float* dx, const float* dy, const float* dz,
         std::size_t count, float* t) {
    FanStart start{grid, origin, grid.cellX(origin.x), grid.cellY(origin.y), 0, 0, 0, 0, {}};
    const double fu = (static_cast<double>(origin.x) - grid.planeX(start.i0)) * grid.perCell;
    const double fv = (static_cast<double>(origin.y) - grid.planeY(start.j0)) * grid.perCell;
    start.fu = static_cast<float>(fu);
    start.fv = static_cast<float>(fv);
    start.fuMirrored = static_cast<float>(1 - fu);
    start.fvMirrored = static_cast<float>(1 - fv);
    for (std::size_t q = 0; q < 4; ++q)
        start.entries[q] =
            static_cast<std::int32_t>(grid.tables[grid.entriesOf(q) + grid.index(start.i0, start.j0)]);
    for (std::size_t first = 0; first < count; first += largestBatch) {
        Batch batch(start, dx + first, dy + first, dz + first, t + first);
        batch.walk(std::min(largestBatch, count - first));
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
    for (std::size_t k = 0; k < t.size(); ++k)
        t[k] = leapWalk(grid, {origin, {dx[k], dy[k], dz[k]}}, std::numeric_limits<float>::max()).t;
}

}  // namespace reflection
#endif
