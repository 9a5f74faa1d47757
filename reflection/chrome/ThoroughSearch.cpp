#include "reflection/chrome/ThoroughSearch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Points of the lattice to a face's side, at most: a bowl of half a sphere then has one every six degrees.
constexpr int latticeSide = 16;

/// Two descents that end nearer to each other than this (in radii) have found the same point: where the
/// residual is 1e-7 and the surface turns by at least 1 % of its radius per radius, they can differ by 1e-5.
constexpr double samePoint = 2e-5;

/// How bisector and normal lie to each other at a corner of the map.
struct Node {
    double cosine = 0;
    glm::dvec2 across{0};  ///< the bisector's part along the surface, seen along the face's axes
};

Node nodeAt(const ReflectorMap& map, int face, int column, int row, const glm::dvec3& eye,
            const glm::dvec3& vertex) {
    const int cells = map.cellsPerSide();
    const glm::dvec3 g = ReflectorMap::cornerPoint(cells, face, column, row);
    const glm::dvec4 c(map.corners()[ReflectorMap::cornerIndex(cells, face, column, row)]);
    const glm::dvec3& stretch = map.frame().stretch;
    const glm::dvec3 p = stretch * g / (c.w * glm::dot(glm::dvec3(c), g));
    const glm::dvec3 n = glm::normalize(glm::dvec3(c) / stretch);
    const glm::dvec3 o = eye - p, v = vertex - p;
    const glm::dvec3 h = o / std::max(glm::length(o), 1e-300) + v / std::max(glm::length(v), 1e-300);
    const CubeFace& axes = cubeFaces[static_cast<std::size_t>(face)];
    const glm::dvec3 across = (h - glm::dot(h, n) * n) / stretch;
    return {glm::dot(h, n) / std::max(glm::length(h), 1e-300),
            {glm::dot(across, glm::dvec3(axes.sAxis)), glm::dot(across, glm::dvec3(axes.tAxis))}};
}

/// Signed turn from one direction to another, -pi to pi.
double turnBetween(const glm::dvec2& a, const glm::dvec2& b) {
    return std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
}

/// Where to descend from: the nodes of a lattice that are better than all around them, and the cells around
/// which the bisector's part along the surface turns once, either way: inside such a cell it must vanish. The
/// second kind finds points that lie too close together, or are too flat, to have a least node each.
std::vector<glm::dvec3> startsFor(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex) {
    const int cells = map.cellsPerSide();
    const int step = std::max(1, cells / latticeSide);
    const int side = cells / step + 1;
    std::vector<glm::dvec3> starts;
    std::vector<Node> nodes(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    const auto at = [&](int column, int row) -> Node& {
        return nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(column)];
    };
    for (int face = 0; face < 6; ++face) {
        for (int row = 0; row < side; ++row)
            for (int column = 0; column < side; ++column)
                at(column, row) = nodeAt(map, face, column * step, row * step, eye, vertex);
        for (int row = 0; row < side; ++row)
            for (int column = 0; column < side; ++column) {
                const Node& own = at(column, row);
                if (!(own.cosine > 0)) continue;
                bool best = true;
                for (int dy = -1; dy <= 1 && best; ++dy)
                    for (int dx = -1; dx <= 1 && best; ++dx) {
                        const int x = column + dx, y = row + dy;
                        if (x >= 0 && y >= 0 && x < side && y < side) best = at(x, y).cosine <= own.cosine;
                    }
                if (best) starts.push_back(ReflectorMap::cornerPoint(cells, face, column * step, row * step));
                if (column + 1 >= side || row + 1 >= side) continue;
                const Node &b = at(column + 1, row), &c = at(column + 1, row + 1), &d = at(column, row + 1);
                if (!(b.cosine > 0 && c.cosine > 0 && d.cosine > 0)) continue;
                const double turn = turnBetween(own.across, b.across) + turnBetween(b.across, c.across) +
                                    turnBetween(c.across, d.across) + turnBetween(d.across, own.across);
                if (std::abs(turn) > 3)
                    starts.push_back(ReflectorMap::cornerPoint(2 * cells, face, (2 * column + 1) * step,
                                                               (2 * row + 1) * step));
            }
    }
    return starts;
}

