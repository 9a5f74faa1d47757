#include "reflection/chrome/VirtualMesh.h"

#include <cmath>
#include <unordered_map>
#include <utility>

namespace reflection {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::uint32_t straight = ~std::uint32_t{0}, broken = straight - 1;

/// Length on screen, in tolerances, below which an edge is not looked at: it could bend by more only if it
/// went four times its length aside and came back.
constexpr double shortEdge = 0.25;

/// After the last halving: how far from the middle, in edge lengths, an edge's middle may lie. Where an image
/// runs into the reflector's outline it moves as a root, and the middle lies 0.21 off; where it jumps, 0.5.
constexpr double torn = 0.35;

std::uint64_t keyOf(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}

/// Chord between the directions to two points, which is their angle where that is small.
double apart(const glm::vec3& a, const glm::vec3& b) {
    return glm::length(glm::normalize(glm::dvec3(a)) - glm::normalize(glm::dvec3(b)));
}

/// Triangles after their halved edges were cut. `middle[k]`: of the edge from corner k to the next, or
/// `straight`.
void cutTriangle(const Triangle& t, const Triangle& middle, std::vector<Triangle>& out) {
    int halved = 0;
    for (const std::uint32_t m : middle) halved += m != straight;
    if (halved == 3) {
        out.push_back({t[0], middle[0], middle[2]});
        out.push_back({middle[0], t[1], middle[1]});
        out.push_back({middle[2], middle[1], t[2]});
        out.push_back({middle[0], middle[1], middle[2]});
        return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        if (halved == 1 && middle[k] != straight) {
            out.push_back({t[k], middle[k], t[last]});
            out.push_back({middle[k], t[next], t[last]});
        } else if (halved == 2 && middle[k] == straight) {
            out.push_back({t[last], middle[last], middle[next]});
            out.push_back({middle[last], t[k], t[next]});
            out.push_back({middle[last], t[next], middle[next]});
        }
    }
}

}  // namespace

VirtualMesh::VirtualMesh(std::vector<glm::vec3> points, std::vector<std::uint32_t> indices,
                         const VirtualMeshOptions& options)
    : positions(std::move(points)), triangles(std::move(indices)), object(positions, options.vertices) {}

VirtualCounts VirtualMesh::update(const ReflectorMap& map, const glm::dvec3& eye,
                                  const glm::dmat4& reflectorFromMesh, const VirtualMeshOptions& options) {
    VirtualCounts counts = object.update(map, eye, reflectorFromMesh);
    image.assign(object.vertices().begin(), object.vertices().end());
    added.clear();
    drawn.clear();
    std::vector<glm::dvec3> places;
    places.reserve(positions.size());
    for (const glm::vec3& p : positions)
        places.push_back(glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1)));

    const auto outside = [&](std::uint32_t v) {
        return glm::dot(glm::normalize(glm::dvec3(image[v].fromEye)), options.towards) < options.coneCosine;
    };
    const auto usable = [&](std::uint32_t v) { return image[v].status != ReflectionStatus::invalid; };
    std::vector<Triangle> open, next;
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
        const Triangle t{triangles[k], triangles[k + 1], triangles[k + 2]};
        if (usable(t[0]) && usable(t[1]) && usable(t[2])) open.push_back(t);
    }
    // An edge whose image is a short arc lies off its chord by its squared length over eight radii of the
    // arc. Images bend about as the reflector's own outline does, towards it more: by up to eight times as
    // much is allowed for.
    const double unbent = options.coneCosine > -1
                              ? std::sqrt(options.tolerance * std::acos(std::min(options.coneCosine, 1.0)))
                              : shortEdge * options.tolerance;
    // A convex piece shows everything once, at a place that moves without a jump.
    const bool tears = map.bend() == Bend::concave;
    std::unordered_map<std::uint64_t, std::uint32_t> halved;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> asked;
    std::vector<glm::dvec3> middles;
    std::vector<ReflectionPoint> answers;
    for (int depth = 0; !open.empty(); ++depth) {
        const bool last = depth >= options.mostHalvings;
        asked.clear();
        middles.clear();
        for (const Triangle& t : open)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                const double length = apart(image[a].fromEye, image[b].fromEye);
                // Only where the image runs into the part's outline it bends by more.
                const bool smooth = (image[a].status == ReflectionStatus::found) ==
                                    (image[b].status == ReflectionStatus::found);
                if (length <= (smooth ? unbent : shortEdge * options.tolerance) || (outside(a) && outside(b)))
                    continue;
                if (!halved.try_emplace(keyOf(a, b), straight).second) continue;
                asked.emplace_back(a, b);
                middles.push_back(0.5 * (places[a] + places[b]));
            }
        answers.resize(middles.size());
        findReflectionPoints(map, eye, middles, answers, options.vertices);
        for (std::size_t k = 0; k < asked.size(); ++k) {
            const auto [a, b] = asked[k];
            ++counts.searched;
            counts.lookups += answers[k].lookups;
            const glm::vec3 exact = glm::vec3(virtualVertex(answers[k], middles[k]) - eye);
            const glm::vec3 flat = 0.5f * (image[a].fromEye + image[b].fromEye);
            const double off = apart(exact, flat);
            if (!(off > options.tolerance)) continue;
            if (last) {
                if (tears && off > torn * apart(image[a].fromEye, image[b].fromEye))
                    halved[keyOf(a, b)] = broken;
                continue;
            }
            halved[keyOf(a, b)] = static_cast<std::uint32_t>(image.size());
            added.push_back({a, b});
            image.push_back({exact, answers[k].status});
            places.push_back(middles[k]);
        }
        next.clear();
        for (const Triangle& t : open) {
            Triangle middle{straight, straight, straight};
            bool whole = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto entry = halved.find(keyOf(t[k], t[(k + 1) % 3]));
                if (entry != halved.end()) middle[k] = entry->second;
                whole = whole && middle[k] == straight;
            }
            bool seen = false;
            for (const std::uint32_t v : t) seen = seen || image[v].status != ReflectionStatus::hidden;
            if (whole && seen)
                drawn.insert(drawn.end(), t.begin(), t.end());
            else if (!whole && !last)
                cutTriangle(t, middle, next);
        }
        open.swap(next);
    }
    return counts;
}

}  // namespace reflection
