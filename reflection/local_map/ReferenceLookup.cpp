// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/local_map/ReferenceLookup.cpp"
#include <hwy/foreach_target.h>

#include "reflection/local_map/ReferenceLookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "reflection/local_map/DetailOrder.h"
#include "reflection/local_map/PackedProbe-inl.h"
#include "reflection/reference_maps/CubeMapping.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// More than this many candidates are not asked.
constexpr std::size_t mostCandidates = 16;

MapView viewOf(const Candidate& c, int localFaceSize) {
    const PackedReferenceMap::Level& level = c.map->levelFor(localFaceSize);
    return {level.words(),          level.chroma(), level.faceSize(), level.chromaColumns(),
            c.map->radianceScale(), c.offset.x,     c.offset.y,       c.offset.z};
}

/// The map's answer for the point t d of a ray.
HWY_INLINE Probe probeAlong(const MapView& map, VF dx, VF dy, VF dz, VF t) {
    const Float d;
    return probe(map, hn::Sub(hn::Mul(t, dx), hn::Set(d, map.ox)),
                 hn::Sub(hn::Mul(t, dy), hn::Set(d, map.oy)), hn::Sub(hn::Mul(t, dz), hn::Set(d, map.oz)));
}

/// Neighbours share one order of candidates: that of the middle of so many texels of a row.
constexpr int orderBlock = 16;

struct Rays {
    VF x, y, z;  ///< directions
    VF squared;  ///< of their lengths
};

/// What one map has to say of rays.
struct Answer {
    VF error;  ///< greatest where it does not see them
    VF depth, sum;
    VI chromaBlock;
};

/// Moves the hit along the rays until the map's own distance agrees, the lookups are used up, or all rays are
/// `settled` already.
HWY_INLINE Answer askMap(const MapView& map, const Rays& rays, VF start, MF settled,
                         const LookupOptions& options) {
    const Float d;
    const Int di;
    const VF one = hn::Set(d, 1.0f);
    const VF sky = hn::Set(d, PackedReferenceMap::skyDepth);
    const VF agreement = hn::Set(d, options.agreement);
    // The candidate's own surface is where it is, however far the start; a secant may overshoot.
    const VF boldest = hn::Set(d, 0.25f);
    const Probe first = probeAlong(map, rays.x, rays.y, rays.z, start);
    Answer answer{hn::Abs(first.disagreement), start, first.sum, first.chromaBlock};

    // The candidate's surface point C + (X - C) / (1 + q), projected onto the ray: its ray parameter is
    // (d.C + (t d.d - d.C) / (1 + q)) / d.d.
    const VF centre = hn::MulAdd(rays.x, hn::Set(d, map.ox),
                                 hn::MulAdd(rays.y, hn::Set(d, map.oy), hn::Mul(rays.z, hn::Set(d, map.oz))));
    const VF shrink = hn::Div(one, hn::Max(hn::Add(first.disagreement, one), hn::Set(d, 1e-4f)));
    const VF projected =
        hn::Div(hn::MulAdd(hn::Sub(hn::Mul(start, rays.squared), centre), shrink, centre), rays.squared);
    VF ta = start, qa = first.disagreement;
    VF tb = hn::Min(hn::IfThenElse(hn::Gt(projected, hn::Zero(d)), projected, hn::Mul(start, boldest)), sky);
    for (int lookup = 1; lookup < options.lookups; ++lookup) {
        const MF pending = hn::AndNot(settled, hn::Gt(answer.error, agreement));
        if (hn::AllFalse(d, pending)) break;
        const Probe next = probeAlong(map, rays.x, rays.y, rays.z, tb);
        const VF qb = next.disagreement;
        const MF better = hn::And(pending, hn::Lt(hn::Abs(qb), answer.error));
        answer.error = hn::IfThenElse(better, hn::Abs(qb), answer.error);
        answer.depth = hn::IfThenElse(better, tb, answer.depth);
        answer.sum = hn::IfThenElse(better, next.sum, answer.sum);
        answer.chromaBlock = hn::IfThenElse(hn::RebindMask(di, better), next.chromaBlock, answer.chromaBlock);
        const VF slope = hn::Sub(qb, qa);
        const MF flat = hn::Lt(hn::Abs(slope), hn::Set(d, 1e-6f));
        const VF secant =
            hn::Sub(tb, hn::Div(hn::Mul(qb, hn::Sub(tb, ta)), hn::IfThenElse(flat, one, slope)));
        ta = tb;
        qa = qb;
        tb = hn::Max(hn::Min(hn::IfThenElse(flat, tb, secant), sky), hn::Mul(tb, boldest));
    }
    return answer;
}

