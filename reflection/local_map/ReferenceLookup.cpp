// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/local_map/ReferenceLookup.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reflection/local_map/ReferenceLookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Float = hn::ScalableTag<float>;
using Int = hn::RebindToSigned<Float>;
using Word = hn::RebindToUnsigned<Float>;
using VF = hn::Vec<Float>;
using VI = hn::Vec<Int>;
using VW = hn::Vec<Word>;
using MF = hn::Mask<Float>;

/// More than this many candidates are not asked.
constexpr std::size_t mostCandidates = 16;

struct MapView {
    const std::uint8_t* words;
    const std::uint16_t* chroma;
    int faceSize;
    int chromaColumns;
    float radianceScale;
    float ox, oy, oz;
};

struct FacePoint {
    VI face;
    VF u, v;   ///< texels from the face's corner, 0 .. faceSize
    VF depth;  ///< along the face's major axis
};

HWY_INLINE FacePoint toFace(VF x, VF y, VF z, int faceSize) {
    const Float d;
    const Int di;
    const VF ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
    const MF isX = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
    const MF isY = hn::AndNot(isX, hn::Ge(ay, az));
    const VF major = hn::Max(ax, hn::Max(ay, az));
    const VF sign = hn::SignBit(d);
    const VF value = hn::IfThenElse(isX, x, hn::IfThenElse(isY, y, z));
    const VF flip = hn::And(value, sign);
    // See CubeMapping: +X (-z, -y), -X (z, -y), +Y (x, z), -Y (x, -z), +Z (x, -y), -Z (-x, -y).
    const VF s = hn::IfThenElse(isX, hn::Xor(hn::Neg(z), flip), hn::IfThenElse(isY, x, hn::Xor(x, flip)));
    const VF t = hn::IfThenElse(isY, hn::Xor(z, flip), hn::Neg(y));
    const VF scale = hn::Div(hn::Set(d, 0.5f * static_cast<float>(faceSize)), major);
    const VF half = hn::Set(d, 0.5f * static_cast<float>(faceSize));
    const VI pair = hn::IfThenElse(hn::RebindMask(di, isX), hn::Zero(di),
                                   hn::IfThenElse(hn::RebindMask(di, isY), hn::Set(di, 2), hn::Set(di, 4)));
    const VI negative = hn::BitCast(di, hn::ShiftRight<31>(hn::BitCast(Word(), value)));
    return {hn::Add(pair, negative), hn::Add(hn::Mul(s, scale), half), hn::Add(hn::Mul(t, scale), half),
            major};
}

/// The 20-bit word of a bordered texel.
HWY_INLINE VW fetchWord(const MapView& map, VI index) {
    const Int di;
    const Word dw;
    const VI five = hn::Add(hn::ShiftLeft<2>(index), index);
    const VI byte = hn::ShiftRight<1>(five);
    const VW raw = hn::GatherOffset(dw, reinterpret_cast<const std::uint32_t*>(map.words), byte);
    const VI odd = hn::And(index, hn::Set(di, 1));
    return hn::And(hn::Shr(raw, hn::BitCast(dw, hn::ShiftLeft<2>(odd))), hn::Set(dw, 0xfffffu));
}

HWY_INLINE VI borderedIndex(VI face, VI x, VI y, int faceSize) {
    const Int di;
    const VI m = hn::Set(di, faceSize + 2);
    return hn::Add(hn::Mul(hn::Add(hn::Mul(face, m), y), m), x);
}

/// What a map holds in the direction of a point.
struct Probe {
    VF disagreement;  ///< depth of the point times the nearness there, minus 1
    VF sum;           ///< R+G+B
    VI chromaBlock;
};

