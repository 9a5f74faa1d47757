// Per-instruction-set part of the reflection-point search: lookups of a reflector map for a vector of
// directions. Included once per target by ReflectionSearch.cpp.
#if defined(REFLECTION_CHROME_MAP_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_CHROME_MAP_LANES_INL_H
#undef REFLECTION_CHROME_MAP_LANES_INL_H
#else
#define REFLECTION_CHROME_MAP_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>
#include <cstring>

#include "reflection/chrome/ReflectorMap.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using LanesOf = hn::ScalableTag<T>;
template <class T>
using MaskOf = hn::Mask<LanesOf<T>>;
using Doubles = LanesOf<double>;
using Floats = LanesOf<float>;
using HalfFloats = hn::Rebind<float, Doubles>;
using HalfInts = hn::Rebind<std::int32_t, Doubles>;
using VD = hn::Vec<Doubles>;
using MD = MaskOf<double>;
using MF = MaskOf<float>;

/// A vector of numbers with the usual signs: doubles, or twice as many floats.
template <class T>
struct Real {
    hn::Vec<LanesOf<T>> v;
};
using Num = Real<double>;
template <class T>
HWY_INLINE Real<T> real(double x) {
    return {hn::Set(LanesOf<T>(), static_cast<T>(x))};
}
HWY_INLINE Num num(double x) {
    return real<double>(x);
}
template <class T>
HWY_INLINE Real<T> operator+(Real<T> a, Real<T> b) {
    return {hn::Add(a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> operator-(Real<T> a, Real<T> b) {
    return {hn::Sub(a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> operator*(Real<T> a, Real<T> b) {
    return {hn::Mul(a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> operator/(Real<T> a, Real<T> b) {
    return {hn::Div(a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> operator-(Real<T> a) {
    return {hn::Neg(a.v)};
}
template <class T>
HWY_INLINE MaskOf<T> operator<(Real<T> a, Real<T> b) {
    return hn::Lt(a.v, b.v);
}
template <class T>
HWY_INLINE MaskOf<T> operator<=(Real<T> a, Real<T> b) {
    return hn::Le(a.v, b.v);
}
template <class T>
HWY_INLINE MaskOf<T> operator>(Real<T> a, Real<T> b) {
    return hn::Gt(a.v, b.v);
}
template <class T>
HWY_INLINE MaskOf<T> operator>=(Real<T> a, Real<T> b) {
    return hn::Ge(a.v, b.v);
}
template <class T>
HWY_INLINE Real<T> choose(MaskOf<T> m, Real<T> a, Real<T> b) {
    return {hn::IfThenElse(m, a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> size(Real<T> a) {
    return {hn::Abs(a.v)};
}
template <class T>
HWY_INLINE Real<T> root(Real<T> a) {
    return {hn::Sqrt(a.v)};
}
template <class T>
HWY_INLINE Real<T> least(Real<T> a, Real<T> b) {
    return {hn::Min(a.v, b.v)};
}
template <class T>
HWY_INLINE Real<T> most(Real<T> a, Real<T> b) {
    return {hn::Max(a.v, b.v)};
}
/// a * b + c
template <class T>
HWY_INLINE Real<T> fma(Real<T> a, Real<T> b, Real<T> c) {
    return {hn::MulAdd(a.v, b.v, c.v)};
}

template <class T>
struct Real3 {
    Real<T> x, y, z;
};
using Num3 = Real3<double>;
template <class T>
HWY_INLINE Real3<T> real3(const glm::dvec3& p) {
    return {real<T>(p.x), real<T>(p.y), real<T>(p.z)};
}
HWY_INLINE Num3 num3(const glm::dvec3& p) {
    return real3<double>(p);
}
template <class T>
HWY_INLINE Real3<T> operator+(const Real3<T>& a, const Real3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
HWY_INLINE Real3<T> operator-(const Real3<T>& a, const Real3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
HWY_INLINE Real3<T> operator*(Real<T> a, const Real3<T>& b) {
    return {a * b.x, a * b.y, a * b.z};
}
template <class T>
HWY_INLINE Real<T> dot(const Real3<T>& a, const Real3<T>& b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class T>
HWY_INLINE Real3<T> cross(const Real3<T>& a, const Real3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
HWY_INLINE Real3<T> choose(MaskOf<T> m, const Real3<T>& a, const Real3<T>& b) {
    return {choose(m, a.x, b.x), choose(m, a.y, b.y), choose(m, a.z, b.z)};
}

/// The axes of the faces on which a vector of directions lies: all that is not listed is zero.
template <class T>
struct FaceAxesOf {
    Real<T> majorX, majorY, majorZ, sX, sZ, tY, tZ;

    /// Into the face's frame (along s, along t, along the major axis), and back.
    HWY_INLINE Real3<T> in(const Real3<T>& p) const {
        return {fma(sX, p.x, sZ * p.z), fma(tY, p.y, tZ * p.z),
                fma(majorX, p.x, fma(majorY, p.y, majorZ * p.z))};
    }
    HWY_INLINE Real3<T> out(const Real3<T>& p) const {
        return {fma(sX, p.x, majorX * p.z), fma(tY, p.y, majorY * p.z),
                fma(sZ, p.x, fma(tZ, p.y, majorZ * p.z))};
    }
};

template <class T>
struct OnCubeOf {
    FaceAxesOf<T> axes;
    Real<T> s, t;
    Real<T> largest;  ///< of the direction's components
    hn::Vec<LanesOf<T>> face;
};

using FaceAxes = FaceAxesOf<double>;
using OnCube = OnCubeOf<double>;

/// Below it, a divisor stands for nothing.
template <class T>
constexpr double tinyOf = sizeof(T) == 8 ? 1e-300 : 1e-30;

template <class T>
HWY_INLINE OnCubeOf<T> onCube(const Real3<T>& d) {
    const LanesOf<T> tag;
    const Real<T> zero = real<T>(0), one = real<T>(1);
    const Real<T> ax = size(d.x), ay = size(d.y), az = size(d.z);
    const MaskOf<T> isX = hn::And(ax >= ay, ax >= az);
    const MaskOf<T> isY = hn::AndNot(isX, ay >= az);
    const MaskOf<T> isZ = hn::Not(hn::Or(isX, isY));
    const MaskOf<T> negative = choose(isX, d.x, choose(isY, d.y, d.z)) < zero;
    const Real<T> sign = choose(negative, real<T>(-1), one);
    OnCubeOf<T> at;
    at.axes.majorX = choose(isX, sign, zero);
    at.axes.majorY = choose(isY, sign, zero);
    at.axes.majorZ = choose(isZ, sign, zero);
    at.axes.sX = choose(isX, zero, choose(isY, one, sign));
    at.axes.sZ = choose(isX, -sign, zero);
    at.axes.tY = choose(isY, zero, real<T>(-1));
    at.axes.tZ = choose(isY, sign, zero);
    // The zero direction is met as the middle of a face.
    at.largest = most(most(ax, most(ay, az)), real<T>(tinyOf<T>));
    const Real3<T> local = at.axes.in(d);
    const Real<T> perLargest = one / at.largest;
    at.s = local.x * perLargest;
    at.t = local.y * perLargest;
    const auto base =
        hn::IfThenElse(isX, hn::Zero(tag), hn::IfThenElse(isY, hn::Set(tag, 2), hn::Set(tag, 4)));
    at.face = hn::Add(base, hn::IfThenElseZero(negative, hn::Set(tag, 1)));
    return at;
}

/// Four numbers of a corner of each lane's cell, `offsets` floats from the map's first. A lane's corner is
/// one load of 16 bytes: putting those together and turning them is faster than four gathers.
struct CornerLanes {
    template <class D, class V = hn::Vec<D>>
    static HWY_INLINE void load(D d, const float* base, const std::int32_t* offsets, V& x, V& y, V& z, V& c) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
        if constexpr (hn::MaxLanes(D()) >= 4) {
            const hn::Repartition<double, D> pairs;
            const V a = everyFourth(d, base, offsets), b = everyFourth(d, base, offsets + 1);
            const V e = everyFourth(d, base, offsets + 2), f = everyFourth(d, base, offsets + 3);
            const auto xyLow = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
            const auto xyHigh = hn::BitCast(pairs, hn::InterleaveLower(d, e, f));
            const auto zcLow = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
            const auto zcHigh = hn::BitCast(pairs, hn::InterleaveUpper(d, e, f));
            x = hn::BitCast(d, hn::InterleaveLower(pairs, xyLow, xyHigh));
            y = hn::BitCast(d, hn::InterleaveUpper(pairs, xyLow, xyHigh));
            z = hn::BitCast(d, hn::InterleaveLower(pairs, zcLow, zcHigh));
            c = hn::BitCast(d, hn::InterleaveUpper(pairs, zcLow, zcHigh));
            return;
        }
#endif
        HWY_ALIGN float copied[4 * 16];
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
            std::memcpy(copied + 4 * lane, base + offsets[lane], 16);
        hn::LoadInterleaved4(d, copied, x, y, z, c);
    }

#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  private:
    template <class D>
    static HWY_INLINE hn::Vec<D> everyFourth(D d, const float* base, const std::int32_t* offsets) {
        if constexpr (hn::MaxLanes(D()) <= 4) {
            return hn::LoadU(d, base + offsets[0]);
        } else {
            const hn::Half<D> half;
            return hn::Combine(d, everyFourth(half, base, offsets + hn::MaxLanes(half)),
                               everyFourth(half, base, offsets));
        }
    }
#endif
};

/// Cells of a map that directions lie in.
template <class T>
struct CellLanes {
    static constexpr std::size_t mostLanes = 64 / sizeof(T);  // 512 bits
    HWY_ALIGN std::array<std::int32_t, mostLanes> offsets;    ///< of their first corners, in floats
    Real<T> u, v;                                             ///< within the cell, 0 to 1
    Real<T> s0, t0, cellSize;                                 ///< its first corner
    std::int32_t nextRow;                                     ///< floats

    HWY_INLINE CellLanes(const ReflectorMap& map, const OnCubeOf<T>& at) {
        const double cells = map.cellsPerSide();
        const auto cell = [&](Real<T> x, Real<T>& fraction) {
            const Real<T> scaled = (x + real<T>(1)) * real<T>(0.5 * cells);
            // Max first: of a NaN it makes 0.
            const Real<T> floor = least(most(Real<T>{hn::Floor(scaled.v)}, real<T>(0)), real<T>(cells - 1));
            fraction = scaled - floor;
            return floor;
        };
        const Real<T> column = cell(at.s, u), row = cell(at.t, v);
        const double side = cells + 1;
        // Exact in floats for maps of up to 1,670 cells a side.
        const Real<T> index = fma(fma(Real<T>{at.face}, real<T>(side), row), real<T>(side), column);
        const hn::Rebind<std::int32_t, LanesOf<T>> ints;
        if constexpr (sizeof(T) == 8)
            hn::Store(hn::ShiftLeft<2>(hn::DemoteTo(ints, index.v)), ints, offsets.data());
        else
            hn::Store(hn::ShiftLeft<2>(hn::ConvertTo(ints, index.v)), ints, offsets.data());
        cellSize = real<T>(2 / cells);
        s0 = fma(column, cellSize, real<T>(-1)), t0 = fma(row, cellSize, real<T>(-1));
        nextRow = 4 * (map.cellsPerSide() + 1);
    }

    /// Normal (in the map's axes) and reciprocal distance of one of the four corners, right, low, or both.
    HWY_INLINE void corner(const ReflectorMap& map, int k, Real3<T>& m, Real<T>& c) const {
        const float* base =
            reinterpret_cast<const float*>(map.corners().data()) + 4 * (k & 1) + nextRow * (k >> 1);
        if constexpr (sizeof(T) == 8) {
            const HalfFloats floats;
            const Doubles tag;
            hn::Vec<HalfFloats> x, y, z, w;
            CornerLanes::load(floats, base, offsets.data(), x, y, z, w);
            m = {{hn::PromoteTo(tag, x)}, {hn::PromoteTo(tag, y)}, {hn::PromoteTo(tag, z)}};
            c = {hn::PromoteTo(tag, w)};
        } else {
            CornerLanes::load(Floats(), base, offsets.data(), m.x.v, m.y.v, m.z.v, c.v);
        }
    }
};

/// The map's surface at (s, t) of a face, in the face's frame.
template <class T>
struct SurfaceOf {
    Real<T> q, qS, qT;   ///< reciprocal distance along (s, t, 1) and its slopes
    Real3<T> m, mS, mT;  ///< normal before it is brought to unit length, and its slopes
};
using Surface = SurfaceOf<double>;

template <class T>
HWY_INLINE SurfaceOf<T> surfaceAt(const ReflectorMap& map, const OnCubeOf<T>& at) {
    const CellLanes<T> cell(map, at);
    const Real<T> half = real<T>(0.5), one = real<T>(1), perCell = real<T>(0.5 * map.cellsPerSide());
    SurfaceOf<T> r;
    r.q = r.qS = r.qT = real<T>(0);
    r.m = r.mS = r.mT = {real<T>(0), real<T>(0), real<T>(0)};
    for (int k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, low = (k >> 1) != 0;
        Real3<T> corner;
        Real<T> c;
        cell.corner(map, k, corner, c);
        const Real3<T> m = at.axes.in(corner);
        const Real<T> halfC = half * c;
        const Real<T> wu = right ? cell.u : one - cell.u, wv = low ? cell.v : one - cell.v;
        const Real<T> w = wu * wv;
        const Real<T> wS = (right ? perCell : -perCell) * wv, wT = (low ? perCell : -perCell) * wu;
        const Real<T> sSum = at.s + (right ? cell.s0 + cell.cellSize : cell.s0),
                      tSum = at.t + (low ? cell.t0 + cell.cellSize : cell.t0);
        const Real<T> predicted = halfC * fma(m.x, sSum, fma(m.y, tSum, m.z + m.z));
        r.q = fma(w, predicted, r.q);
        r.qS = fma(wS, predicted, fma(w, halfC * m.x, r.qS));
        r.qT = fma(wT, predicted, fma(w, halfC * m.y, r.qT));
        r.m = r.m + w * m;
        r.mS = r.mS + wS * m;
        r.mT = r.mT + wT * m;
    }
    return r;
}

/// The same without slopes.
template <class T>
HWY_INLINE void placeAt(const ReflectorMap& map, const OnCubeOf<T>& at, Real<T>& q, Real3<T>& normal) {
    const CellLanes<T> cell(map, at);
    const Real<T> half = real<T>(0.5), one = real<T>(1);
    q = real<T>(0);
    normal = {q, q, q};
    for (int k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, low = (k >> 1) != 0;
        Real3<T> corner;
        Real<T> c;
        cell.corner(map, k, corner, c);
        const Real3<T> m = at.axes.in(corner);
        const Real<T> w = (right ? cell.u : one - cell.u) * (low ? cell.v : one - cell.v);
        const Real<T> sSum = at.s + (right ? cell.s0 + cell.cellSize : cell.s0),
                      tSum = at.t + (low ? cell.t0 + cell.cellSize : cell.t0);
        q = fma(w * half * c, fma(m.x, sSum, fma(m.y, tSum, m.z + m.z)), q);
        normal = normal + w * m;
    }
}

/// To and from the space of the cube.
template <class T>
struct StretchOf {
    Real3<T> by, inverse;

    HWY_INLINE explicit StretchOf(const ReflectorMap& map)
        : by(real3<T>(map.frame().stretch)), inverse(real3<T>(1.0 / map.frame().stretch)) {}
    HWY_INLINE Real3<T> positions(const Real3<T>& p) const { return {by.x * p.x, by.y * p.y, by.z * p.z}; }
    HWY_INLINE Real3<T> normals(const Real3<T>& n) const {
        return {inverse.x * n.x, inverse.y * n.y, inverse.z * n.z};
    }
    HWY_INLINE Real3<T> takeOut(const Real3<T>& p) const { return normals(p); }
};
using Stretch = StretchOf<double>;

/// The gauge of points, stretch taken out (below 1 inside the surface) and its change along a direction.
template <class T>
HWY_INLINE Real<T> gaugeAt(const ReflectorMap& map, const Real3<T>& p, const Real3<T>& along,
                           Real<T>& slope) {
    const OnCubeOf<T> at = onCube(p);
    const SurfaceOf<T> surface = surfaceAt(map, at);
    const Real3<T> d = at.axes.in(along);
    slope =
        fma(surface.qS, d.x, fma(surface.qT, d.y, (surface.q - at.s * surface.qS - at.t * surface.qT) * d.z));
    return at.largest * surface.q;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
