#include "reflection/chrome/VirtualEdges.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace reflection {

namespace {

constexpr std::uint32_t straight = straightEdge, broken = straight - 1;

/// Length on screen, in tolerances, below which an edge is not looked at: it could bend by more only if it
/// went four times its length aside and came back.
constexpr double shortEdge = 0.25;

/// Rounds of searches for the places where edges are cut, at most: false position takes four to six.
constexpr int mostCutRounds = 12;

/// Edges that run into a crease of a convex body are halved no more often than this.
constexpr int creaseHalvings = 2;

}  // namespace

double VirtualEdges::Cut::next() const {
    double share = 0.5;
    if (lowFacing >= 0 && highFacing >= 0 && lowFacing + highFacing > 0)
        share = std::clamp(lowFacing / (lowFacing + highFacing), 0.1, 0.9);
    return low + share * (high - low);
}

void VirtualEdges::begin(const ReflectorMap& in, const glm::dvec3& from, const glm::dmat4& reflectorFromMesh,
                         const VirtualMeshOptions& how, const Mesh& of) {
    map = &in;
    eye = from;
    options = &how;
    mesh = of;
    meshFromReflector = glm::inverse(reflectorFromMesh);
    depth = 0;
    convex = in.bend() == Bend::convex;
    // Where a convex body has creases, what would show in them shows nowhere: a border that need not be met.
    creased = convex && !how.vertices.search.thorough;

    const std::span<const VirtualVertex> found = mesh.object->vertices();
    seen.assign(found.begin(), found.end());
    places.clear();
    places.reserve(mesh.places.size());
    for (const glm::vec3& p : mesh.places)
        places.push_back(glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1)));
    towards.clear();
    towards.reserve(seen.size());
    for (const VirtualVertex& v : seen) towards.push_back(glm::normalize(v.fromEye));
    sides.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) sides[k] = sideOf(seen[k].status);
    image.clear();
    image.reserve(mesh.placeOf.size());
    for (const std::uint32_t place : mesh.placeOf) image.push_back(seen[place]);
    added.clear();
    drawn.clear();
    onEdges.clear();
    middlePlaces.clear();
    halved.clear();
    vertices.clear();

    const auto usable = [&](std::uint32_t place) { return seen[place].status != ReflectionStatus::invalid; };
    triangles.clear();
    for (std::size_t k = 0; k + 2 < mesh.triangles.size(); k += 3) {
        const VirtualTriangle t{mesh.triangles[k], mesh.triangles[k + 1], mesh.triangles[k + 2]};
        const VirtualTriangle at{mesh.placeOf[t[0]], mesh.placeOf[t[1]], mesh.placeOf[t[2]]};
        if (usable(at[0]) && usable(at[1]) && usable(at[2]) && isSeen(at)) triangles.push_back({at, t});
    }

    cone = how.coneCosine > -1 ? std::acos(std::min(how.coneCosine, 1.0)) : -1;
    // An edge whose image is a short arc lies off its chord by its squared length over eight radii of the
    // arc. Images bend about as the reflector's own outline does, towards it more: by up to eight times as
    // much is allowed for.
    unbent = cone >= 0 ? std::sqrt(how.tolerance * cone) : shortEdge * how.tolerance;
    const double reach = in.empty() ? 0
                                    : in.frame().scale * in.outerRadius() /
                                          std::max(glm::length(eye - in.frame().centre), 1e-300);
    const double outline = std::asin(std::min(reach, 1.0));
    ofOutline = std::sqrt(8 * how.tolerance * outline);
    // Seen at a squared cosine of less than this, a point lies within half the tolerance of the outline.
    grazing = how.tolerance / std::max(outline, 1e-300);
}

/// No part of an edge is near the cone, however it bends.
bool VirtualEdges::outside(std::uint32_t a, std::uint32_t b, double length) const {
    return cone >= 0 && angleToArc(options->towards, glm::dvec3(seen[a].fromEye),
                                   glm::dvec3(seen[b].fromEye)) > cone + 0.5 * length;
}

void VirtualEdges::ask(const glm::dvec3& place, double urgency) {
    EdgeProbe& probe = asked.emplace_back();
    probe.place = place;
    probe.urgency = static_cast<float>(urgency);
    const std::optional<SeenInCell> known =
        mesh.object->at(glm::vec3(meshFromReflector * glm::dvec4(place, 1)));
    if (!known) return;
    probe.answered = probe.inCell = true;
    probe.seen = known->vertex;
    probe.facing = std::abs(known->facing);
    // The mirror image lies across the tangent plane.
    const glm::dvec3 apart = place - (eye + glm::dvec3(known->vertex.fromEye));
    probe.normal = apart / std::max(glm::length(apart), 1e-300);
}