/// Bilinear in nearness and brightness; the block of the nearest texel for chroma.
HWY_INLINE Probe probe(const MapView& map, VF x, VF y, VF z) {
    const Float d;
    const Int di;
    const Word dw;
    const FacePoint p = toFace(x, y, z, map.faceSize);
    const VF half = hn::Set(d, 0.5f);
    // In bordered texels the centre of texel i lies at i + 1.5; clamped, since rounding may pass the face's
    // edge.
    const VF most = hn::Set(d, static_cast<float>(map.faceSize) + 0.9999f);
    const VF u = hn::Min(hn::Max(hn::Add(p.u, half), hn::Zero(d)), most);
    const VF v = hn::Min(hn::Max(hn::Add(p.v, half), hn::Zero(d)), most);
    const VI ix = hn::ConvertTo(di, u), iy = hn::ConvertTo(di, v);
    const VF fx = hn::Sub(u, hn::ConvertTo(d, ix)), fy = hn::Sub(v, hn::ConvertTo(d, iy));
    const VI index = borderedIndex(p.face, ix, iy, map.faceSize);
    const VI row = hn::Set(di, map.faceSize + 2);
    const VI one = hn::Set(di, 1);
    const VW w00 = fetchWord(map, index), w10 = fetchWord(map, hn::Add(index, one));
    const VW w01 = fetchWord(map, hn::Add(index, row)),
             w11 = fetchWord(map, hn::Add(hn::Add(index, row), one));
    const auto bilinear = [&](VF a, VF b, VF c, VF e) {
        const VF top = hn::MulAdd(fx, hn::Sub(b, a), a), bottom = hn::MulAdd(fx, hn::Sub(e, c), c);
        return hn::MulAdd(fy, hn::Sub(bottom, top), top);
    };
    const auto nearness = [&](VW word) {
        const VW code = hn::And(word, hn::Set(dw, PackedReferenceMap::nearnessMask));
        return hn::BitCast(
            d, hn::Add(hn::ShiftLeft<16>(code), hn::Set(dw, PackedReferenceMap::nearnessExponentBias << 23)));
    };
    const auto sum = [&](VW word) {
        const VW code = hn::ShiftRight<PackedReferenceMap::nearnessBits>(word);
        return hn::BitCast(d, hn::Add(hn::ShiftLeft<PackedReferenceMap::sumMantissaShift>(code),
                                      hn::Set(dw, PackedReferenceMap::sumExponentBias << 23)));
    };
    Probe result;
    result.disagreement =
        hn::Sub(hn::Mul(p.depth, bilinear(nearness(w00), nearness(w10), nearness(w01), nearness(w11))),
                hn::Set(d, 1.0f));
    result.sum = bilinear(sum(w00), sum(w10), sum(w01), sum(w11));
    const VI columns = hn::Set(di, map.chromaColumns);
    const VI rows = hn::Set(di, (map.faceSize + 2) / 2);
    const VI bx = hn::Min(hn::ShiftRight<2>(hn::ConvertTo(di, hn::Add(u, half))), hn::Sub(columns, one));
    const VI by = hn::Min(hn::ShiftRight<1>(hn::ConvertTo(di, hn::Add(v, half))), hn::Sub(rows, one));
    result.chromaBlock = hn::Add(hn::Mul(hn::Add(hn::Mul(p.face, rows), by), columns), bx);
    return result;
}

struct Colour {
    VF red, green, blue;
};

HWY_INLINE Colour colourOf(const MapView& map, VF sum, VI chromaBlock) {
    const Float d;
    const Int di;
    const Word dw;
    const VW shares = hn::GatherOffset(dw, reinterpret_cast<const std::uint32_t*>(map.chroma),
                                       hn::ShiftLeft<1>(chromaBlock));
    const VW low = hn::Set(dw, 0xffu);
    const VF unit = hn::Set(d, 1.0f / 255.0f);
    const VF red = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, hn::And(shares, low))), unit);
    const VF blue = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<8>(shares), low))), unit);
    const VF green = hn::Max(hn::Zero(d), hn::Sub(hn::Sub(hn::Set(d, 1.0f), red), blue));
    const VF all = hn::Mul(sum, hn::Set(d, map.radianceScale));
    return {hn::Mul(all, red), hn::Mul(all, green), hn::Mul(all, blue)};
}

MapView viewOf(const Candidate& c, int localFaceSize) {
    const PackedReferenceMap::Level& level = c.map->levelFor(localFaceSize);
    return {level.words(),          level.chroma(), level.faceSize(), level.chromaColumns(),
            c.map->radianceScale(), c.offset.x,     c.offset.y,       c.offset.z};
}

