// Per-instruction-set part of the reflection-point search: lookups of a reflector map for a vector of
// directions. Included once per target by ReflectionSearch.cpp.
#if defined(REFLECTION_CHROME_MAP_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_CHROME_MAP_LANES_INL_H
#undef REFLECTION_CHROME_MAP_LANES_INL_H
#else
#define REFLECTION_CHROME_MAP_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstring>

#include "reflection/chrome/ReflectorMap.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using HalfFloats = hn::Rebind<float, Doubles>;
using HalfInts = hn::Rebind<std::int32_t, Doubles>;
using VD = hn::Vec<Doubles>;
using MD = hn::Mask<Doubles>;

/// A vector of numbers with the usual signs.
struct Num {
    VD v;
};
HWY_INLINE Num num(double x) {
    return {hn::Set(Doubles(), x)};
}
HWY_INLINE Num operator+(Num a, Num b) {
    return {hn::Add(a.v, b.v)};
}
HWY_INLINE Num operator-(Num a, Num b) {
    return {hn::Sub(a.v, b.v)};
}
HWY_INLINE Num operator*(Num a, Num b) {
    return {hn::Mul(a.v, b.v)};
}
HWY_INLINE Num operator/(Num a, Num b) {
    return {hn::Div(a.v, b.v)};
}
HWY_INLINE Num operator-(Num a) {
    return {hn::Neg(a.v)};
}
HWY_INLINE MD operator<(Num a, Num b) {
    return hn::Lt(a.v, b.v);
}
HWY_INLINE MD operator<=(Num a, Num b) {
    return hn::Le(a.v, b.v);
}
HWY_INLINE MD operator>(Num a, Num b) {
    return hn::Gt(a.v, b.v);
}
HWY_INLINE MD operator>=(Num a, Num b) {
    return hn::Ge(a.v, b.v);
}
HWY_INLINE Num choose(MD m, Num a, Num b) {
    return {hn::IfThenElse(m, a.v, b.v)};
}
HWY_INLINE Num size(Num a) {
    return {hn::Abs(a.v)};
}
HWY_INLINE Num root(Num a) {
    return {hn::Sqrt(a.v)};
}
HWY_INLINE Num least(Num a, Num b) {
    return {hn::Min(a.v, b.v)};
}
HWY_INLINE Num most(Num a, Num b) {
    return {hn::Max(a.v, b.v)};
}
/// a * b + c
HWY_INLINE Num fma(Num a, Num b, Num c) {
    return {hn::MulAdd(a.v, b.v, c.v)};
}

