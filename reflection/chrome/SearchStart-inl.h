// Per-instruction-set part of the reflection-point search: first guesses, for a vector of vertices. Included
// once per target by ReflectionSearch.cpp.
#if defined(REFLECTION_CHROME_SEARCH_START_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef REFLECTION_CHROME_SEARCH_START_INL_H
#undef REFLECTION_CHROME_SEARCH_START_INL_H
#else
#define REFLECTION_CHROME_SEARCH_START_INL_H
#endif

#include "reflection/chrome/MapLanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Nearer to the surface than this gauge, a vertex (or the eye) starts from the mirror point of the tangent
/// plane under it: there the surface bends by less than the bisector turns along it.
constexpr double closeGauge = 1.5;

/// Squared sine between bisector and normal at a start above which the line of sight's deepest point is tried
/// too: where the vertex is about to go behind the reflector, that point is the solution.
constexpr double poorStart = 0.5;

/// What all vertices of a search share.
struct EyeSide {
    glm::dvec3 eye, unit, foot, normal;
    double gauge;

    EyeSide(const ReflectorMap& map, const glm::dvec3& at) : eye(at) {
        const ReflectorMap::Sample under = map.sample(at);
        const double length = glm::length(at);
        unit = length > 0 ? at / length : glm::dvec3(0);
        foot = under.position;
        normal = under.normal;
        gauge = under.gauge;
    }
};

/// Where the plane mirrors the vertex; `works` where both are in front of it.
HWY_INLINE Num3 planeMirror(const Num3& foot, const Num3& normal, const Num3& eye, const Num3& vertex,
                            MD& works) {
    const Num a = dot(eye - foot, normal), b = dot(vertex - foot, normal);
    works = hn::And(a > num(0), b >= num(0));
    const Num3 eyeFoot = eye - a * normal, vertexFoot = vertex - b * normal;
    return vertexFoot + (b / (a + b)) * (eyeFoot - vertexFoot);
}

/// The direction that a table of normals has for the bisector seen from the centre, stretch taken out.
HWY_INLINE Num3 startFromTable(std::span<const glm::vec3> normals, const EyeSide& eyeSide,
                               const Num3& vertex) {
    const Doubles tag;
    const Num length = root(dot(vertex, vertex));
    const Num3 bisector = num3(eyeSide.unit) + (num(1) / most(length, num(1e-300))) * vertex;
    const OnCube at = onCube(bisector);
    const double side = ReflectorMap::normalTableSide;
    const auto texel = [&](Num x) {
        return least(most(Num{hn::Floor(((x + num(1)) * num(0.5 * side)).v)}, num(0)), num(side - 1));
    };
    const Num index = fma(fma(Num{at.face}, num(side), texel(at.t)), num(side), texel(at.s));
    const auto first = hn::DemoteTo(HalfInts(), (num(3) * index).v);
    const float* table = &normals.front().x;
    const auto load = [&](int component) {
        return Num{hn::PromoteTo(tag, hn::GatherIndex(HalfFloats(), table + component, first))};
    };
    return {load(0), load(1), load(2)};
}

/// Directions from the centre to start from, stretch taken out.
HWY_INLINE Num3 startFor(const ReflectorMap& map, const EyeSide& eyeSide, const Num3& vertex) {
    const Doubles tag;
    Num3 start = startFromTable(map.normalTable(), eyeSide, vertex);
    const Num3 eye = num3(eyeSide.eye);
    const Stretch stretch(map);
    MD works;
    if (eyeSide.gauge < closeGauge) {
        const Num3 mirror = planeMirror(num3(eyeSide.foot), num3(eyeSide.normal), eye, vertex, works);
        start = choose(works, stretch.takeOut(mirror), start);
    }
    const Num3 inCube = stretch.takeOut(vertex);
    const double reach = closeGauge * map.outerRadius();
    const MD near = dot(inCube, inCube) < num(reach * reach);
    if (!hn::AllFalse(tag, near)) {
        const OnCube under = onCube(inCube);
        const Surface surface = surfaceAt(map, under);
        const Num3 foot =
            stretch.positions(under.axes.out((num(1) / surface.q) * Num3{under.s, under.t, num(1)}));
        const Num3 upright = stretch.normals(under.axes.out(surface.m));
        const Num3 normal = (num(1) / root(dot(upright, upright))) * upright;
        const Num gauge = under.largest * surface.q;
        const Num3 mirror = planeMirror(foot, normal, eye, vertex, works);
        works = hn::And(works, gauge < num(std::min(closeGauge, eyeSide.gauge)));
        start = choose(works, stretch.takeOut(mirror), start);
    }
    return start;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