/// Puts the maps first that see the point at about the scale at which the local map does. A map much farther
/// from it than the local map's centre lacks detail; a much nearer one has more than the local map can hold,
/// which would alias.
void orderByScale(std::span<const Candidate> candidates, const glm::vec3& point,
                  std::span<std::uint8_t> order, std::span<float> misfit) {
    const float own = point.x * point.x + point.y * point.y + point.z * point.z;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const glm::vec3 o = candidates[k].offset;
        const float x = point.x - o.x, y = point.y - o.y, z = point.z - o.z;
        const float squared = x * x + y * y + z * z;
        const float m = squared > own ? squared / own : own / squared;
        std::size_t at = k;
        for (; at > 0 && misfit[at - 1] > m; --at) {
            misfit[at] = misfit[at - 1];
            order[at] = order[at - 1];
        }
        misfit[at] = m;
        order[at] = static_cast<std::uint8_t>(k);
    }
}

/// The map's answer for the point t d of a ray.
HWY_INLINE Probe probeAlong(const MapView& map, VF dx, VF dy, VF dz, VF t) {
    const Float d;
    return probe(map, hn::Sub(hn::Mul(t, dx), hn::Set(d, map.ox)),
                 hn::Sub(hn::Mul(t, dy), hn::Set(d, map.oy)), hn::Sub(hn::Mul(t, dz), hn::Set(d, map.oz)));
}