/// A part of a row of texels, as long as a vector or shorter.
struct RowPart {
    std::size_t first, count;

    HWY_INLINE VF load(const float* plane) const {
        const Float d;
        if (count == hn::Lanes(d)) return hn::LoadU(d, plane + first);
        HWY_ALIGN float padded[HWY_MAX_BYTES / sizeof(float)];
        std::copy_n(plane + first, count, padded);
        std::fill(padded + count, padded + hn::Lanes(d), padded[count - 1]);
        return hn::Load(d, padded);
    }
    HWY_INLINE void store(VF value, float* plane) const {
        const Float d;
        if (count == hn::Lanes(d)) {
            hn::StoreU(value, d, plane + first);
            return;
        }
        HWY_ALIGN float padded[HWY_MAX_BYTES / sizeof(float)];
        hn::Store(value, d, padded);
        std::copy_n(padded, count, plane + first);
    }
};

void LookUpRefined(int face, const float* reciprocal, std::span<const Candidate> candidates,
                   const LookupOptions& options, LocalMap& out) {
    const Float d;
    const int n = out.faceSize;
    const int lanes = static_cast<int>(std::min<std::size_t>(hn::Lanes(d), orderBlock));
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    const std::size_t base = out.faceOffset(face);
    const float texelSize = 2.0f / static_cast<float>(n);
    const VF sky = hn::Set(d, PackedReferenceMap::skyDepth);
    const VF nothing = hn::Set(d, 1.0f / PackedReferenceMap::skyDepth);
    const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const VF agreement = hn::Set(d, options.agreement);
    const VF one = hn::Set(d, 1.0f);
    candidates = candidates.first(std::min<std::size_t>(candidates.size(), mostCandidates));
    std::array<MapView, mostCandidates> views;
    std::array<std::uint8_t, mostCandidates> order;
    for (std::size_t k = 0; k < candidates.size(); ++k) views[k] = viewOf(candidates[k], n);
    HWY_ALIGN float columns[HWY_MAX_BYTES / sizeof(float)];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) columns[lane] = static_cast<float>(lane) + 0.5f;

    for (int y = 0; y < n; ++y) {
        const float t = (static_cast<float>(y) + 0.5f) * texelSize - 1;
        int ordered = -1;
        for (int x = 0; x < n; x += lanes) {
            const RowPart inFace{static_cast<std::size_t>(y * n + x),
                                 static_cast<std::size_t>(std::min(lanes, n - x))};
            const RowPart part{base + inFace.first, inFace.count};
            const VF nearness = inFace.load(reciprocal);
            const MF open = hn::Le(nearness, nothing);
            if (options.sky && hn::AllTrue(d, open)) {
                part.store(part.load(options.sky->red.data()), out.red.data());
                part.store(part.load(options.sky->green.data()), out.green.data());
                part.store(part.load(options.sky->blue.data()), out.blue.data());
                part.store(infinity, out.depth.data());
                continue;
            }
            if (x / orderBlock != ordered) {
                ordered = x / orderBlock;
                const int middle = std::min(ordered * orderBlock + orderBlock / 2, n - 1);
                orderByDetail(candidates, patchAround(f, reciprocal, n, middle, y),
                              std::span(order).first(candidates.size()));
            }

            const VF s = hn::MulAdd(hn::Add(hn::Load(d, columns), hn::Set(d, static_cast<float>(x))),
                                    hn::Set(d, texelSize), hn::Set(d, -1.0f));
            const auto along = [&](float major, float sAxis, float tAxis) {
                return hn::MulAdd(s, hn::Set(d, sAxis), hn::Set(d, major + t * tAxis));
            };
            Rays rays{along(f.major.x, f.sAxis.x, f.tAxis.x), along(f.major.y, f.sAxis.y, f.tAxis.y),
                      along(f.major.z, f.sAxis.z, f.tAxis.z), one};
            rays.squared = hn::MulAdd(rays.x, rays.x, hn::MulAdd(rays.y, rays.y, hn::Mul(rays.z, rays.z)));
            const VF start = hn::Min(hn::Div(one, hn::Max(nearness, nothing)), sky);

            MF settled = options.sky ? open : hn::Lt(one, one);
            Colour colour{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            if (options.sky)
                colour = {part.load(options.sky->red.data()), part.load(options.sky->green.data()),
                          part.load(options.sky->blue.data())};
            VF error = infinity, depth = start;
            for (std::size_t k = 0; k < candidates.size() && !hn::AllTrue(d, settled); ++k) {
                const MapView& map = views[order[k]];
                const Answer answer = askMap(map, rays, start, settled, options);
                const MF improves = hn::AndNot(settled, hn::Lt(answer.error, error));
                const Colour c = colourOf(map, answer.sum, answer.chromaBlock);
                colour.red = hn::IfThenElse(improves, c.red, colour.red);
                colour.green = hn::IfThenElse(improves, c.green, colour.green);
                colour.blue = hn::IfThenElse(improves, c.blue, colour.blue);
                error = hn::IfThenElse(improves, answer.error, error);
                depth = hn::IfThenElse(improves, answer.depth, depth);
                settled = hn::Or(settled, hn::Le(error, agreement));
            }
            // Between the farthest building and the sky there is nothing: halfway decides.
            depth = hn::IfThenElse(hn::Ge(depth, hn::Set(d, 0.5f * PackedReferenceMap::skyDepth)), infinity,
                                   depth);
            part.store(colour.red, out.red.data());
            part.store(colour.green, out.green.data());
            part.store(colour.blue, out.blue.data());
            part.store(depth, out.depth.data());
        }
    }
}