/// Moved out by the tolerance, so that no gap is left inside the outline.
glm::vec3 VirtualEdges::pastOutline(const VirtualVertex& at, const glm::dvec3& normal) const {
    const glm::dvec3 fromEye(at.fromEye);
    const double length = glm::length(fromEye);
    const glm::dvec3 sight = fromEye / std::max(length, 1e-300);
    const glm::dvec3 away = normal - glm::dot(normal, sight) * sight;
    const double across = glm::length(away);
    return glm::vec3(across > 0.5 ? fromEye + options->tolerance * length / across * away : fromEye);
}

void VirtualEdges::add(std::uint32_t a, std::uint32_t b, double share, const VirtualVertex& vertex,
                       Side side) {
    halved.set(edgeKey(a, b), static_cast<std::uint32_t>(places.size()));
    onEdges.push_back({a, b, static_cast<float>(share)});
    seen.push_back(vertex);
    towards.push_back(glm::normalize(vertex.fromEye));
    places.push_back(places[a] + share * (places[b] - places[a]));
    sides.push_back(side);
}

std::uint32_t VirtualEdges::vertexOn(std::uint32_t a, std::uint32_t b, std::uint32_t place) {
    const auto [at, isNew] = vertices.add(edgeKey(a, b), static_cast<std::uint32_t>(image.size()));
    if (!isNew) return at;
    const MiddleVertex& edge = onEdges[place - mesh.places.size()];
    const auto placeOf = [&](std::uint32_t vertex) {
        return vertex < mesh.placeOf.size() ? mesh.placeOf[vertex]
                                            : middlePlaces[vertex - mesh.placeOf.size()];
    };
    const bool turned = placeOf(a) != edge.a;
    added.push_back({turned ? b : a, turned ? a : b, edge.share});
    middlePlaces.push_back(place);
    image.push_back(seen[place]);
    return at;
}

void VirtualEdges::askMiddles() {
    last = depth >= options->mostHalvings;
    asked.clear();
    edges.clear();
    cuts.clear();
    cutRounds = 0;
    const auto squared = [](double x) { return static_cast<float>(x * x); };
    const float unbentHere = squared(unbent), ofOutlineHere = squared(ofOutline),
                shortHere = squared(shortEdge * options->tolerance);
    for (Triangle& triangle : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangle.places[k], b = triangle.places[(k + 1) % 3];
            const bool cut = sides[a] == Side::hidden || sides[b] == Side::hidden;
            if (a == b || (sides[a] != Side::seen && sides[b] != Side::seen && cut)) continue;
            const float chord = chordOf(a, b);
            if (!cut) {
                // Only where the image runs into the part's outline it bends by more.
                const bool smooth = (seen[a].status == ReflectionStatus::found) ==
                                    (seen[b].status == ReflectionStatus::found);
                const float least = sides[a] == Side::outline && sides[b] == Side::outline ? ofOutlineHere
                                    : smooth                                               ? unbentHere
                                                                                           : shortHere;
                if (chord <= least || (lost(a) && lost(b))) continue;
            }
            const double length = std::sqrt(static_cast<double>(chord));
            if (!cut && outside(a, b, length)) continue;
            triangle.looked = true;
            if (!halved.add(edgeKey(a, b), straight).second) continue;
            if (cut) {
                Cut& made = cuts.emplace_back();
                made.seen = sides[a] == Side::hidden ? b : a;
                made.hidden = sides[a] == Side::hidden ? a : b;
            } else {
                edges.emplace_back(a, b);
                ask(0.5 * (places[a] + places[b]), length);
            }
        }
}

