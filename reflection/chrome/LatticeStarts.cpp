// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/LatticeStarts.cpp"
#include <hwy/foreach_target.h>

#include "reflection/chrome/LatticeStarts.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "reflection/chrome/MapLanes-inl.h"
#include "reflection/reference_maps/CubeMapping.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// Cells of the lattice to a face's side, at least: a bowl of half a sphere then has a node every six
/// degrees.
constexpr int latticeSide = 16;

/// One face's nodes in rows, with a border that is never best.
struct NodeField {
    static constexpr std::size_t rowLength = 64, mostRows = 34;
    HWY_ALIGN std::array<float, rowLength * mostRows> cosine, acrossS, acrossT;
    static std::size_t at(std::size_t column, std::size_t row) { return (row + 1) * rowLength + column + 1; }
};

/// How bisector and normal lie to each other at the nodes of a face, and the bisector's part along the
/// surface, seen along the face's axes.
inline void fillNodes(const ReflectorMap& map, int face, const Real3<float>& eye, const Real3<float>& vertex,
                      std::size_t step, std::size_t side, NodeField& nodes) {
    const Floats f;
    const std::size_t lanes = hn::Lanes(f);
    const CubeFace& axes = cubeFaces[static_cast<std::size_t>(face)];
    const Real3<float> major = real3<float>(axes.major), sAxis = real3<float>(axes.sAxis),
                       tAxis = real3<float>(axes.tAxis);
    const StretchOf<float> stretch(map);
    const Real<float> one = real<float>(1), tiny = real<float>(tinyOf<float>);
    const double cells = map.cellsPerSide(), spacing = 2.0 * static_cast<double>(step) / cells;
    const float* base = reinterpret_cast<const float*>(map.corners().data());
    HWY_ALIGN std::array<std::int32_t, 16> offsets;
    for (std::size_t row = 0; row < side; ++row) {
        const Real3<float> atT = major + real<float>(spacing * static_cast<double>(row) - 1) * tAxis;
        for (std::size_t first = 0; first < side; first += lanes) {
            for (std::size_t k = 0; k < lanes; ++k)
                offsets[k] = static_cast<std::int32_t>(
                    4 * ReflectorMap::cornerIndex(map.cellsPerSide(), face,
                                                  static_cast<int>(std::min(first + k, side - 1) * step),
                                                  static_cast<int>(row * step)));
            const Real<float> columns{
                hn::ConvertTo(f, hn::Iota(hn::RebindToSigned<Floats>(), static_cast<std::int32_t>(first)))};
            const Real3<float> g = atT + (real<float>(spacing) * columns - one) * sAxis;
            Real3<float> m;
            Real<float> c;
            CornerLanes::load(f, base, offsets.data(), m.x.v, m.y.v, m.z.v, c.v);
            const Real3<float> p = (one / (c * dot(m, g))) * stretch.positions(g);
            const Real3<float> upright = stretch.normals(m);
            const Real3<float> n = (one / root(dot(upright, upright))) * upright;
            const Real3<float> o = eye - p, v = vertex - p;
            const Real3<float> h =
                (one / most(root(dot(o, o)), tiny)) * o + (one / most(root(dot(v, v)), tiny)) * v;
            const Real<float> along = dot(h, n);
            const Real3<float> across = stretch.normals(h - along * n);
            const std::size_t to = NodeField::at(first, row);
            hn::StoreU((along / most(root(dot(h, h)), tiny)).v, f, &nodes.cosine[to]);
            hn::StoreU(dot(across, sAxis).v, f, &nodes.acrossS[to]);
            hn::StoreU(dot(across, tAxis).v, f, &nodes.acrossT[to]);
        }
        std::fill_n(&nodes.cosine[NodeField::at(side, row)], NodeField::rowLength - side - 1, -2.f);
    }
    std::fill_n(&nodes.cosine[NodeField::at(0, side)], NodeField::rowLength - 1, -2.f);
}