void LookUpBlended(int face, const float* px, const float* py, const float* pz, const float* weightA,
                   const Candidate& a, const Candidate& b, LocalMap& out) {
    const Float d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t texels =
        static_cast<std::size_t>(out.faceSize) * static_cast<std::size_t>(out.faceSize);
    const std::size_t base = out.faceOffset(face);
    const MapView mapA = viewOf(a, out.faceSize), mapB = viewOf(b, out.faceSize);
    for (std::size_t first = 0; first < texels; first += lanes) {
        const std::size_t count = std::min(lanes, texels - first);
        HWY_ALIGN float rest[4][HWY_MAX_BYTES / sizeof(float)] = {};
        const auto load = [&](const float* from, int slot) {
            if (count == lanes) return hn::LoadU(d, from + first);
            std::fill_n(rest[slot], lanes, 1.0f);
            std::copy_n(from + first, count, rest[slot]);
            return hn::Load(d, rest[slot]);
        };
        const VF x = load(px, 0), y = load(py, 1), z = load(pz, 2), w = load(weightA, 3);
        const auto at = [&](const MapView& map) {
            const Probe p = probe(map, hn::Sub(x, hn::Set(d, map.ox)), hn::Sub(y, hn::Set(d, map.oy)),
                                  hn::Sub(z, hn::Set(d, map.oz)));
            return colourOf(map, p.sum, p.chromaBlock);
        };
        const Colour ca = at(mapA), cb = at(mapB);
        const auto store = [&](VF va, VF vb, std::vector<float>& plane) {
            const VF value = hn::MulAdd(w, hn::Sub(va, vb), vb);
            HWY_ALIGN float lane[HWY_MAX_BYTES / sizeof(float)];
            hn::Store(value, d, lane);
            std::copy_n(lane, count, plane.data() + base + first);
        };
        store(ca.red, cb.red, out.red);
        store(ca.green, cb.green, out.green);
        store(ca.blue, cb.blue, out.blue);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(LookUpRefined);
HWY_EXPORT(LookUpBlended);

void lookUpRefined(int face, std::span<const float> reciprocal, std::span<const Candidate> candidates,
                   const LookupOptions& options, LocalMap& map) {
    HWY_DYNAMIC_DISPATCH(LookUpRefined)(face, reciprocal.data(), candidates, options, map);
}

void lookUpBlended(int face, std::span<const float> px, std::span<const float> py, std::span<const float> pz,
                   std::span<const float> weightA, const Candidate& a, const Candidate& b, LocalMap& map) {
    HWY_DYNAMIC_DISPATCH(LookUpBlended)(face, px.data(), py.data(), pz.data(), weightA.data(), a, b, map);
}

float storedDistance(const Candidate& candidate, const glm::vec3& point) {
    const CubePoint p = cubePoint(point - candidate.offset);
    const PackedReferenceMap::Level& level = candidate.map->levels().front();
    const int n = level.faceSize();
    const auto texel = [n](float st) {
        return st > -1 ? std::min(static_cast<int>((st * 0.5f + 0.5f) * static_cast<float>(n)), n - 1)
                       : 0;  // NaN: 0
    };
    return level.distanceAt(p.face, texel(p.st.x), texel(p.st.y));
}

}  // namespace reflection
#endif
