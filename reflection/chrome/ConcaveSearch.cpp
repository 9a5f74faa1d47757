// Compiled once for every instruction set that Highway knows on this architecture; the best is chosen at run
// time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/chrome/ConcaveSearch.cpp"
#include <hwy/foreach_target.h>

#include "reflection/chrome/ConcaveSearch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/chrome/SearchLanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace reflection {
namespace HWY_NAMESPACE {

/// As QuickSearch-inl.h's: descents in floats end here.
constexpr double arriving = 1e-4;
/// When a descent in floats ends. Lengths in half widths of the patch it began in.
struct Patience {
    int lookups;       ///< from within a patch that holds a point Newton steps need four
    double halvings;   ///< in a row
    double nearing;    ///< squared sine from which it goes on in doubles though it did not arrive: two points
                       ///< that are about to become one are approached by halving the way
    double leap;       ///< of its first step, at most
    double wandering;  ///< from the patch's middle, at most
    double outside;    ///< the same once `settling`
    double settling;   ///< squared sine below which Newton steps no longer leave for elsewhere
};
/// What arrives outside its patch is another's.
constexpr Patience brisk{12, 5, 1e-5, 10, 8, 4, 1e-5};
/// Where nothing was found on the part, from patches of the part.
constexpr Patience patient{14, 6, 1e-3, 1e3, 16, 8, 1e-5};

/// Where all points are asked for: wherever descents arrive.
constexpr Patience endless{40, 10, 1e-3, 1e3, 1e3, 1e3, 0};

/// Whether the part covers a corner of a patch.
inline bool onPart(const ReflectorMap& map, std::uint32_t patch) {
    const glm::dvec3 middle(map.patches().start(patch));
    const int cells = map.cellsPerSide(), step = std::max(1, cells / 32);
    for (int face = 0; face < 6; ++face) {
        const glm::dvec3 origin = ReflectorMap::cornerPoint(1, face, 0, 0);
        const glm::dvec3 alongS = 0.5 * (ReflectorMap::cornerPoint(1, face, 1, 0) - origin);
        const glm::dvec3 alongT = 0.5 * (ReflectorMap::cornerPoint(1, face, 0, 1) - origin);
        if (glm::dot(middle, glm::cross(alongS, alongT)) * glm::dot(origin, glm::cross(alongS, alongT)) <
            1 - 1e-6)
            continue;
        const double column = 0.5 * cells * (glm::dot(middle, alongS) + 1),
                     row = 0.5 * cells * (glm::dot(middle, alongT) + 1), half = 0.5 * step;
        const auto at = [&](double x) { return std::clamp(static_cast<int>(x), 0, cells); };
        for (int j = at(std::floor(row - half)); j <= at(std::ceil(row + half)); ++j)
            for (int i = at(std::floor(column - half)); i <= at(std::ceil(column + half)); ++i)
                if (map.coverage()[ReflectorMap::cornerIndex(cells, face, i, j)] != 0) return true;
        return false;
    }
    return true;
}

/// Descents under way: numbers of a vertex and a patch, place, step, error, side by side.
class PatchWalkers {
  public:
    static constexpr std::size_t room = 1024, spare = 16;

    struct End {
        std::uint32_t vertex;
        bool arrived;  ///< else only near
        glm::vec3 at;
    };

    PatchWalkers(const ReflectorMap& map, const glm::dvec3& eye, std::span<const glm::dvec3> vertices,
                 const Patience& patience, std::vector<End>& ends)
        : map_(map), eye_(eye), vertices_(vertices), patience_(patience), ends_(ends) {
        const double step = std::max(1, map.cellsPerSide() / 32);
        halfWidth_ = step / map.cellsPerSide();
    }

