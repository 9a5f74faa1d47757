// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/SurfacePatches.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reflection/chrome/SurfacePatches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "reflection/chrome/ReflectorMap.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Six faces, at most 63 patches to a side, 16 to a block's.
constexpr std::size_t mostBlocks = 6 * 4 * 4;

/// Whether a bisector can be the normal, for as many patches (or groups of them) as a vector has lanes.
class PatchTest {
  public:
    using Tag = hn::CappedTag<float, SurfacePatches::padding>;
    using V = hn::Vec<Tag>;

    PatchTest(const SurfacePatches& patches, const glm::vec3& eye, const glm::vec3& vertex)
        : patches_(patches), eye_(eye), vertex_(vertex) {}

    /// Adds those of the patches `first` to `first + count` (a multiple of lanes) that may, less `first`,
    /// plus `base`. Full vectors are written past the end.
    HWY_INLINE std::uint32_t* add(std::size_t first, std::size_t count, std::size_t base,
                                  std::uint32_t* to) const {
        const Tag tag;
        const hn::Rebind<std::uint32_t, Tag> numbers;
        for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
            const auto may = mayReflect(first + k);
            const auto own = hn::Iota(numbers, static_cast<std::uint32_t>(base + k));
            hn::StoreU(hn::Compress(own, hn::RebindMask(numbers, may)), numbers, to);
            to += hn::CountTrue(tag, may);
        }
        return to;
    }

  private:
    struct Towards {
        V x, y, z, sine;
    };
    /// One over the root, to a millionth: what a processor guesses to a thousandth or better, and a Newton
    /// step.
    static HWY_INLINE V perRoot(V n) {
        const Tag tag;
        const V at = hn::Max(n, hn::Set(tag, 1e-30f));
        const V guess = hn::ApproximateReciprocalSqrt(at);
        return hn::Mul(
            guess, hn::NegMulAdd(hn::Mul(hn::Mul(hn::Set(tag, 0.5f), at), guess), guess, hn::Set(tag, 1.5f)));
    }
    HWY_INLINE hn::Mask<Tag> mayReflect(std::size_t k) const {
        using P = SurfacePatches;
        const Tag tag;
        const V one = hn::Set(tag, 1.f), tiny = hn::Set(tag, 1e-30f);
        // The chord of an angle whose sine is below 0.77 is less than 1.09 times the sine; a hundredth for
        // rounding.
        const V chords = hn::Set(tag, 1.1f), wide = hn::Set(tag, 0.77f), rounding = hn::Set(tag, 1e-4f);
        const auto load = [&](P::Row r) { return hn::LoadU(tag, patches_.row(r) + k); };
        const V cx = load(P::centreX), cy = load(P::centreY), cz = load(P::centreZ), radius = load(P::radius);
        const auto towards = [&](const glm::vec3& p) {
            const V x = hn::Sub(hn::Set(tag, p.x), cx), y = hn::Sub(hn::Set(tag, p.y), cy),
                    z = hn::Sub(hn::Set(tag, p.z), cz);
            const V per = perRoot(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
            return Towards{hn::Mul(x, per), hn::Mul(y, per), hn::Mul(z, per), hn::Mul(radius, per)};
        };
        const Towards o = towards(eye_), v = towards(vertex_);
        const V hx = hn::Add(o.x, v.x), hy = hn::Add(o.y, v.y), hz = hn::Add(o.z, v.z);
        const V per = perRoot(hn::MulAdd(hx, hx, hn::MulAdd(hy, hy, hn::Mul(hz, hz))));
        // Sine of the bisector's turn within the ball.
        const V turn = hn::MulAdd(hn::Mul(chords, hn::Add(o.sine, v.sine)), per, rounding);
        const V squared = hn::Max(hn::NegMulAdd(turn, turn, one), tiny);
        const V still = hn::Mul(squared, perRoot(squared));
        const V along = hn::Mul(
            per, hn::MulAdd(hx, load(P::axisX), hn::MulAdd(hy, load(P::axisY), hn::Mul(hz, load(P::axisZ)))));
        const V cosine = load(P::cosine);
        const V least = hn::NegMulAdd(load(P::sine), turn, hn::Mul(cosine, still));
        const auto near = hn::Or(hn::Ge(hn::Max(o.sine, v.sine), wide), hn::Ge(turn, one));
        // Padding has no cosine.
        return hn::And(hn::Or(near, hn::Ge(hn::Add(along, rounding), least)), hn::Le(cosine, one));
    }

    const SurfacePatches& patches_;
    glm::vec3 eye_, vertex_;
};

