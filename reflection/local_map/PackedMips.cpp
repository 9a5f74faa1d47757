#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/local_map/PackedMips.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reflection/local_map/PackedMips.h"

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Rounds non-negative floats to unsigned floats of 5 exponent bits and 6 (11 bit) or 5 (10 bit) mantissa
/// bits.
template <int mantissaBits, class D, class V>
HWY_INLINE auto toSmallFloat(D d, V value) {
    const hn::RebindToUnsigned<D> dw;
    constexpr int drop = 23 - mantissaBits;
    // Greatest finite small float is (2 - 2^-mantissaBits) * 2^15; smallest normal 2^-14, below it counts as
    // 0.
    const auto greatest = hn::Set(d, (2.0f - 1.0f / static_cast<float>(1 << mantissaBits)) * 32768.0f);
    const auto smallest = hn::Set(d, 1.0f / 16384.0f);
    const auto usable = hn::Ge(value, smallest);  // false for NaN
    const auto clamped = hn::Min(value, greatest);
    const auto bits =
        hn::Sub(hn::Add(hn::BitCast(dw, clamped), hn::Set(dw, 1u << (drop - 1))), hn::Set(dw, 112u << 23));
    const auto most = hn::Set(dw, (30u << mantissaBits) | ((1u << mantissaBits) - 1));
    const auto code = hn::Min(hn::ShiftRight<drop>(bits), most);
    return hn::IfThenElseZero(hn::RebindMask(dw, usable), code);
}

void PackTexels(const float* red, const float* green, const float* blue, std::uint32_t* out,
                std::size_t count) {
    const auto pack = [&](auto d, std::size_t i) {
        const hn::RebindToUnsigned<decltype(d)> dw;
        const auto r = toSmallFloat<6>(d, hn::LoadU(d, red + i));
        const auto g = toSmallFloat<6>(d, hn::LoadU(d, green + i));
        const auto b = toSmallFloat<5>(d, hn::LoadU(d, blue + i));
        hn::StoreU(hn::Or(r, hn::Or(hn::ShiftLeft<11>(g), hn::ShiftLeft<22>(b))), dw, out + i);
    };
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) pack(d, i);
    for (; i < count; ++i) pack(hn::CappedTag<float, 1>(), i);
}

/// 1 / depth as half floats, rounded to nearest: 0 for infinity, NaN and what is farther than 16 km, where
/// halves lose their accuracy; the greatest half for what is nearer than that.
void PackNearness(const float* depth, std::uint16_t* out, std::size_t count) {
    const auto pack = [&](auto d, std::size_t i) {
        const hn::Rebind<std::uint16_t, decltype(d)> dh;
        const auto nearness = hn::Div(hn::Set(d, 1.0f), hn::LoadU(d, depth + i));
        hn::StoreU(
            hn::DemoteTo(dh, hn::BitCast(hn::RebindToSigned<decltype(d)>(), toSmallFloat<10>(d, nearness))),
            dh, out + i);
    };
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) pack(d, i);
    for (; i < count; ++i) pack(hn::CappedTag<float, 1>(), i);
}

/// 2x2 box filter of one plane of a face.
void Halve(const float* from, float* to, std::size_t half) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto quarter = hn::Set(d, 0.25f);
    for (std::size_t y = 0; y < half; ++y) {
        const float* a = from + 4 * y * half;
        const float* b = a + 2 * half;
        float* out = to + y * half;
        std::size_t x = 0;
        for (; x + lanes <= half; x += lanes) {
            auto even = hn::Zero(d), odd = hn::Zero(d), evenB = hn::Zero(d), oddB = hn::Zero(d);
            hn::LoadInterleaved2(d, a + 2 * x, even, odd);
            hn::LoadInterleaved2(d, b + 2 * x, evenB, oddB);
            hn::StoreU(hn::Mul(quarter, hn::Add(hn::Add(even, odd), hn::Add(evenB, oddB))), d, out + x);
        }
        for (; x < half; ++x) out[x] = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(PackTexels);
HWY_EXPORT(PackNearness);
HWY_EXPORT(Halve);

int PackedMips::levelCount() const {
    return std::has_single_bit(static_cast<unsigned>(faceSize))
               ? std::bit_width(static_cast<unsigned>(faceSize))
               : 1;
}

std::size_t PackedMips::levelOffset(int level) const {
    std::size_t offset = 0;
    for (int k = 0; k < level; ++k) {
        const auto side = static_cast<std::size_t>(faceSize >> k);
        offset += 6 * side * side;
    }
    return offset;
}

void PackedMips::resize(int size) {
    faceSize = size;
    texels.resize(levelOffset(levelCount()));
    nearness.resize(levelOffset(1));
}

void packFaceMips(const LocalMap& map, int face, PackedMips& out) {
    const std::size_t first = map.faceOffset(face);
    const float* planes[3] = {map.red.data() + first, map.green.data() + first, map.blue.data() + first};
    std::vector<float> previous[3], current[3];
    const auto texelsOfFace = static_cast<std::size_t>(map.faceSize) * static_cast<std::size_t>(map.faceSize);
    HWY_DYNAMIC_DISPATCH(PackNearness)(map.depth.data() + first, out.nearness.data() + first, texelsOfFace);
    for (int level = 0; level < out.levelCount(); ++level) {
        const auto side = static_cast<std::size_t>(map.faceSize >> level);
        if (level > 0) {
            for (int c = 0; c < 3; ++c) {
                current[c].resize(side * side);
                HWY_DYNAMIC_DISPATCH(Halve)(planes[c], current[c].data(), side);
                previous[c].swap(current[c]);
                planes[c] = previous[c].data();
            }
        }
        HWY_DYNAMIC_DISPATCH(PackTexels)
        (planes[0], planes[1], planes[2],
         out.texels.data() + out.levelOffset(level) + static_cast<std::size_t>(face) * side * side,
         side * side);
    }
}

void packMips(const LocalMap& map, PackedMips& out) {
    out.resize(map.faceSize);
    for (int face = 0; face < 6; ++face) packFaceMips(map, face, out);
}

float unpackNearness(std::uint16_t half) {
    return half == 0 ? 0.0f : std::bit_cast<float>((std::uint32_t{half} << 13) + (112u << 23));
}

void unpackTexel(std::uint32_t texel, float& red, float& green, float& blue) {
    const auto expand = [](std::uint32_t code, int mantissaBits) {
        return code == 0 ? 0.0f : std::bit_cast<float>((code << (23 - mantissaBits)) + (112u << 23));
    };
    red = expand(texel & 0x7ff, 6);
    green = expand((texel >> 11) & 0x7ff, 6);
    blue = expand(texel >> 22, 5);
}

}  // namespace reflection
#endif