    void add(std::uint32_t vertex, std::uint32_t patch) {
        const glm::vec3 v(vertices_[vertex]), start(map_.patches().start(patch));
        vertex_[0][count_] = v.x, vertex_[1][count_] = v.y, vertex_[2][count_] = v.z;
        for (int i = 0; i < 3; ++i) start_[i][count_] = cube_[i][count_] = start[i];
        index_[count_] = static_cast<std::int32_t>(vertex);
        if (++count_ == room) run();
    }

    /// To the end of all.
    void run() {
        for (std::size_t k = count_; k < count_ + spare; ++k) {
            for (auto* of : {&vertex_, &start_, &cube_})
                for (int i = 0; i < 3; ++i) (*of)[i][k] = count_ > 0 ? (*of)[i][0] : 1;
            index_[k] = 0;
        }
        for (std::size_t i = 0; i < 3; ++i) std::fill_n(step_[i].begin(), count_ + spare, 0.f);
        std::fill_n(error_.begin(), count_ + spare, 3.f);
        std::fill_n(halvings_.begin(), count_ + spare, 0.f);
        for (int k = 0; k < patience_.lookups && count_ > 0; ++k) stepAll(k + 1 == patience_.lookups);
        count_ = 0;
    }

  private:
    using Row = std::array<float, room + spare>;
    using Rows = std::array<Row, 3>;

    static HWY_INLINE Real3<float> load(const Rows& from, std::size_t k) {
        const Floats f;
        return {{hn::LoadU(f, &from[0][k])}, {hn::LoadU(f, &from[1][k])}, {hn::LoadU(f, &from[2][k])}};
    }
    HWY_INLINE void stepAll(bool last) {
        const Floats f;
        const hn::Rebind<std::int32_t, Floats> ints;
        const std::size_t lanes = hn::Lanes(f);
        const Real3<float> eye = real3<float>(eye_);
        const Real<float> one = real<float>(1), enough = real<float>(arriving * arriving);
        std::size_t left = 0;
        for (std::size_t first = 0; first < count_; first += lanes) {
            const MF active = hn::FirstN(f, count_ - first);
            const Real3<float> vertex = load(vertex_, first), before = load(cube_, first),
                               start = load(start_, first);
            const Real<float> error{hn::LoadU(f, &error_[first])};
            Real3<float> step = load(step_, first);
            const JudgedOf<float> next = judge(map_, eye, vertex, before + step, false);
            const MF better = next.error < error;
            const Real3<float> cube = choose(better, next.onCube, before);
            step = choose(better, next.step, real<float>(0.5) * step);
            const Real<float> off = choose(better, next.error, error);
            const Real<float> halved =
                choose(better, real<float>(0), Real<float>{hn::LoadU(f, &halvings_[first])} + one);
            const auto index = hn::LoadU(ints, &index_[first]);
            const Real3<float> way = cube - start;
            const Real<float> far = most(size(way.x), most(size(way.y), size(way.z)));
            const MF elsewhere = hn::Or(far > real<float>(patience_.wandering * halfWidth_),
                                        hn::And(off<real<float>(patience_.settling), far> real<float>(
                                            patience_.outside * halfWidth_)));
            const Real<float> leap = most(size(step.x), most(size(step.y), size(step.z)));
            const MF leaves =
                hn::And(error >= real<float>(3), leap > real<float>(patience_.leap * halfWidth_));
            const MF own = hn::AndNot(hn::Or(elsewhere, leaves), active);
            const MF arrived = hn::And(own, off <= enough);
            const MF going = hn::AndNot(arrived, own);
            MF stuck = hn::And(going, halved > real<float>(patience_.halvings));
            if (last) stuck = going;
            end(hn::And(stuck, off < real<float>(patience_.nearing)), cube, index, false);
            end(arrived, cube, index, true);
            const MF on = hn::AndNot(stuck, going);
            if (hn::AllFalse(f, on)) continue;
            const auto put = [&](Real<float> n, Row& to) { hn::StoreU(hn::Compress(n.v, on), f, &to[left]); };
            put(vertex.x, vertex_[0]), put(vertex.y, vertex_[1]), put(vertex.z, vertex_[2]);
            put(start.x, start_[0]), put(start.y, start_[1]), put(start.z, start_[2]);
            put(cube.x, cube_[0]), put(cube.y, cube_[1]), put(cube.z, cube_[2]);
            put(step.x, step_[0]), put(step.y, step_[1]), put(step.z, step_[2]);
            put(off, error_), put(halved, halvings_);
            hn::StoreU(hn::Compress(index, hn::RebindMask(ints, on)), ints, &index_[left]);
            left += hn::CountTrue(f, on);
        }
        count_ = left;
    }
    HWY_INLINE void end(MF which, const Real3<float>& cube, hn::Vec<hn::Rebind<std::int32_t, Floats>> index,
                        bool arrived) {
        const Floats f;
        if (hn::AllFalse(f, which)) return;
        const hn::Rebind<std::int32_t, Floats> ints;
        HWY_ALIGN std::array<float, spare> x, y, z;
        HWY_ALIGN std::array<std::int32_t, spare> number;
        hn::StoreU(hn::Compress(cube.x.v, which), f, x.data());
        hn::StoreU(hn::Compress(cube.y.v, which), f, y.data());
        hn::StoreU(hn::Compress(cube.z.v, which), f, z.data());
        hn::StoreU(hn::Compress(index, hn::RebindMask(ints, which)), ints, number.data());
        const std::size_t n = hn::CountTrue(f, which);
        for (std::size_t k = 0; k < n; ++k)
            ends_.push_back({static_cast<std::uint32_t>(number[k]), arrived, {x[k], y[k], z[k]}});
    }