/// Blocks of four by four groups first, then groups of four by four patches, then patches.
void patchesThatMayReflect(const SurfacePatches& patches, const glm::vec3& eye, const glm::vec3& vertex,
                           std::vector<std::uint32_t>& to) {
    constexpr std::size_t each = SurfacePatches::padding;
    const std::size_t groups = patches.size(), blocks = groups + groups / each;
    const std::size_t count = groups / (each * each);
    const PatchTest test(patches, eye, vertex);
    // Vectors that grow are not made larger element by element.
    std::array<std::uint32_t, mostBlocks + each> inBlocks;
    std::array<std::uint32_t, mostBlocks * each + each> inGroups;
    const std::uint32_t* lastBlock = test.add(blocks, (count + each - 1) / each * each, 0, inBlocks.data());
    std::uint32_t* lastGroup = inGroups.data();
    for (const std::uint32_t* b = inBlocks.data(); b < lastBlock; ++b)
        lastGroup = test.add(groups + *b * each, each, *b * each, lastGroup);
    const auto groupCount = static_cast<std::size_t>(lastGroup - inGroups.data());
    to.resize(std::max(to.size(), (groupCount + 1) * each));
    std::uint32_t* last = to.data();
    for (const std::uint32_t* g = inGroups.data(); g < lastGroup; ++g)
        last = test.add(*g * each, each, *g * each, last);
    to.resize(static_cast<std::size_t>(last - to.data()));
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(patchesThatMayReflect);

namespace {

/// Patches to a face's side, at most or nearly: of two cells by two.
constexpr int patchesPerSide = 32;
constexpr float larger = 1.1f;
constexpr float endless = 1e30f;
/// A cosine that no angle has: padding.
constexpr float noCosine = 4;

/// A ball around points and a cone around normals.
struct PatchBounds {
    glm::vec3 centre{0}, axis{0};
    float radius = 0, spread = 0;
    bool empty = true;

    /// Where normals go all round, no cone tells.
    float ball() const { return spread < 1.5f ? radius : endless; }
};

PatchBounds boundsOf(std::span<const PatchBounds> parts) {
    PatchBounds all;
    glm::vec3 low(INFINITY), high(-INFINITY), sum(0);
    for (const PatchBounds& p : parts) {
        if (p.empty) continue;
        all.empty = false;
        low = glm::min(low, p.centre - p.radius), high = glm::max(high, p.centre + p.radius);
        sum += p.axis;
    }
    if (all.empty) return all;
    all.centre = 0.5f * (low + high);
    all.axis = glm::length(sum) > 1e-3f ? glm::normalize(sum) : glm::vec3(0, 0, 1);
    for (const PatchBounds& p : parts) {
        if (p.empty) continue;
        all.radius = std::max(all.radius, glm::length(p.centre - all.centre) + p.radius);
        const float along = std::clamp(glm::dot(all.axis, p.axis), -1.f, 1.f);
        all.spread = std::max(all.spread, std::acos(along) + p.spread);
    }
    return all;
}

PatchBounds boundsOfCells(const ReflectorMap& map, int face, int left, int right, int top, int bottom) {
    const int cells = map.cellsPerSide();
    std::vector<PatchBounds> corners;
    for (int row = top; row <= bottom; ++row)
        for (int column = left; column <= right; ++column) {
            const glm::dvec3 g = ReflectorMap::cornerPoint(cells, face, column, row);
            const glm::dvec4 c(map.corners()[ReflectorMap::cornerIndex(cells, face, column, row)]);
            PatchBounds corner;
            corner.centre = glm::vec3(map.frame().stretch * g / (c.w * glm::dot(glm::dvec3(c), g)));
            corner.axis = glm::vec3(glm::normalize(glm::dvec3(c) / map.frame().stretch));
            corner.empty = false;
            corners.push_back(corner);
        }
    PatchBounds bounds = boundsOf(corners);
    bounds.radius *= larger;
    return bounds;
}

}  // namespace

SurfacePatches::SurfacePatches(const ReflectorMap& map) {
    // Nobody asks for those of convex pieces.
    if (map.bend() == Bend::convex) return;
    const int cells = map.cellsPerSide();
    const int step = std::max(1, cells / patchesPerSide);
    const int side = (cells + step - 1) / step, blocks = (side + 15) / 16;
    std::vector<PatchBounds> patches;
    for (int face = 0; face < 6; ++face)
        for (int block = 0; block < blocks * blocks; ++block)
            for (int k = 0; k < 256; ++k) {
                // Within a group, within its block.
                const int column = 16 * (block % blocks) + 4 * (k / 16 % 4) + k % 4;
                const int row = 16 * (block / blocks) + 4 * (k / 64) + k / 4 % 4;
                const int left = step * column, top = step * row;
                const int right = std::min(left + step, cells), bottom = std::min(top + step, cells);
                const bool there = left < cells && top < cells;
                patches.push_back(there ? boundsOfCells(map, face, left, right, top, bottom) : PatchBounds());
                starts.push_back(
                    glm::vec3(ReflectorMap::cornerPoint(2 * cells, face, left + right, top + bottom)));
            }
    std::vector<PatchBounds> all(patches);
    for (const std::size_t of : {padding, padding * padding})
        for (std::size_t k = 0; k < patches.size(); k += of)
            all.push_back(boundsOf(std::span(patches).subspan(k, of)));
    all.resize(all.size() + padding);
    for (const PatchBounds& p : all) {
        const float values[rows]{
            p.centre.x,        p.centre.y, p.centre.z, p.ball(),
            p.axis.x,          p.axis.y,   p.axis.z,   p.empty ? noCosine : std::cos(p.spread),
            std::sin(p.spread)};
        for (std::size_t r = 0; r < rows; ++r) numbers[r].push_back(values[r]);
    }
}

void SurfacePatches::mayReflect(const glm::dvec3& eye, const glm::dvec3& vertex,
                                std::vector<std::uint32_t>& to) const {
    if (starts.empty()) {
        to.clear();
        return;
    }
    // Squares of what is farther overflow; from there directions are all the same.
    const auto within = [](const glm::dvec3& p) {
        const double length = glm::length(p);
        return glm::vec3(length > 1e9 ? 1e9 / length * p : p);
    };
    HWY_DYNAMIC_DISPATCH(patchesThatMayReflect)(*this, within(eye), within(vertex), to);
}

}  // namespace reflection
#endif