struct Num3 {
    Num x, y, z;
};
HWY_INLINE Num3 num3(const glm::dvec3& p) {
    return {num(p.x), num(p.y), num(p.z)};
}
HWY_INLINE Num3 operator+(const Num3& a, const Num3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Num3 operator-(const Num3& a, const Num3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Num3 operator*(Num a, const Num3& b) {
    return {a * b.x, a * b.y, a * b.z};
}
HWY_INLINE Num dot(const Num3& a, const Num3& b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
HWY_INLINE Num3 cross(const Num3& a, const Num3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE Num3 choose(MD m, const Num3& a, const Num3& b) {
    return {choose(m, a.x, b.x), choose(m, a.y, b.y), choose(m, a.z, b.z)};
}

/// The axes of the faces on which a vector of directions lies: all that is not listed is zero.
struct FaceAxes {
    Num majorX, majorY, majorZ, sX, sZ, tY, tZ;

    /// Into the face's frame (along s, along t, along the major axis), and back.
    HWY_INLINE Num3 in(const Num3& p) const {
        return {fma(sX, p.x, sZ * p.z), fma(tY, p.y, tZ * p.z),
                fma(majorX, p.x, fma(majorY, p.y, majorZ * p.z))};
    }
    HWY_INLINE Num3 out(const Num3& p) const {
        return {fma(sX, p.x, majorX * p.z), fma(tY, p.y, majorY * p.z),
                fma(sZ, p.x, fma(tZ, p.y, majorZ * p.z))};
    }
};

struct OnCube {
    FaceAxes axes;
    Num s, t;
    Num largest;  ///< of the direction's components
    VD face;
};

HWY_INLINE OnCube onCube(const Num3& d) {
    const Doubles tag;
    const Num zero = num(0), one = num(1);
    const Num ax = size(d.x), ay = size(d.y), az = size(d.z);
    const MD isX = hn::And(ax >= ay, ax >= az);
    const MD isY = hn::AndNot(isX, ay >= az);
    const MD isZ = hn::Not(hn::Or(isX, isY));
    const MD negative = choose(isX, d.x, choose(isY, d.y, d.z)) < zero;
    const Num sign = choose(negative, num(-1), one);
    OnCube at;
    at.axes.majorX = choose(isX, sign, zero);
    at.axes.majorY = choose(isY, sign, zero);
    at.axes.majorZ = choose(isZ, sign, zero);
    at.axes.sX = choose(isX, zero, choose(isY, one, sign));
    at.axes.sZ = choose(isX, -sign, zero);
    at.axes.tY = choose(isY, zero, num(-1));
    at.axes.tZ = choose(isY, sign, zero);
    // The zero direction is met as the middle of a face.
    at.largest = most(most(ax, most(ay, az)), num(1e-300));
    const Num3 local = at.axes.in(d);
    at.s = local.x / at.largest;
    at.t = local.y / at.largest;
    const VD base = hn::IfThenElse(isX, hn::Zero(tag), hn::IfThenElse(isY, hn::Set(tag, 2), hn::Set(tag, 4)));
    at.face = hn::Add(base, hn::IfThenElseZero(negative, hn::Set(tag, 1)));
    return at;
}

/// The map's surface at (s, t) of a face, in the face's frame.
struct Surface {
    Num q, qS, qT;   ///< reciprocal distance along (s, t, 1) and its slopes
    Num3 m, mS, mT;  ///< normal before it is brought to unit length, and its slopes
};

HWY_INLINE Surface surfaceAt(const ReflectorMap& map, const OnCube& at) {
    const Doubles tag;
    const HalfFloats floats;
    const HalfInts ints;
    const double cells = map.cellsPerSide();
    const Num half = num(0.5), cellSize = num(2 / cells);
    const auto cell = [&](Num x, Num& fraction) {
        const Num scaled = (x + num(1)) * num(0.5 * cells);
        // Max first: of a NaN it makes 0.
        const Num floor = least(most(Num{hn::Floor(scaled.v)}, num(0)), num(cells - 1));
        fraction = scaled - floor;
        return floor;
    };
    Num u, v;
    const Num column = cell(at.s, u), row = cell(at.t, v);
    const double side = cells + 1;
    const Num index = fma(fma(Num{at.face}, num(side), row), num(side), column);
    const auto first = hn::ShiftLeft<2>(hn::DemoteTo(ints, index.v));
    const float* base = reinterpret_cast<const float*>(map.corners().data());
    const Num s0 = fma(column, cellSize, num(-1)), t0 = fma(row, cellSize, num(-1));
    const Num one = num(1), perCell = num(0.5 * cells);

    // Copying the corners and taking them apart is faster than twelve gathers (a corner is one 16-byte load).
    constexpr std::size_t mostLanes = 64 / sizeof(double);
    HWY_ALIGN std::int32_t offsets[mostLanes];
    HWY_ALIGN float copied[4][4 * mostLanes];
    hn::Store(first, ints, offsets);
    const std::size_t lanes = hn::Lanes(tag);
    const std::size_t nextRow = 4 * static_cast<std::size_t>(side);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const float* from = base + offsets[lane];
        std::memcpy(copied[0] + 4 * lane, from, 16);
        std::memcpy(copied[1] + 4 * lane, from + 4, 16);
        std::memcpy(copied[2] + 4 * lane, from + nextRow, 16);
        std::memcpy(copied[3] + 4 * lane, from + nextRow + 4, 16);
    }

    Surface r;
    r.q = r.qS = r.qT = num(0);
    r.m = r.mS = r.mT = {num(0), num(0), num(0)};
    for (int k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, low = (k >> 1) != 0;
        hn::Vec<HalfFloats> x, y, z, c;
        hn::LoadInterleaved4(floats, copied[k], x, y, z, c);
        const Num3 m =
            at.axes.in({{hn::PromoteTo(tag, x)}, {hn::PromoteTo(tag, y)}, {hn::PromoteTo(tag, z)}});
        const Num halfC = half * Num{hn::PromoteTo(tag, c)};
        const Num wu = right ? u : one - u, wv = low ? v : one - v;
        const Num w = wu * wv;
        const Num wS = (right ? perCell : -perCell) * wv, wT = (low ? perCell : -perCell) * wu;
        const Num sSum = at.s + (right ? s0 + cellSize : s0), tSum = at.t + (low ? t0 + cellSize : t0);
        const Num predicted = halfC * fma(m.x, sSum, fma(m.y, tSum, m.z + m.z));
        r.q = fma(w, predicted, r.q);
        r.qS = fma(wS, predicted, fma(w, halfC * m.x, r.qS));
        r.qT = fma(wT, predicted, fma(w, halfC * m.y, r.qT));
        r.m = r.m + w * m;
        r.mS = r.mS + wS * m;
        r.mT = r.mT + wT * m;
    }
    return r;
}

/// To and from the space of the cube.
struct Stretch {
    Num3 by, inverse;

    HWY_INLINE explicit Stretch(const ReflectorMap& map)
        : by(num3(map.frame().stretch)), inverse(num3(1.0 / map.frame().stretch)) {}
    HWY_INLINE Num3 positions(const Num3& p) const { return {by.x * p.x, by.y * p.y, by.z * p.z}; }
    HWY_INLINE Num3 normals(const Num3& n) const {
        return {inverse.x * n.x, inverse.y * n.y, inverse.z * n.z};
    }
    HWY_INLINE Num3 takeOut(const Num3& p) const { return normals(p); }
};

/// The gauge of points, stretch taken out (below 1 inside the surface) and its change along a direction.
HWY_INLINE Num gaugeAt(const ReflectorMap& map, const Num3& p, const Num3& along, Num& slope) {
    const OnCube at = onCube(p);
    const Surface surface = surfaceAt(map, at);
    const Num3 d = at.axes.in(along);
    slope =
        fma(surface.qS, d.x, fma(surface.qT, d.y, (surface.q - at.s * surface.qS - at.t * surface.qT) * d.z));
    return at.largest * surface.q;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
