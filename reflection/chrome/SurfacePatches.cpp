// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/SurfacePatches.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reflection/chrome/SurfacePatches.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/chrome/ReflectorMap.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void patchesThatMayReflect(const SurfacePatches& patches, const glm::vec3& eye, const glm::vec3& vertex,
                           std::vector<std::uint32_t>& to) {
    const hn::CappedTag<float, SurfacePatches::padding> tag;
    using V = hn::Vec<decltype(tag)>;
    using P = SurfacePatches;
    const V one = hn::Set(tag, 1.f), tiny = hn::Set(tag, 1e-30f);
    // The chord of an angle whose sine is below 0.77 is less than 1.09 times the sine; a hundredth for
    // rounding.
    const V chords = hn::Set(tag, 1.1f), wide = hn::Set(tag, 0.77f), rounding = hn::Set(tag, 1e-4f);
    struct Towards {
        V x, y, z, sine;
    };
    for (std::size_t k = 0; k < patches.size(); k += hn::Lanes(tag)) {
        const auto load = [&](P::Row r) { return hn::LoadU(tag, patches.row(r) + k); };
        const V cx = load(P::centreX), cy = load(P::centreY), cz = load(P::centreZ), radius = load(P::radius);
        const auto towards = [&](const glm::vec3& p) {
            const V x = hn::Sub(hn::Set(tag, p.x), cx), y = hn::Sub(hn::Set(tag, p.y), cy),
                    z = hn::Sub(hn::Set(tag, p.z), cz);
            const V per =
                hn::Div(one, hn::Sqrt(hn::Max(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))), tiny)));
            return Towards{hn::Mul(x, per), hn::Mul(y, per), hn::Mul(z, per), hn::Mul(radius, per)};
        };
        const Towards o = towards(eye), v = towards(vertex);
        const V hx = hn::Add(o.x, v.x), hy = hn::Add(o.y, v.y), hz = hn::Add(o.z, v.z);
        const V per =
            hn::Div(one, hn::Sqrt(hn::Max(hn::MulAdd(hx, hx, hn::MulAdd(hy, hy, hn::Mul(hz, hz))), tiny)));
        // Sine of the bisector's turn within the ball.
        const V turn = hn::MulAdd(hn::Mul(chords, hn::Add(o.sine, v.sine)), per, rounding);
        const V still = hn::Sqrt(hn::Max(hn::NegMulAdd(turn, turn, one), hn::Zero(tag)));
        const V along = hn::Mul(
            per, hn::MulAdd(hx, load(P::axisX), hn::MulAdd(hy, load(P::axisY), hn::Mul(hz, load(P::axisZ)))));
        const V least = hn::NegMulAdd(load(P::sine), turn, hn::Mul(load(P::cosine), still));
        const auto near = hn::Or(hn::Ge(hn::Max(o.sine, v.sine), wide), hn::Ge(turn, one));
        const auto may = hn::Or(near, hn::Ge(hn::Add(along, rounding), least));
        if (hn::AllFalse(tag, may)) continue;
        HWY_ALIGN float flags[SurfacePatches::padding];
        hn::Store(hn::IfThenElseZero(may, one), tag, flags);
        for (std::size_t lane = 0; lane < hn::Lanes(tag) && k + lane < patches.size(); ++lane)
            if (flags[lane] > 0) to.push_back(static_cast<std::uint32_t>(k + lane));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(patchesThatMayReflect);

namespace {

/// Patches to a face's side, at most.
constexpr int patchesPerSide = 16;
constexpr float larger = 1.1f;

}  // namespace

SurfacePatches::SurfacePatches(const ReflectorMap& map) {
    const int cells = map.cellsPerSide();
    const int step = std::max(1, cells / patchesPerSide);
    const glm::dvec3& stretch = map.frame().stretch;
    std::vector<glm::vec3> points, normals;
    for (int face = 0; face < 6; ++face)
        for (int top = 0; top < cells; top += step)
            for (int left = 0; left < cells; left += step) {
                const int bottom = std::min(top + step, cells), right = std::min(left + step, cells);
                points.clear(), normals.clear();
                glm::vec3 low(INFINITY), high(-INFINITY), sum(0);
                for (int row = top; row <= bottom; ++row)
                    for (int column = left; column <= right; ++column) {
                        const glm::dvec3 g = ReflectorMap::cornerPoint(cells, face, column, row);
                        const glm::dvec4 c(
                            map.corners()[ReflectorMap::cornerIndex(cells, face, column, row)]);
                        const glm::vec3 p(stretch * g / (c.w * glm::dot(glm::dvec3(c), g)));
                        points.push_back(p);
                        normals.push_back(glm::vec3(glm::normalize(glm::dvec3(c) / stretch)));
                        sum += normals.back();
                        low = glm::min(low, p), high = glm::max(high, p);
                    }
                const glm::vec3 centre = 0.5f * (low + high);
                const glm::vec3 axis = glm::length(sum) > 1e-3f ? glm::normalize(sum) : glm::vec3(0, 0, 1);
                float far = 0, spread = 0;
                for (std::size_t k = 0; k < points.size(); ++k) {
                    far = std::max(far, glm::length(points[k] - centre));
                    const float along = std::clamp(glm::dot(axis, normals[k]), -1.f, 1.f);
                    spread = std::max(spread, std::acos(along));
                }
                starts.push_back(
                    glm::vec3(ReflectorMap::cornerPoint(2 * cells, face, left + right, top + bottom)));
                // Where normals go all round, no cone tells.
                const float ball = spread < 1.5f ? larger * far : 1e30f;
                const float values[rows]{centre.x, centre.y,         centre.z,        ball, axis.x, axis.y,
                                         axis.z,   std::cos(spread), std::sin(spread)};
                for (std::size_t r = 0; r < rows; ++r) numbers[r].push_back(values[r]);
            }
    for (std::vector<float>& n : numbers) n.resize(n.size() + padding, 0.f);
}

void SurfacePatches::mayReflect(const glm::dvec3& eye, const glm::dvec3& vertex,
                                std::vector<std::uint32_t>& to) const {
    to.clear();
    // Squares of what is farther overflow; from there directions are all the same.
    const auto within = [](const glm::dvec3& p) {
        const double length = glm::length(p);
        return glm::vec3(length > 1e9 ? 1e9 / length * p : p);
    };
    HWY_DYNAMIC_DISPATCH(patchesThatMayReflect)(*this, within(eye), within(vertex), to);
}

}  // namespace reflection
#endif