    const ReflectorMap& map_;
    glm::dvec3 eye_;
    std::span<const glm::dvec3> vertices_;
    Patience patience_;
    std::vector<End>& ends_;
    double halfWidth_ = 0;
    std::size_t count_ = 0;
    HWY_ALIGN Rows vertex_, start_, cube_, step_;
    HWY_ALIGN Row error_, halvings_;
    HWY_ALIGN std::array<std::int32_t, room + spare> index_;
};

inline void polish(const ReflectorMap& map, const glm::dvec3& eye, std::span<const glm::dvec3> vertices,
                   std::span<const PatchWalkers::End> ends, const SearchOptions& options,
                   std::vector<ConcaveEnd>& to) {
    const Doubles tag;
    const std::size_t lanes = hn::Lanes(tag);
    const Num3 eyes = num3(eye);
    const Num enough = num(options.tolerance * options.tolerance);
    for (std::size_t first = 0; first < ends.size(); first += lanes) {
        const std::size_t n = std::min(lanes, ends.size() - first);
        Values3 vertex, start;
        for (std::size_t k = 0; k < lanes; ++k) {
            const PatchWalkers::End& e = ends[first + std::min(k, n - 1)];
            vertex.set(k, vertices[e.vertex]);
            start.set(k, glm::dvec3(e.at));
        }
        const Num3 v = vertex.load();
        Judged best = judge(map, eyes, v, start.load(), false);
        MD walking = best.error > enough;
        if (!hn::AllFalse(tag, walking)) {
            const Judged next = judgeEnd(map, eyes, v, best.onCube + best.step);
            const MD arrived = hn::And(walking, next.error <= enough);
            walking = hn::AndNot(arrived, walking);
            if (!hn::AllFalse(tag, walking))
                best = choose(walking, descend(map, eyes, v, best, walking, options, false).best, best);
            best = choose(arrived, next, best);
        }
        Values3 point, normal;
        Values error, path;
        point.store(best.point), normal.store(best.normal);
        error.store(best.error), path.store(best.path);
        for (std::size_t k = 0; k < n; ++k)
            if (error.at[k] <= options.tolerance * options.tolerance)
                to.push_back({ends[first + k].vertex, point.get(k), normal.get(k), error.at[k], path.at[k]});
    }
}

/// All ends of all vertices, in no order, each several times. Rounds: 0 brisk, 1 patient, 2 endless.
void findEnds(const ReflectorMap& map, const glm::dvec3& eye, std::span<const glm::dvec3> vertices, int round,
              const SearchOptions& options, std::vector<ConcaveEnd>& to) {
    std::vector<PatchWalkers::End> ends;
    PatchWalkers walkers(map, eye, vertices, round == 0 ? brisk : round == 1 ? patient : endless, ends);
    std::vector<std::uint32_t> patches;
    std::vector<char> known(round == 1 ? map.patches().size() : 0, 0);  // 1: on the part, 2: not
    const auto counts = [&](std::uint32_t p) {
        if (round != 1) return true;
        if (known[p] == 0) known[p] = onPart(map, p) ? 1 : 2;
        return known[p] == 1;
    };
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        map.patches().mayReflect(eye, vertices[k], patches);
        for (const std::uint32_t p : patches)
            if (counts(p)) walkers.add(static_cast<std::uint32_t>(k), p);
    }
    walkers.run();
    std::stable_partition(ends.begin(), ends.end(), [](const PatchWalkers::End& e) { return e.arrived; });
    polish(map, eye, vertices, ends, options, to);
}

}  // namespace HWY_NAMESPACE
}  // namespace reflection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace reflection {

