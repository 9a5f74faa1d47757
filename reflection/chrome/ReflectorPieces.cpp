#include "reflection/chrome/ReflectorPieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <tuple>

#include "reflection/chrome/PrincipalAxes.h"
#include "reflection/chrome/StarCentre.h"

namespace reflection {

namespace {

/// Sine of the angle across an edge below which it is flat: single-precision corners of a triangle whose
/// sides are a hundredth of the part's size place its normal to about this.
constexpr double flatSine = 1e-4;
/// Height of a triangle over its longest side below which it is left out: rounding of single-precision
/// corners turns its normal by more than a few degrees.
constexpr double sliver = 1e-6;
/// Margin at which the search for a centre is content: the piece then lies within 60 degrees of being faced.
constexpr double goodMargin = 0.5;
/// Margin at which a centre close to the piece is taken, whatever a farther one offers.
constexpr double fairMargin = 0.2;
/// A growth across edges of both kinds is taken where it covers so many times what either kind alone does.
constexpr double saddleGain = 3;

enum class Fold : std::uint8_t { border, flat, ridge, valley };

struct Edge {
    std::uint32_t other = 0;
    Fold fold = Fold::border;
};

/// Share of a map's corners that a piece must cover: 250 of 64 cells to a side, as many as a small vehicle's
/// part has vertices.
constexpr double leastCover = 0.01;
/// No axis of a map is stretched by more than this: a flat plate has no extent along its third axis.
constexpr double mostStretch = 50;

struct Part {
    std::vector<FacingTriangle> triangles;
    std::vector<std::uint32_t> source;  ///< index of the mesh's triangle
    std::vector<double> areas;
    std::vector<std::array<Edge, 3>> edges;
};

/// A frame along the principal axes of some triangles, in which they fill the same length along each axis.
MapFrame frameOf(const std::vector<std::array<glm::dvec3, 3>>& triangles) {
    const PrincipalBox box = principalBox(triangles);
    MapFrame frame;
    frame.centre = box.middle;
    frame.axes = box.axes;
    const double longest = std::max({box.halfExtent.x, box.halfExtent.y, box.halfExtent.z});
    frame.stretch = glm::max(box.halfExtent, glm::dvec3(longest / mostStretch));
    return frame;
}

FacingTriangle inFrame(const FacingTriangle& t, const MapFrame& frame) {
    FacingTriangle out;
    for (std::size_t i = 0; i < 3; ++i) out.corners[i] = frame.toMap(t.corners[i]) / frame.stretch;
    out.normal = glm::normalize(frame.toMapDirection(t.normal) * frame.stretch);
    return out;
}

/// Triangles in the frame of their connected component.
struct Unstretched {
    std::vector<FacingTriangle> triangles;
    std::vector<std::uint32_t> component;
    std::vector<MapFrame> frames;
};

Unstretched unstretch(const Part& part, const std::vector<std::uint32_t>& among,
                      const std::vector<std::uint8_t>& taken) {
    constexpr std::uint32_t none = ~std::uint32_t{0};
    Unstretched u;
    u.triangles.resize(part.triangles.size());
    u.component.assign(part.triangles.size(), none);
    for (const std::uint32_t seed : among) {
        if (u.component[seed] != none) continue;
        const auto id = static_cast<std::uint32_t>(u.frames.size());
        std::vector<std::uint32_t> members{seed};
        u.component[seed] = id;
        std::vector<std::array<glm::dvec3, 3>> corners;
        for (std::size_t k = 0; k < members.size(); ++k) {
            corners.push_back(part.triangles[members[k]].corners);
            for (const Edge& edge : part.edges[members[k]]) {
                if (edge.fold == Fold::border || taken[edge.other] != 0 || u.component[edge.other] != none)
                    continue;
                u.component[edge.other] = id;
                members.push_back(edge.other);
            }
        }
        u.frames.push_back(frameOf(corners));
        for (const std::uint32_t m : members) u.triangles[m] = inFrame(part.triangles[m], u.frames[id]);
    }
    return u;
}

bool finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Part readPart(const city::Mesh& mesh, std::size_t& skipped) {
    Part part;
    using Place = std::tuple<float, float, float>;
    std::map<Place, std::uint32_t> places;
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        FacingTriangle t;
        std::array<std::uint32_t, 3> ids{};
        bool usable = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const city::Vertex& v = mesh.vertices[mesh.indices[k + i]];
            usable = usable && finite(v.position) && finite(v.normal);
            if (!usable) break;
            t.corners[i] = glm::dvec3(v.position);
            // Adding 0 makes -0 and 0 one place.
            ids[i] = places
                         .try_emplace(Place(v.position.x + 0.0f, v.position.y + 0.0f, v.position.z + 0.0f),
                                      static_cast<std::uint32_t>(places.size()))
                         .first->second;
        }
        if (usable) {
            const glm::dvec3 across = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
            const double doubled = glm::length(across);
            const double longest =
                std::max({glm::length(t.corners[1] - t.corners[0]), glm::length(t.corners[2] - t.corners[1]),
                          glm::length(t.corners[0] - t.corners[2])});
            usable = doubled > sliver * longest * longest;
            if (usable) {
                t.normal = across / doubled;
                part.areas.push_back(doubled / 2);
            }
        }
        if (!usable) {
            ++skipped;
            continue;
        }
        part.triangles.push_back(t);
        part.source.push_back(static_cast<std::uint32_t>(k / 3));
        corners.push_back(ids);
    }
    struct Side {
        std::uint32_t triangle, edge;
        bool forward;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> sides;
    for (std::uint32_t t = 0; t < corners.size(); ++t)
        for (std::uint32_t e = 0; e < 3; ++e) {
            const std::uint32_t a = corners[t][e], b = corners[t][(e + 1) % 3];
            sides[std::minmax(a, b)].push_back({t, e, a < b});
        }
    part.edges.resize(part.triangles.size());
    for (const auto& [ends, users] : sides) {
        if (users.size() != 2 || users[0].forward == users[1].forward) continue;
        const FacingTriangle& a = part.triangles[users[0].triangle];
        const FacingTriangle& b = part.triangles[users[1].triangle];
        const double sine = glm::length(glm::cross(a.normal, b.normal));
        const glm::dvec3& opposite = b.corners[(users[1].edge + 2) % 3];
        const bool above = glm::dot(a.normal, opposite - a.corners[0]) > 0;
        const bool turnedBack = glm::dot(a.normal, b.normal) < 0;
        const Fold fold = sine < flatSine && !turnedBack ? Fold::flat : above ? Fold::valley : Fold::ridge;
        part.edges[users[0].triangle][users[0].edge] = {users[1].triangle, fold};
        part.edges[users[1].triangle][users[1].edge] = {users[0].triangle, fold};
    }
    return part;
}

struct Growth {
    std::vector<std::uint32_t> members;
    double sign = 1;
    bool mixed = false;
    glm::dvec3 centre{0};
    double area = 0;
};

/// Breadth first from a seed. A triangle that the centre does not see well enough asks for a better centre;
/// after some refusals in a row the region has met its limit, and only triangles that fit as they are still
/// join.
Growth grow(const Part& part, const std::vector<FacingTriangle>& triangles,
            const std::vector<std::uint8_t>& taken, std::uint32_t seed, double sign, bool mixed,
            double leastMargin) {
    constexpr int patience = 24;
    constexpr int tries = 60;
    Growth g;
    g.sign = sign;
    g.mixed = mixed;
    const FacingTriangle& first = triangles[seed];
    // The component's middle sees a closed part whole; else half the component's size behind or before the
    // seed.
    if (sign < 0 || starMargin(first, g.centre, sign) < leastMargin)
        g.centre = (first.corners[0] + first.corners[1] + first.corners[2]) / 3.0 - sign * first.normal;
    std::vector<FacingTriangle> facing{first};
    std::vector<std::uint8_t> seen(part.triangles.size(), 0);
    seen[seed] = 1;
    g.members = {seed};
    g.area = part.areas[seed];
    int refusals = 0;
    std::size_t sinceSearch = 0;
    for (std::size_t k = 0; k < g.members.size(); ++k)
        for (const Edge& edge : part.edges[g.members[k]]) {
            if (edge.fold == Fold::border || taken[edge.other] != 0 || seen[edge.other] != 0) continue;
            const bool fits =
                mixed || edge.fold == Fold::flat || edge.fold == (sign > 0 ? Fold::ridge : Fold::valley);
            if (!fits) continue;
            const FacingTriangle& t = triangles[edge.other];
            if (starMargin(t, g.centre, sign) < leastMargin) {
                if (refusals >= patience) continue;
                facing.push_back(t);
                glm::dvec3 centre = g.centre;
                if (findStarCentre(facing, sign, goodMargin, tries, centre) < leastMargin) {
                    facing.pop_back();
                    ++refusals;
                    continue;
                }
                g.centre = centre;
                if (++sinceSearch > 4) refusals = 0, sinceSearch = 0;
            } else {
                facing.push_back(t);
            }
            seen[edge.other] = 1;
            g.members.push_back(edge.other);
            g.area += part.areas[edge.other];
        }
    return g;
}

city::Mesh extract(const city::Mesh& mesh, const Part& part, const std::vector<std::uint32_t>& members) {
    city::Mesh out;
    std::map<std::uint32_t, std::uint32_t> renamed;
    for (const std::uint32_t member : members)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t index = mesh.indices[3 * part.source[member] + i];
            const auto [entry, added] =
                renamed.try_emplace(index, static_cast<std::uint32_t>(out.vertices.size()));
            if (added) out.vertices.push_back(mesh.vertices[index]);
            out.indices.push_back(entry->second);
        }
    return out;
}

