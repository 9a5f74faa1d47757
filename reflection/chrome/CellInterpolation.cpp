// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/CellInterpolation.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reflection/chrome/CellInterpolation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Four floats of which the last one's low byte is the status.
static_assert(sizeof(VirtualVertex) == 16 && offsetof(VirtualVertex, status) == 12 &&
              std::endian::native == std::endian::little);

using Floats = hn::CappedTag<float, CellTree::padding>;
using V = hn::Vec<Floats>;

/// Weights of both ends of an axis: of values, what values get besides, of slopes.
struct Axis {
    V share0, share1, more0, more1, slope0, slope1;

    HWY_INLINE Axis(V u, float side, float bent) {
        const Floats tag;
        const V one = hn::Set(tag, 1.f);
        const V rest = hn::Sub(one, u);
        const V bend = hn::Mul(hn::Set(tag, bent), hn::NegMulAdd(hn::Set(tag, 2.f), u, one));
        share0 = rest, share1 = u;
        more0 = hn::Mul(u, bend), more1 = hn::Neg(hn::Mul(rest, bend));
        slope0 = hn::Mul(hn::Mul(u, rest), hn::Set(tag, bent * side)), slope1 = hn::Neg(slope0);
    }
};

struct Four {
    V x, y, z, w;

    HWY_INLINE void add(V weight, const glm::vec4& value) {
        const Floats tag;
        x = hn::MulAdd(weight, hn::Set(tag, value.x), x);
        y = hn::MulAdd(weight, hn::Set(tag, value.y), y);
        z = hn::MulAdd(weight, hn::Set(tag, value.z), z);
        w = hn::MulAdd(weight, hn::Set(tag, value.w), w);
    }
};

/// What the node at one corner adds. Corners are told apart while compiling, so that weights stay in
/// registers.
template <int corner>
HWY_INLINE void addCorner(Four& sum, const PathImage& node, const Axis& x, const Axis& y, const Axis& z) {
    constexpr bool farX = (corner & 1) != 0, farY = (corner & 2) != 0, farZ = (corner & 4) != 0;
    const V w =
        hn::Mul(farX ? x.share1 : x.share0, hn::Mul(farY ? y.share1 : y.share0, farZ ? z.share1 : z.share0));
    const V more =
        hn::Add(farX ? x.more1 : x.more0, hn::Add(farY ? y.more1 : y.more0, farZ ? z.more1 : z.more0));
    sum.add(hn::MulAdd(w, more, w), node.image);
    sum.add(hn::Mul(w, farX ? x.slope1 : x.slope0), node.by[0]);
    sum.add(hn::Mul(w, farY ? y.slope1 : y.slope0), node.by[1]);
    sum.add(hn::Mul(w, farZ ? z.slope1 : z.slope0), node.by[2]);
}

/// Has memory that is about to be used brought into the cache: what the last update left there is gone by the
/// next, and cells and vertices are in no order that the processor foresees.
template <class T>
void fetchSoon(const T* first, std::size_t count) {
    constexpr std::size_t line = 64;
    const char* at = reinterpret_cast<const char*>(first);
    for (std::size_t k = 0; k < count * sizeof(T); k += line) hwy::Prefetch(at + k);
}