HWY_EXPORT(findEnds);

namespace {

/// Two descents that end nearer to each other than this (in radii) have found the same point: where the
/// residual is 1e-7 and the surface turns by at least 1 % of its radius per radius, they can differ by 1e-5.
constexpr double samePoint = 2e-5;

}  // namespace

ConcavePoints searchConcave(const ReflectorMap& map, const glm::dvec3& eye,
                            std::span<const glm::dvec3> vertices, bool all, const SearchOptions& options) {
    std::vector<ConcaveEnd> ends;
    HWY_DYNAMIC_DISPATCH(findEnds)(map, eye, vertices, all ? 2 : 0, options, ends);
    // Nothing is told hidden or unreflected that only wandered off.
    std::vector<char> seen(vertices.size(), 0);
    for (const ConcaveEnd& e : ends)
        if (seen[e.vertex] == 0 && map.covered(e.point)) seen[e.vertex] = 1;
    std::vector<glm::dvec3> left;
    std::vector<std::uint32_t> number;
    for (std::uint32_t k = 0; k < vertices.size(); ++k)
        if (!all && seen[k] == 0) left.push_back(vertices[k]), number.push_back(k);
    if (!left.empty()) {
        std::vector<ConcaveEnd> more;
        HWY_DYNAMIC_DISPATCH(findEnds)(map, eye, left, 1, options, more);
        for (ConcaveEnd& e : more) {
            e.vertex = number[e.vertex];
            ends.push_back(e);
        }
    }
    std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.path < b.path;
    });
    ConcavePoints result;
    result.first.reserve(vertices.size() + 1);
    std::size_t at = 0;
    for (std::uint32_t k = 0; k < vertices.size(); ++k) {
        const std::size_t begin = result.points.size();
        result.first.push_back(static_cast<std::uint32_t>(begin));
        for (; at < ends.size() && ends[at].vertex == k; ++at) {
            const ConcaveEnd& c = ends[at];
            const bool known = std::any_of(
                result.points.begin() + static_cast<std::ptrdiff_t>(begin), result.points.end(),
                [&](const ReflectionPoint& r) { return glm::length(r.point - c.point) < samePoint; });
            if (known) continue;
            result.points.push_back(
                {c.point, c.normal, std::sqrt(c.error), c.path,
                 map.covered(c.point) ? ReflectionStatus::found : ReflectionStatus::unreflected, 255});
        }
    }
    result.first.push_back(static_cast<std::uint32_t>(result.points.size()));
    return result;
}

}  // namespace reflection
#endif