ReflectorPiece makePiece(const city::Mesh& mesh, const Part& part, const Growth& growth,
                         const MapFrame& grownIn, const CutOptions& options) {
    std::vector<std::array<glm::dvec3, 3>> corners;
    for (const std::uint32_t m : growth.members) corners.push_back(part.triangles[m].corners);
    MapFrame frame = frameOf(corners);
    std::vector<FacingTriangle> facing;
    for (const std::uint32_t m : growth.members) facing.push_back(inFrame(part.triangles[m], frame));
    ReflectorPiece piece;
    piece.bend = growth.sign > 0 && !growth.mixed ? Bend::convex : Bend::concave;
    glm::dvec3 own(0),
        carried = frame.toMap(grownIn.fromMap(grownIn.stretch * growth.centre)) / frame.stretch;
    piece.margin = findStarCentre(facing, growth.sign, goodMargin, 400, carried);
    const double fromMiddle = findStarCentre(facing, growth.sign, goodMargin, 400, own);
    if (fromMiddle >= fairMargin || fromMiddle > piece.margin) piece.margin = fromMiddle, carried = own;
    const double kept = std::max(options.leastMargin, 0.7 * piece.margin);
    piece.margin = drawStarCentre(facing, growth.sign, glm::dvec3(0), kept, carried);
    frame.centre = frame.fromMap(frame.stretch * carried);
    piece.mesh = extract(mesh, part, growth.members);
    piece.built = buildReflectorMap(piece.mesh, frame, growth.sign > 0, piece.bend, options.cellsPerSide);
    return piece;
}

