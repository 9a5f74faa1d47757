// What a packed reference map holds in many directions at once. Included once for each instruction set
// (Highway's convention for such files), hence no ordinary guard.
#if defined(REFLECTION_LOCAL_MAP_PACKED_PROBE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_LOCAL_MAP_PACKED_PROBE_INL_H
#undef REFLECTION_LOCAL_MAP_PACKED_PROBE_INL_H
#else
#define REFLECTION_LOCAL_MAP_PACKED_PROBE_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "reflection/reference_maps/PackedReferenceMap.h"

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

/// Over a plane nearness falls by more than this share from one texel to the next only within three texels of
/// the plane's horizon; elsewhere such a step is the edge of something.
constexpr float tornShare = 0.3f;

/// Brightness is bilinear. So is nearness on a surface; across an edge it is the nearest texel's, lest a
/// surface is met where there is none. The block of the nearest texel for chroma.
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
    const VI one = hn::Set(di, 1);
    const VI nextRow = hn::Add(index, hn::Set(di, map.faceSize + 2));
    const VW w00 = fetchWord(map, index), w10 = fetchWord(map, hn::Add(index, one));
    const VW w01 = fetchWord(map, nextRow), w11 = fetchWord(map, hn::Add(nextRow, one));
    const auto bilinear = [&](VF a, VF b, VF c, VF e) {
        const VF above = hn::MulAdd(fx, hn::Sub(b, a), a), below = hn::MulAdd(fx, hn::Sub(e, c), c);
        return hn::MulAdd(fy, hn::Sub(below, above), above);
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
    const VF n00 = nearness(w00), n10 = nearness(w10);
    const VF n01 = nearness(w01), n11 = nearness(w11);
    const VF nearest = hn::Max(hn::Max(n00, n10), hn::Max(n01, n11));
    const VF farthest = hn::Min(hn::Min(n00, n10), hn::Min(n01, n11));
    const MF torn = hn::Lt(farthest, hn::Mul(nearest, hn::Set(d, 1 - tornShare)));
    const MF right = hn::Ge(fx, half), down = hn::Ge(fy, half);
    const VF own = hn::IfThenElse(down, hn::IfThenElse(right, n11, n01), hn::IfThenElse(right, n10, n00));
    const VF met = hn::IfThenElse(torn, own, bilinear(n00, n10, n01, n11));

    Probe result;
    result.disagreement = hn::Sub(hn::Mul(p.depth, met), hn::Set(d, 1.0f));
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

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#endif
