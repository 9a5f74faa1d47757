// Compiled once for each instruction set; the widest one present is chosen at run time.
#include "reflection/tracing/BestRectangles.h"

#include <algorithm>

// Vectors without a fixed size cannot be members; processors with SVE have NEON too.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/tracing/BestRectangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace reflection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Ints = hn::ScalableTag<std::int32_t>;
using Floats = hn::RebindToFloat<Ints>;
using Bytes = hn::Rebind<std::uint8_t, Ints>;
using Shorts = hn::Rebind<std::uint16_t, Ints>;
using VI = hn::Vec<Ints>;
using VF = hn::Vec<Floats>;
using MF = hn::Mask<Floats>;

/// Rectangles cornered in neighbouring cells. Sizes are floats: their products of three stay below 2^24,
/// exact.
struct Rectangles {
    VF width;
    VF height;
    VI level;
};

/// On bumpy ground (pitched roofs, crowns of trees) rectangles of the narrow band shrink to a few cells.
/// There a wider band serves better, for the rays that pass well above. It is taken where its leaps are more
/// than this many times as long.
constexpr float worthWidening = 2;
constexpr float small = 8;  ///< cells; larger rectangles are left as they are

/// Of all rectangles in the staircase of runs, the one with the longest leap averaged over directions: w h /
/// (w + h) ranks them nearly as the integral of min(w / cos, h / sin) does.
HWY_INLINE Rectangles bestOf(const RectangleSource& source, const Runs& runs, int j, int first, VI levels) {
    const Ints i;
    const Floats f;
    const int rows = std::min(OpenRectangles::longest, source.stepY > 0 ? source.height - j : j + 1);
    const VF allRows = hn::Set(f, static_cast<float>(rows));
    const VF one = hn::Set(f, 1.0f);
    const VI limit = hn::Add(levels, hn::Set(i, runs.band));
    VI narrowest = hn::Set(i, OpenRectangles::longest);
    VI highest = levels;
    Rectangles best{one, one, levels};
    MF searching = hn::Ge(one, one);
    for (int k = 1; k <= rows; ++k) {
        const int row = j + source.stepY * (k - 1);
        const VI level = hn::PromoteTo(i, hn::LoadU(Shorts(), source.levels.row(row) + first));
        const VI top = hn::PromoteTo(i, hn::LoadU(Shorts(), runs.highest.row(row) + first));
        const VI length = hn::PromoteTo(i, hn::LoadU(Bytes(), runs.length.row(row) + first));
        const auto ends = hn::Or(hn::Gt(level, limit), hn::Gt(top, hn::Set(i, highestLevel)));
        searching = hn::AndNot(hn::RebindMask(f, ends), searching);
        narrowest = hn::Min(narrowest, length);
        highest = hn::Max(highest, top);
        const VF width = hn::ConvertTo(f, narrowest);
        const VF height = hn::Set(f, static_cast<float>(k));
        const VF area = hn::Mul(best.width, best.height);
        const VF sum = hn::Add(best.width, best.height);
        const MF longer = hn::And(
            searching, hn::Gt(hn::Mul(hn::Mul(width, height), sum), hn::Mul(area, hn::Add(width, height))));
        // Even with all rows left, nothing this narrow can win any more.
        const VF newArea = hn::IfThenElse(longer, hn::Mul(width, height), area);
        const VF newSum = hn::IfThenElse(longer, hn::Add(width, height), sum);
        const MF hopeful =
            hn::Gt(hn::Mul(hn::Mul(width, allRows), newSum), hn::Mul(newArea, hn::Add(width, allRows)));
        best.width = hn::IfThenElse(longer, width, best.width);
        best.height = hn::IfThenElse(longer, height, best.height);
        best.level = hn::IfThenElse(hn::RebindMask(i, longer), highest, best.level);
        searching = hn::And(searching, hopeful);
        if (hn::AllFalse(f, searching)) break;
    }
    return best;
}

void rowOfRectangles(const RectangleSource& source, int j, OpenRectangles::Entry* entries) {
    const Ints i;
    const Floats f;
    const hn::RebindToUnsigned<Ints> u;
    const VI one = hn::Set(i, 1);
    for (int first = 0; first < source.levels.width; first += static_cast<int>(hn::Lanes(i))) {
        const VI levels = hn::PromoteTo(i, hn::LoadU(Shorts(), source.levels.row(j) + first));
        Rectangles best = bestOf(source, source.runs, j, first, levels);
        const MF cramped = hn::Lt(hn::Min(best.width, best.height), hn::Set(f, small));
        if (!hn::AllFalse(f, cramped)) {
            const Rectangles wider = bestOf(source, source.wideRuns, j, first, levels);
            const VF gain = hn::Mul(hn::Mul(wider.width, wider.height), hn::Add(best.width, best.height));
            const VF worth = hn::Mul(hn::Mul(hn::Set(f, worthWidening), hn::Mul(best.width, best.height)),
                                     hn::Add(wider.width, wider.height));
            const MF widen = hn::And(cramped, hn::Gt(gain, worth));
            best.width = hn::IfThenElse(widen, wider.width, best.width);
            best.height = hn::IfThenElse(widen, wider.height, best.height);
            best.level = hn::IfThenElse(hn::RebindMask(i, widen), wider.level, best.level);
        }
        VI lifts = hn::Zero(i);
        for (;;) {
            const VI lifted = hn::Add(levels, hn::Mul(hn::Mul(lifts, lifts), hn::Set(i, source.lift)));
            const auto tooLow = hn::Lt(lifted, best.level);
            if (hn::AllFalse(i, tooLow)) break;
            lifts = hn::Add(lifts, hn::IfThenElseZero(tooLow, one));
        }
        VI entry = hn::Or(hn::ConvertTo(i, best.width), hn::ShiftLeft<6>(hn::ConvertTo(i, best.height)));
        entry = hn::Or(entry, hn::Or(hn::ShiftLeft<12>(lifts), hn::ShiftLeft<16>(levels)));
        entry = hn::IfThenElse(hn::Eq(levels, hn::Set(i, endlessLevel)), hn::Zero(i), entry);
        hn::StoreU(hn::BitCast(u, entry), u, entries + first);
    }
}

}  // namespace reflection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(rowOfRectangles);

void findRowOfRectangles(const RectangleSource& source, int j, OpenRectangles::Entry* entries) {
    HWY_DYNAMIC_DISPATCH(rowOfRectangles)(source, j, entries);
}

}  // namespace reflection
#endif