void LookUpRefined(int face, const float* reciprocal, std::span<const Candidate> candidates,
                   const LookupOptions& options, LocalMap& out) {
    const Float d;
    const int n = out.faceSize;
    const std::size_t lanes = hn::Lanes(d);
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    const std::size_t base = out.faceOffset(face);
    const std::size_t texels = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    const float texelSize = 2.0f / static_cast<float>(n);
    const Int di;
    const VF sky = hn::Set(d, PackedReferenceMap::skyDepth);
    const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const VF agreement = hn::Set(d, options.agreement);
    const VF one = hn::Set(d, 1.0f);
    candidates = candidates.first(std::min<std::size_t>(candidates.size(), mostCandidates));
    std::array<MapView, mostCandidates> views;
    std::array<std::uint8_t, mostCandidates> order;
    std::array<float, mostCandidates> misfit;
    for (std::size_t k = 0; k < candidates.size(); ++k) views[k] = viewOf(candidates[k], n);
    HWY_ALIGN float texelS[HWY_MAX_BYTES / sizeof(float)];
    HWY_ALIGN float texelT[HWY_MAX_BYTES / sizeof(float)];

    int column = 0, row = 0;
    for (std::size_t first = 0; first < texels; first += lanes) {
        const std::size_t count = std::min(lanes, texels - first);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            // Lanes past the last texel repeat it.
            texelS[lane] = (static_cast<float>(column) + 0.5f) * texelSize - 1;
            texelT[lane] = (static_cast<float>(row) + 0.5f) * texelSize - 1;
            if (lane + 1 < count && ++column == n) {
                column = 0;
                ++row;
            }
        }
        if (++column == n) {
            column = 0;
            ++row;
        }
        const VF s = hn::Load(d, texelS), t = hn::Load(d, texelT);
        const auto along = [&](float major, float sAxis, float tAxis) {
            return hn::MulAdd(s, hn::Set(d, sAxis), hn::MulAdd(t, hn::Set(d, tAxis), hn::Set(d, major)));
        };
        const VF dx = along(f.major.x, f.sAxis.x, f.tAxis.x);
        const VF dy = along(f.major.y, f.sAxis.y, f.tAxis.y);
        const VF dz = along(f.major.z, f.sAxis.z, f.tAxis.z);
        const VF dd = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));

        VF start;
        if (count == lanes) {
            start = hn::LoadU(d, reciprocal + first);
        } else {
            HWY_ALIGN float rest[HWY_MAX_BYTES / sizeof(float)] = {};
            std::copy_n(reciprocal + first, count, rest);
            start = hn::Load(d, rest);
        }
        start = hn::Min(hn::Div(one, hn::Max(start, hn::Set(d, 1.0f / PackedReferenceMap::skyDepth))), sky);

        // Neighbours share one order: that of the middle one.
        const std::size_t middle = count / 2;
        HWY_ALIGN float startLanes[HWY_MAX_BYTES / sizeof(float)];
        hn::Store(start, d, startLanes);
        orderByScale(candidates,
                     startLanes[middle] * (f.major + texelS[middle] * f.sAxis + texelT[middle] * f.tAxis),
                     std::span(order).first(candidates.size()), misfit);

        VF bestError = infinity, bestDepth = start;
        Colour colour{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        for (std::size_t k = 0; k < candidates.size(); ++k) {
            const MapView& map = views[order[k]];
            const VF dc = hn::MulAdd(dx, hn::Set(d, map.ox),
                                     hn::MulAdd(dy, hn::Set(d, map.oy), hn::Mul(dz, hn::Set(d, map.oz))));
            VF ta = start;
            Probe at = probeAlong(map, dx, dy, dz, ta);
            VF qa = at.disagreement, sum = at.sum, error = hn::Abs(qa), depth = ta;
            VI block = at.chromaBlock;
            VF tb = ta, qb = qa;
            for (int step = 1; step < options.lookups; ++step) {
                if (hn::AllTrue(d, hn::Le(hn::Min(error, bestError), agreement))) break;
                VF next;
                if (step == 1) {
                    // The candidate's surface point C + (X - C) / (1 + q), projected onto the ray: its ray
                    // parameter is (d.C + (t d.d - d.C) / (1 + q)) / d.d.
                    const VF scale = hn::Div(one, hn::Max(hn::Add(qa, one), hn::Set(d, 1e-4f)));
                    next = hn::Div(hn::MulAdd(hn::Sub(hn::Mul(ta, dd), dc), scale, dc), dd);
                } else {
                    const VF slope = hn::Sub(qb, qa);
                    const MF flat = hn::Lt(hn::Abs(slope), hn::Set(d, 1e-6f));
                    next =
                        hn::Sub(tb, hn::Div(hn::Mul(qb, hn::Sub(tb, ta)), hn::IfThenElse(flat, one, slope)));
                    next = hn::IfThenElse(flat, tb, next);
                }
                // The candidate's own surface is where it is, however far the start; a secant may overshoot.
                const VF quarter = hn::Mul(tb, hn::Set(d, 0.25f));
                next = hn::Min(next, sky);
                next = step == 1 ? hn::IfThenElse(hn::Gt(next, hn::Zero(d)), next, quarter)
                                 : hn::Max(next, quarter);
                ta = tb;
                qa = qb;
                tb = next;
                at = probeAlong(map, dx, dy, dz, tb);
                qb = at.disagreement;
                const VF size = hn::Abs(qb);
                const MF better = hn::Lt(size, error);
                error = hn::IfThenElse(better, size, error);
                depth = hn::IfThenElse(better, tb, depth);
                sum = hn::IfThenElse(better, at.sum, sum);
                block = hn::IfThenElse(hn::RebindMask(di, better), at.chromaBlock, block);
            }
            const MF improves = hn::AndNot(hn::Le(bestError, agreement), hn::Lt(error, bestError));
            if (!hn::AllFalse(d, improves)) {
                const Colour c = colourOf(map, sum, block);
                colour.red = hn::IfThenElse(improves, c.red, colour.red);
                colour.green = hn::IfThenElse(improves, c.green, colour.green);
                colour.blue = hn::IfThenElse(improves, c.blue, colour.blue);
                bestError = hn::IfThenElse(improves, error, bestError);
                bestDepth = hn::IfThenElse(improves, depth, bestDepth);
            }
            if (hn::AllTrue(d, hn::Le(bestError, agreement))) break;
        }
        // Between the farthest building and the sky there is nothing: halfway decides.
        bestDepth = hn::IfThenElse(hn::Ge(bestDepth, hn::Set(d, 0.5f * PackedReferenceMap::skyDepth)),
                                   infinity, bestDepth);

        const auto store = [&](VF value, std::vector<float>& plane) {
            if (count == lanes) {
                hn::StoreU(value, d, plane.data() + base + first);
            } else {
                HWY_ALIGN float rest[HWY_MAX_BYTES / sizeof(float)];
                hn::Store(value, d, rest);
                std::copy_n(rest, count, plane.data() + base + first);
            }
        };
        store(colour.red, out.red);
        store(colour.green, out.green);
        store(colour.blue, out.blue);
        store(bestDepth, out.depth);
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