/// Lookups after which a start is given up: from within a patch that holds a point Newton steps need six.
constexpr int mostLookups = 40;

}  // namespace

std::vector<ReflectionPoint> everyReflectionPoint(const ReflectorMap& map, const glm::dvec3& eye,
                                                  const glm::dvec3& vertex, const SearchOptions& options) {
    const bool convex = map.bend() == Bend::convex;
    std::vector<glm::dvec3> starts;
    if (convex) {
        // The graphics card's starts: on which side of a rim a point within the tolerance of it ends is
        // theirs.
        starts = startsFor(map, eye, vertex);
    } else {
        std::vector<std::uint32_t> patches;
        map.patches().mayReflect(eye, vertex, patches);
        for (const std::uint32_t p : patches) starts.emplace_back(map.patches().start(p));
    }
    std::vector<Candidate> ends(starts.size());
    SearchOptions patient = options;
    patient.lookups = convex ? 4 * options.lookups : std::max(options.lookups, mostLookups);
    descendFromStarts(map, eye, vertex, starts, ends, patient);
    std::vector<ReflectionPoint> found;
    for (const Candidate& c : ends) {
        if (!(c.error <= options.tolerance * options.tolerance)) continue;
        const bool known = std::any_of(found.begin(), found.end(), [&](const ReflectionPoint& r) {
            return glm::length(r.point - c.point) < samePoint;
        });
        if (known) continue;
        found.push_back({c.point, c.normal, std::sqrt(c.error),
                         glm::length(eye - c.point) + glm::length(vertex - c.point),
                         map.covered(c.point) ? ReflectionStatus::found : ReflectionStatus::unreflected,
                         255});
    }
    std::sort(found.begin(), found.end(),
              [](const ReflectionPoint& a, const ReflectionPoint& b) { return a.path < b.path; });
    return found;
}

ReflectionPoint searchThoroughly(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                                 const SearchOptions& options) {
    const std::vector<ReflectionPoint> all = everyReflectionPoint(map, eye, vertex, options);
    for (const ReflectionPoint& r : all)
        if (r.status == ReflectionStatus::found) return r;

    const bool convex = map.bend() == Bend::convex;
    const double eyeGauge = map.sample(eye).gauge, vertexGauge = map.sample(vertex).gauge;
    ReflectionPoint r;
    r.lookups = 255;
    const auto place = [&](const glm::dvec3& p, ReflectionStatus status) {
        const ReflectorMap::Sample s = map.sample(p);
        r.point = s.position;
        r.normal = s.normal;
        r.path = glm::length(eye - r.point) + glm::length(vertex - r.point);
        r.status = status;
        return r;
    };
    glm::dvec3 met;
    // Behind a convex part the line of sight enters it; behind a bowl it leaves the bowl's inside through the
    // part.
    if (convex ? eyeGauge > 1 && entersSurface(map, eye, vertex, met)
               : vertexGauge > 1 && entersSurface(map, vertex, eye, met)) {
        if (convex || map.covered(met)) return place(met, ReflectionStatus::hidden);
    }
    if (!all.empty()) return all.front();
    const glm::dvec3 bisector =
        eye / std::max(glm::length(eye), 1e-300) + vertex / std::max(glm::length(vertex), 1e-300);
    return place(map.directionOfNormal(bisector), ReflectionStatus::unreflected);
}

std::vector<ReflectionPoint> findAllReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                                                     const glm::dvec3& vertex, const SearchOptions& options) {
    std::vector<ReflectionPoint> found;
    const auto finite = [](const glm::dvec3& p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    if (map.empty() || !finite(eye) || !finite(vertex)) return found;
    if (map.bend() == Bend::convex && !(map.sample(map.frame().toMap(eye)).gauge > 1)) return found;
    found = everyReflectionPoint(map, map.frame().toMap(eye), map.frame().toMap(vertex), options);
    std::erase_if(found, [](const ReflectionPoint& r) { return r.status != ReflectionStatus::found; });
    for (ReflectionPoint& r : found) {
        r.point = map.frame().fromMap(r.point);
        r.normal = map.frame().fromMapDirection(r.normal);
        r.path *= map.frame().scale;
    }
    return found;
}

}  // namespace reflection