/// How often a field turns from one corner of a cell to the next: crossings of the positive first axis.
HWY_INLINE Real<float> crossings(Real<float> aS, Real<float> aT, Real<float> bS, Real<float> bT) {
    const Real<float> zero = real<float>(0), one = real<float>(1);
    const MF up = hn::And(aT <= zero, bT > zero), down = hn::And(aT > zero, bT <= zero);
    const Real<float> turn = aS * bT - aT * bS;
    return choose(hn::And(up, turn > zero), one, choose(hn::And(down, turn < zero), -one, zero));
}

void findStarts(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                std::vector<glm::dvec3>& starts) {
    const Floats f;
    const std::size_t lanes = hn::Lanes(f);
    const int cells = map.cellsPerSide();
    const auto step = static_cast<std::size_t>(std::max(1, cells / latticeSide));
    const std::size_t side = static_cast<std::size_t>(cells) / step + 1;
    const Real<float> zero = real<float>(0);
    NodeField nodes;
    std::fill(nodes.cosine.begin(), nodes.cosine.end(), -2.f);
    std::fill(nodes.acrossS.begin(), nodes.acrossS.end(), 0.f);
    std::fill(nodes.acrossT.begin(), nodes.acrossT.end(), 0.f);
    const auto load = [&](const auto& of, std::size_t at) { return Real<float>{hn::LoadU(f, &of[at])}; };
    for (int face = 0; face < 6; ++face) {
        fillNodes(map, face, real3<float>(eye), real3<float>(vertex), step, side, nodes);
        for (std::size_t row = 0; row < side; ++row)
            for (std::size_t first = 0; first < side; first += lanes) {
                const std::size_t at = NodeField::at(first, row), below = at + NodeField::rowLength,
                                  above = at - NodeField::rowLength;
                const auto cosine = [&](std::size_t where) { return load(nodes.cosine, where); };
                const Real<float> own = cosine(at), b = cosine(at + 1), c = cosine(below + 1),
                                  d = cosine(below);
                const Real<float> around = most(
                    most(most(cosine(above - 1), cosine(above)), most(cosine(above + 1), cosine(at - 1))),
                    most(most(b, cosine(below - 1)), most(c, d)));
                const MF facing = own > zero;
                const MF best = hn::And(facing, around <= own);
                MF turns = hn::And(hn::And(facing, b > zero), hn::And(c > zero, d > zero));
                if (!hn::AllFalse(f, turns)) {
                    const auto s = [&](std::size_t where) { return load(nodes.acrossS, where); };
                    const auto t = [&](std::size_t where) { return load(nodes.acrossT, where); };
                    const auto turn = [&](std::size_t from, std::size_t to) {
                        return crossings(s(from), t(from), s(to), t(to));
                    };
                    const Real<float> sum =
                        turn(at, at + 1) + turn(at + 1, below + 1) + turn(below + 1, below) + turn(below, at);
                    turns = hn::And(turns, size(sum) > real<float>(0.5));
                }
                if (hn::AllFalse(f, hn::Or(best, turns))) continue;
                HWY_ALIGN std::array<float, 16> isBest, isTurning;
                hn::Store(hn::IfThenElseZero(best, hn::Set(f, 1.f)), f, isBest.data());
                hn::Store(hn::IfThenElseZero(turns, hn::Set(f, 1.f)), f, isTurning.data());
                for (std::size_t k = 0; k < lanes && first + k < side; ++k) {
                    const int column = static_cast<int>((first + k) * step),
                              atRow = static_cast<int>(row * step);
                    const int half = static_cast<int>(step);
                    if (isBest[k] > 0)
                        starts.push_back(ReflectorMap::cornerPoint(cells, face, column, atRow));
                    if (isTurning[k] > 0)
                        starts.push_back(
                            ReflectorMap::cornerPoint(2 * cells, face, 2 * column + half, 2 * atRow + half));
                }
            }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(findStarts);

std::vector<glm::dvec3> latticeStarts(const ReflectorMap& map, const glm::dvec3& eye,
                                      const glm::dvec3& vertex) {
    std::vector<glm::dvec3> starts;
    HWY_DYNAMIC_DISPATCH(findStarts)(map, eye, vertex, starts);
    return starts;
}

}  // namespace reflection
#endif