void interpolateLanes(const CellTree& tree, const PathImage* atNodes, std::span<const SmoothCell> cells,
                      std::span<VirtualVertex> image, std::vector<std::uint32_t>& doubtful) {
    const Floats tag;
    const std::size_t lanes = hn::Lanes(tag);
    const std::uint32_t* order = tree.order().data();
    fetchSoon(order, tree.order().size());
    for (int a = 0; a < 3; ++a) fetchSoon(tree.along(a), tree.order().size());
    fetchSoon(image.data(), image.size());
    HWY_ALIGN std::array<float, 4 * CellTree::padding> out;
    for (const SmoothCell& s : cells) {
        const CellTree::Cell& cell = tree.cells()[s.cell];
        const glm::vec3& side = tree.side(cell.level);
        const std::array<std::uint32_t, 8>& n = cell.nodes;
        const bool mixed = s.status == ReflectionStatus::invalid;
        const V status = hn::Set(tag, std::bit_cast<float>(static_cast<std::uint32_t>(s.status)));
        for (std::uint32_t k = cell.first; k < cell.last; k += static_cast<std::uint32_t>(lanes)) {
            const auto axis = [&](int a) {
                return Axis(hn::Mul(hn::Sub(hn::LoadU(tag, tree.along(a) + k), hn::Set(tag, cell.low[a])),
                                    hn::Set(tag, side[a] > 0 ? 1 / side[a] : 0.f)),
                            side[a], s.straight ? 0.f : 1.f);
            };
            const Axis x = axis(0), y = axis(1), z = axis(2);
            Four sum{hn::Zero(tag), hn::Zero(tag), hn::Zero(tag), hn::Zero(tag)};
            addCorner<0>(sum, atNodes[n[0]], x, y, z);
            addCorner<1>(sum, atNodes[n[1]], x, y, z);
            addCorner<2>(sum, atNodes[n[2]], x, y, z);
            addCorner<3>(sum, atNodes[n[3]], x, y, z);
            addCorner<4>(sum, atNodes[n[4]], x, y, z);
            addCorner<5>(sum, atNodes[n[5]], x, y, z);
            addCorner<6>(sum, atNodes[n[6]], x, y, z);
            addCorner<7>(sum, atNodes[n[7]], x, y, z);
            const std::uint32_t count =
                std::min<std::uint32_t>(static_cast<std::uint32_t>(lanes), cell.last - k);
            if (mixed) {
                hn::StoreInterleaved4(sum.x, sum.y, sum.z, sum.w, tag, out.data());
                for (std::uint32_t lane = 0; lane < count; ++lane) {
                    float& cosine = out[4 * lane + 3];
                    if (!(std::abs(cosine) > s.doubt)) doubtful.push_back(k + lane);
                    cosine = std::bit_cast<float>(static_cast<std::uint32_t>(
                        cosine > 0 ? ReflectionStatus::found : ReflectionStatus::hidden));
                }
            } else {
                hn::StoreInterleaved4(sum.x, sum.y, sum.z, status, tag, out.data());
            }
            for (std::uint32_t lane = 0; lane < count; ++lane)
                std::memcpy(static_cast<void*>(&image[order[k + lane]]), out.data() + 4 * lane,
                            sizeof(VirtualVertex));
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(interpolateLanes);

void interpolateCells(const CellTree& tree, std::span<const PathImage> atNodes,
                      std::span<const SmoothCell> cells, std::span<VirtualVertex> image,
                      std::vector<std::uint32_t>& doubtful) {
    HWY_DYNAMIC_DISPATCH(interpolateLanes)(tree, atNodes.data(), cells, image, doubtful);
}

glm::vec4 interpolateIn(const CellTree& tree, std::span<const PathImage> atNodes, const CellTree::Cell& cell,
                        const glm::vec3& place) {
    const glm::vec3& side = tree.side(cell.level);
    std::array<float, 3> at{};
    for (int a = 0; a < 3; ++a)
        at[static_cast<std::size_t>(a)] = side[a] > 0 ? (place[a] - cell.low[a]) / side[a] : 0;
    glm::vec4 sum(0);
    for (std::size_t i = 0; i < 8; ++i) {
        const PathImage& node = atNodes[cell.nodes[i]];
        float w = 1, more = 1;
        std::array<float, 3> slope{};
        for (std::size_t a = 0; a < 3; ++a) {
            const bool far = ((i >> a) & 1) != 0;
            const float u = at[a], bend = 1 - 2 * u;
            w *= far ? u : 1 - u;
            more += far ? -(1 - u) * bend : u * bend;
            slope[a] = (far ? -u : u) * (1 - u) * side[static_cast<int>(a)];
        }
        glm::vec4 v = more * node.image;
        for (std::size_t a = 0; a < 3; ++a) v += slope[a] * node.by[a];
        sum += w * v;
    }
    return sum;
}

}  // namespace reflection
#endif
