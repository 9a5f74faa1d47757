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
template <class T>
HWY_INLINE Real3<T> planeMirror(const Real3<T>& foot, const Real3<T>& normal, const Real3<T>& eye,
                                const Real3<T>& vertex, MaskOf<T>& works) {
    const Real<T> a = dot(eye - foot, normal), b = dot(vertex - foot, normal);
    works = hn::And(a > real<T>(0), b >= real<T>(0));
    const Real3<T> eyeFoot = eye - a * normal, vertexFoot = vertex - b * normal;
    return vertexFoot + (b / (a + b)) * (eyeFoot - vertexFoot);
}

/// The direction that a table of normals has for the bisector seen from the centre, stretch taken out.
template <class T>
HWY_INLINE Real3<T> startFromTable(std::span<const glm::vec3> normals, const EyeSide& eyeSide,
                                   const Real3<T>& vertex) {
    const LanesOf<T> tag;
    const Real<T> length = root(dot(vertex, vertex));
    const Real3<T> bisector =
        real3<T>(eyeSide.unit) + (real<T>(1) / most(length, real<T>(tinyOf<T>))) * vertex;
    const OnCubeOf<T> at = onCube(bisector);
    const double side = ReflectorMap::normalTableSide;
    const auto texel = [&](Real<T> x) {
        return least(most(Real<T>{hn::Floor(((x + real<T>(1)) * real<T>(0.5 * side)).v)}, real<T>(0)),
                     real<T>(side - 1));
    };
    const Real<T> index = fma(fma(Real<T>{at.face}, real<T>(side), texel(at.t)), real<T>(side), texel(at.s));
    const float* table = &normals.front().x;
    const Real<T> first = real<T>(3) * index;
    const auto load = [&](int component) -> Real<T> {
        if constexpr (sizeof(T) == 8)
            return {hn::PromoteTo(
                tag, hn::GatherIndex(HalfFloats(), table + component, hn::DemoteTo(HalfInts(), first.v)))};
        else
            return {hn::GatherIndex(tag, table + component,
                                    hn::ConvertTo(hn::Rebind<std::int32_t, LanesOf<T>>(), first.v))};
    };
    return {load(0), load(1), load(2)};
}

/// Directions from the centre to start from, stretch taken out.
template <class T>
HWY_INLINE Real3<T> startFor(const ReflectorMap& map, const EyeSide& eyeSide, const Real3<T>& vertex) {
    const LanesOf<T> tag;
    Real3<T> start = startFromTable(map.normalTable(), eyeSide, vertex);
    const Real3<T> eye = real3<T>(eyeSide.eye);
    const StretchOf<T> stretch(map);
    MaskOf<T> works;
    if (eyeSide.gauge < closeGauge) {
        const Real3<T> mirror =
            planeMirror(real3<T>(eyeSide.foot), real3<T>(eyeSide.normal), eye, vertex, works);
        start = choose(works, stretch.takeOut(mirror), start);
    }
    const Real3<T> inCube = stretch.takeOut(vertex);
    const double reach = closeGauge * map.outerRadius();
    const MaskOf<T> near = dot(inCube, inCube) < real<T>(reach * reach);
    if (!hn::AllFalse(tag, near)) {
        const OnCubeOf<T> under = onCube(inCube);
        Real<T> q;
        Real3<T> m;
        placeAt(map, under, q, m);
        const Real3<T> foot =
            stretch.positions(under.axes.out((real<T>(1) / q) * Real3<T>{under.s, under.t, real<T>(1)}));
        const Real3<T> upright = stretch.normals(under.axes.out(m));
        const Real3<T> normal = (real<T>(1) / root(dot(upright, upright))) * upright;
        const Real<T> gauge = under.largest * q;
        const Real3<T> mirror = planeMirror(foot, normal, eye, vertex, works);
        works = hn::And(works, gauge < real<T>(std::min(closeGauge, eyeSide.gauge)));
        start = choose(works, stretch.takeOut(mirror), start);
    }
    return start;
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();
#endif