void VirtualEdges::takeMiddles() {
    // A convex piece shows everything once, at a place that moves without a jump.
    const bool tears = !convex;
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const auto [a, b] = edges[k];
        const EdgeProbe& probe = asked[k];
        if (!probe.answered) continue;
        const Side side = sideOf(probe.seen.status);
        const bool atOutline = sides[a] == Side::outline || sides[b] == Side::outline;
        // Along the edge, where the image runs into the outline, only colours are displaced.
        const double off = atOutline
                               ? angleToArc(glm::normalize(glm::dvec3(probe.seen.fromEye)),
                                            glm::dvec3(seen[a].fromEye), glm::dvec3(seen[b].fromEye))
                               : apartOf(probe.seen.fromEye, 0.5f * (seen[a].fromEye + seen[b].fromEye));
        if (!(off > options->tolerance) && side == Side::seen) continue;
        const bool intoCrease = lost(a) || lost(b);
        if (last || (intoCrease && depth >= creaseHalvings)) {
            if (intoCrease) halved.set(edgeKey(a, b), broken);
            if (tears && off > tornShare * apartOf(seen[a].fromEye, seen[b].fromEye))
                halved.set(edgeKey(a, b), broken);
            continue;
        }
        // Between two places on the outline all is hidden, but for their tolerance.
        if (side == Side::seen && sides[a] == Side::outline && sides[b] == Side::outline)
            add(a, b, 0.5, {pastOutline(probe.seen, probe.normal), ReflectionStatus::hidden}, Side::outline);
        else
            add(a, b, 0.5, probe.seen, side);
    }
}

bool VirtualEdges::askCuts() {
    asked.clear();
    if (cutRounds++ >= mostCutRounds) return false;
    for (const Cut& c : cuts)
        if (c.open)
            ask(places[c.seen] + c.next() * (places[c.hidden] - places[c.seen]),
                apartOf(seen[c.seen].fromEye, seen[c.hidden].fromEye) * (c.high - c.low));
    return !asked.empty();
}

void VirtualEdges::takeCuts() {
    std::size_t at = 0;
    for (Cut& c : cuts) {
        if (!c.open) continue;
        const double share = c.next();
        const EdgeProbe& probe = asked[at++];
        const double squared = probe.facing * probe.facing;
        // Cosines that cells continue go through zero as the place moves on; those of searches for hidden
        // places, where the line of sight meets the piece, as its root.
        const double facing = probe.inCell ? probe.facing : squared;
        if (!probe.answered) {
            c.open = false;
        } else if (probe.seen.status == ReflectionStatus::hidden) {
            c.high = share;
            c.highFacing = facing;
        } else {
            c.low = share;
            c.lowFacing = facing;
            c.at = probe.seen;
            c.normal = probe.normal;
            c.open = squared > grazing;
        }
    }
}

bool VirtualEdges::isSeen(const VirtualTriangle& t) const {
    for (const std::uint32_t place : t)
        if (convex ? sides[place] == Side::seen && !lost(place)
                   : seen[place].status != ReflectionStatus::hidden)
            return true;
    return false;
}

void VirtualEdges::cutTriangles() {
    for (const Cut& c : cuts) {
        VirtualVertex vertex = seen[c.seen];
        if (c.low > 0) vertex.fromEye = pastOutline(c.at, c.normal);
        vertex.status = ReflectionStatus::hidden;
        add(c.seen, c.hidden, c.low, vertex, Side::outline);
    }
    cuts.clear();
    next.clear();
    for (const Triangle& t : triangles) {
        VirtualTriangle middle{straight, straight, straight}, between = middle;
        bool whole = true, tornApart = false;
        for (std::size_t k = 0; k < 3 && t.looked; ++k) {
            const std::uint32_t* entry = halved.find(edgeKey(t.places[k], t.places[(k + 1) % 3]));
            if (entry != nullptr) middle[k] = *entry;
            whole = whole && middle[k] == straight;
            tornApart = tornApart || middle[k] == broken;
        }
        if (whole) {
            drawn.insert(drawn.end(), t.vertices.begin(), t.vertices.end());
            continue;
        }
        if (tornApart) continue;
        for (std::size_t k = 0; k < 3; ++k)
            if (middle[k] != straight)
                between[k] = vertexOn(t.vertices[k], t.vertices[(k + 1) % 3], middle[k]);
        cutPlaces.clear();
        cutVertices.clear();
        cutTriangle(t.places, middle, cutPlaces);
        cutTriangle(t.vertices, between, cutVertices);
        for (std::size_t k = 0; k < cutPlaces.size(); ++k) {
            if (!isSeen(cutPlaces[k])) continue;
            if (!last)
                next.push_back({cutPlaces[k], cutVertices[k]});
            else
                drawn.insert(drawn.end(), cutVertices[k].begin(), cutVertices[k].end());
        }
    }
    triangles.swap(next);
    ++depth;
}

}  // namespace reflection
