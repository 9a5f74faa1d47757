#include "reflection/chrome/VirtualMesh.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "reflection/chrome/VirtualTriangles.h"

namespace reflection {

namespace {

using Triangle = VirtualTriangle;

constexpr std::uint32_t straight = straightEdge, broken = straight - 1;

/// Length on screen, in tolerances, below which an edge is not looked at: it could bend by more only if it
/// went four times its length aside and came back.
constexpr double shortEdge = 0.25;

/// What a vertex is to the outline of a convex piece. What it hides, and itself, is a convex set: between two
/// hidden vertices everything is hidden.
enum class Side : std::uint8_t { seen, outline, hidden };

/// Searches for the place where an edge is cut, at most: false position takes four to six.
constexpr int cutSearches = 12;

/// An edge that the piece's outline cuts.
struct Cut {
    std::uint32_t seen, hidden;
    double low = 0, high = 1;  ///< shares of the way from the seen end: seen there, hidden there
    double lowFacing = -1, highFacing = -1;  ///< squared cosines to the eye; below 0: not known
    ReflectionPoint point = {};              ///< at `low`
    bool open = true;

    /// Where to look next. Squared cosines go through zero where the line of sight grazes the piece.
    double next() const {
        double at = 0.5;
        if (lowFacing >= 0 && highFacing >= 0 && lowFacing + highFacing > 0)
            at = std::clamp(lowFacing / (lowFacing + highFacing), 0.1, 0.9);
        return low + at * (high - low);
    }
};

VirtualOptions toTheTolerance(VirtualOptions options) {
    options.beyondShare = true;
    return options;
}

/// Edges that run into a crease of a convex body are halved no more often than this.
constexpr int creaseHalvings = 2;

}  // namespace

VirtualMesh::VirtualMesh(std::vector<glm::vec3> points, std::vector<std::uint32_t> indices,
                         const VirtualMeshOptions& options)
    : positions(std::move(points)),
      triangles(std::move(indices)),
      object(positions, toTheTolerance(options.vertices)) {}

VirtualCounts VirtualMesh::update(const ReflectorMap& map, const glm::dvec3& eye,
                                  const glm::dmat4& reflectorFromMesh, const VirtualMeshOptions& options) {
    if (map.bend() == Bend::concave && !options.vertices.published)
        return updateConcave(map, eye, reflectorFromMesh, options);
    VirtualCounts counts = object.update(map, eye, reflectorFromMesh);
    image.assign(object.vertices().begin(), object.vertices().end());
    added.clear();
    drawn.clear();
    std::vector<glm::dvec3> places;
    places.reserve(positions.size());
    for (const glm::vec3& p : positions)
        places.push_back(glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1)));

    const bool convex = map.bend() == Bend::convex;
    // A convex piece shows everything once, at a place that moves without a jump.
    const bool tears = !convex;
    std::vector<Side> sides(image.size());
    const auto sideOf = [&](ReflectionStatus status) {
        return convex && status == ReflectionStatus::hidden ? Side::hidden : Side::seen;
    };
    for (std::size_t k = 0; k < image.size(); ++k) sides[k] = sideOf(image[k].status);
    // Where a convex body has creases, what would show in them shows nowhere: a border that need not be met.
    const bool creased = convex && !options.vertices.search.thorough;
    const auto lost = [&](std::uint32_t v) {
        return creased && image[v].status == ReflectionStatus::unreflected;
    };
    const auto usable = [&](std::uint32_t v) { return image[v].status != ReflectionStatus::invalid; };
    std::vector<Triangle> open, next;
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
        const Triangle t{triangles[k], triangles[k + 1], triangles[k + 2]};
        if (usable(t[0]) && usable(t[1]) && usable(t[2])) open.push_back(t);
    }
    const double cone = options.coneCosine > -1 ? std::acos(std::min(options.coneCosine, 1.0)) : -1;
    /// No part of an edge is near the cone, however it bends.
    const auto outside = [&](std::uint32_t a, std::uint32_t b, double length) {
        return cone >= 0 && angleToArc(options.towards, glm::dvec3(image[a].fromEye),
                                       glm::dvec3(image[b].fromEye)) > cone + 0.5 * length;
    };
    // An edge whose image is a short arc lies off its chord by its squared length over eight radii of the
    // arc. Images bend about as the reflector's own outline does, towards it more: by up to eight times as
    // much is allowed for.
    const double unbent = cone >= 0 ? std::sqrt(options.tolerance * cone) : shortEdge * options.tolerance;
    const double reach = map.empty() ? 0
                                     : map.frame().scale * map.outerRadius() /
                                           std::max(glm::length(eye - map.frame().centre), 1e-300);
    const double outline = std::asin(std::min(reach, 1.0));
    const double ofOutline = std::sqrt(8 * options.tolerance * outline);
    // Seen at a cosine of less than this, a point lies within half the tolerance of the outline.
    const double grazing = options.tolerance / std::max(outline, 1e-300);

    std::unordered_map<std::uint64_t, std::uint32_t> halved;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> asked;
    std::vector<Cut> cuts;
    std::vector<glm::dvec3> middles;
    std::vector<ReflectionPoint> answers;
    const auto search = [&] {
        answers.resize(middles.size());
        findReflectionPoints(map, eye, middles, answers, options.vertices);
        counts.searched += answers.size();
        for (const ReflectionPoint& r : answers) counts.lookups += r.lookups;
    };
    const auto add = [&](std::uint32_t a, std::uint32_t b, double share, const VirtualVertex& vertex,
                         Side side) {
        halved[edgeKey(a, b)] = static_cast<std::uint32_t>(image.size());
        added.push_back({a, b, static_cast<float>(share)});
        image.push_back(vertex);
        places.push_back(places[a] + share * (places[b] - places[a]));
        sides.push_back(side);
    };
    /// Moved out by the tolerance, so that no gap is left inside the outline.
    const auto pastOutline = [&](const ReflectionPoint& r, const glm::dvec3& place) {
        const glm::dvec3 fromEye = virtualVertex(r, place) - eye;
        const double length = glm::length(fromEye);
        const glm::dvec3 sight = fromEye / std::max(length, 1e-300);
        const glm::dvec3 away = r.normal - glm::dot(r.normal, sight) * sight;
        const double across = glm::length(away);
        return glm::vec3(across > 0.5 ? fromEye + options.tolerance * length / across * away : fromEye);
    };
    for (int depth = 0; !open.empty(); ++depth) {
        const bool last = depth >= options.mostHalvings;
        asked.clear();
        cuts.clear();
        middles.clear();
        for (const Triangle& t : open)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                if (sides[a] != Side::seen && sides[b] != Side::seen &&
                    (sides[a] == Side::hidden || sides[b] == Side::hidden))
                    continue;
                const bool cut = sides[a] == Side::hidden || sides[b] == Side::hidden;
                if (!cut) {
                    const double length = apartOf(image[a].fromEye, image[b].fromEye);
                    // Only where the image runs into the part's outline it bends by more.
                    const bool smooth = (image[a].status == ReflectionStatus::found) ==
                                        (image[b].status == ReflectionStatus::found);
                    const double least = sides[a] == Side::outline && sides[b] == Side::outline ? ofOutline
                                         : smooth                                               ? unbent
                                                  : shortEdge * options.tolerance;
                    if (length <= least || (lost(a) && lost(b)) || outside(a, b, length)) continue;
                }
                if (!halved.try_emplace(edgeKey(a, b), straight).second) continue;
                if (cut) {
                    const bool turned = sides[a] == Side::hidden;
                    cuts.push_back({turned ? b : a, turned ? a : b});
                } else {
                    asked.emplace_back(a, b);
                    middles.push_back(0.5 * (places[a] + places[b]));
                }
            }
        search();
        for (std::size_t k = 0; k < asked.size(); ++k) {
            const auto [a, b] = asked[k];
            const glm::vec3 exact = glm::vec3(virtualVertex(answers[k], middles[k]) - eye);
            const Side side = sideOf(answers[k].status);
            const bool atOutline = sides[a] == Side::outline || sides[b] == Side::outline;
            // Along the edge, where the image runs into the outline, only colours are displaced.
            const double off = atOutline
                                   ? angleToArc(glm::normalize(glm::dvec3(exact)),
                                                glm::dvec3(image[a].fromEye), glm::dvec3(image[b].fromEye))
                                   : apartOf(exact, 0.5f * (image[a].fromEye + image[b].fromEye));
            if (!(off > options.tolerance) && side == Side::seen) continue;
            const bool intoCrease = lost(a) || lost(b);
            if (last || (intoCrease && depth >= creaseHalvings)) {
                if (intoCrease) halved[edgeKey(a, b)] = broken;
                if (tears && off > tornShare * apartOf(image[a].fromEye, image[b].fromEye))
                    halved[edgeKey(a, b)] = broken;
                continue;
            }
            // Between two places on the outline all is hidden, but for their tolerance.
            if (side == Side::seen && sides[a] == Side::outline && sides[b] == Side::outline)
                add(a, b, 0.5, {pastOutline(answers[k], middles[k]), ReflectionStatus::hidden},
                    Side::outline);
            else
                add(a, b, 0.5, {exact, answers[k].status}, side);
        }
        for (int k = 0; k < cutSearches && !cuts.empty(); ++k) {
            middles.clear();
            for (const Cut& c : cuts)
                if (c.open)
                    middles.push_back(places[c.seen] + c.next() * (places[c.hidden] - places[c.seen]));
            if (middles.empty()) break;
            search();
            std::size_t at = 0;
            for (Cut& c : cuts) {
                if (!c.open) continue;
                const double share = c.next();
                const ReflectionPoint& r = answers[at++];
                const double cosine = glm::dot(r.normal, glm::normalize(eye - r.point));
                if (r.status == ReflectionStatus::hidden) {
                    c.high = share;
                    c.highFacing = cosine * cosine;
                } else {
                    c.low = share;
                    c.lowFacing = cosine * cosine;
                    c.point = r;
                    c.open = cosine * cosine > grazing;
                }
            }
        }
        for (const Cut& c : cuts) {
            VirtualVertex vertex = image[c.seen];
            if (c.low > 0)
                vertex.fromEye =
                    pastOutline(c.point, places[c.seen] + c.low * (places[c.hidden] - places[c.seen]));
            vertex.status = ReflectionStatus::hidden;
            add(c.seen, c.hidden, c.low, vertex, Side::outline);
        }
        next.clear();
        for (const Triangle& t : open) {
            Triangle middle{straight, straight, straight};
            bool whole = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto entry = halved.find(edgeKey(t[k], t[(k + 1) % 3]));
                if (entry != halved.end()) middle[k] = entry->second;
                whole = whole && middle[k] == straight;
            }
            const auto isSeen = [&](const Triangle& of) {
                for (const std::uint32_t v : of)
                    if (convex ? sides[v] == Side::seen && !lost(v)
                               : image[v].status != ReflectionStatus::hidden)
                        return true;
                return false;
            };
            if (!isSeen(t)) continue;
            const bool tornApart = middle[0] == broken || middle[1] == broken || middle[2] == broken;
            if (whole) {
                drawn.insert(drawn.end(), t.begin(), t.end());
            } else if (!tornApart) {
                const std::size_t first = next.size();
                cutTriangle(t, middle, next);
                if (!last) continue;
                for (std::size_t k = first; k < next.size(); ++k)
                    if (isSeen(next[k])) drawn.insert(drawn.end(), next[k].begin(), next[k].end());
                next.resize(first);
            }
        }
        open.swap(next);
    }
    return counts;
}

}  // namespace reflection