/// Both halves of some triangles across the longest side of their box.
std::array<std::vector<std::uint32_t>, 2> halve(const Part& part, const std::vector<std::uint32_t>& members) {
    glm::dvec3 low(1e300), high(-1e300);
    const auto middle = [&](std::uint32_t m) {
        const auto& c = part.triangles[m].corners;
        return (c[0] + c[1] + c[2]) / 3.0;
    };
    for (const std::uint32_t m : members) low = glm::min(low, middle(m)), high = glm::max(high, middle(m));
    const glm::dvec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::vector<std::uint32_t> order = members;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a)[axis] < middle(b)[axis]; });
    const auto half = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    return {std::vector<std::uint32_t>(order.begin(), half), std::vector<std::uint32_t>(half, order.end())};
}

/// Grows pieces until all of `among` are in one. A piece that overlaps itself, that no centre sees well or
/// that fills but a few cells (rings) is cut anew in two halves.
void cut(const city::Mesh& mesh, const Part& part, const std::vector<std::uint32_t>& among,
         const CutOptions& options, Reflector& to) {
    std::vector<std::uint8_t> taken(part.triangles.size(), 1);
    for (const std::uint32_t m : among) taken[m] = 0;
    const Unstretched even = unstretch(part, among, taken);
    std::vector<std::uint32_t> seeds = among;
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return part.areas[a] > part.areas[b]; });
    for (const std::uint32_t seed : seeds) {
        if (taken[seed] != 0) continue;
        const auto grown = [&](double sign, bool mixed) {
            return grow(part, even.triangles, taken, seed, sign, mixed, options.leastMargin);
        };
        Growth best = grown(1, false);
        Growth other = grown(-1, false);
        if (other.area > best.area) best = std::move(other);
        for (const double sign : {1.0, -1.0}) {
            Growth both = grown(sign, true);
            if (both.area > (best.mixed ? 1 : saddleGain) * best.area) best = std::move(both);
        }
        for (const std::uint32_t m : best.members) taken[m] = 1;
        ReflectorPiece piece = makePiece(mesh, part, best, even.frames[even.component[seed]], options);
        const bool good = piece.margin >= options.leastMargin &&
                          piece.built.report.coveredShare >= leastCover &&
                          piece.built.status == ReflectorMapStatus::built;
        if (good || best.members.size() < 2)
            to.pieces.push_back(std::move(piece));
        else
            for (const std::vector<std::uint32_t>& half : halve(part, best.members))
                cut(mesh, part, half, options, to);
    }
}

}  // namespace

Reflector makeReflector(const city::Mesh& mesh, const CutOptions& options) {
    Reflector result;
    const Part part = readPart(mesh, result.skipped);
    std::vector<std::uint32_t> all(part.triangles.size());
    std::iota(all.begin(), all.end(), 0U);
    cut(mesh, part, all, options, result);
    const auto areaOf = [](const ReflectorPiece& p) {
        double area = 0;
        for (std::size_t k = 0; k + 2 < p.mesh.indices.size(); k += 3) {
            const auto corner = [&](std::size_t i) {
                return glm::dvec3(p.mesh.vertices[p.mesh.indices[k + i]].position);
            };
            area += glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        }
        return area;
    };
    std::stable_sort(result.pieces.begin(), result.pieces.end(),
                     [&](const ReflectorPiece& a, const ReflectorPiece& b) { return areaOf(a) > areaOf(b); });
    return result;
}

}  // namespace reflection
