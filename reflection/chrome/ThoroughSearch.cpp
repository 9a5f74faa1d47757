#include "reflection/chrome/ThoroughSearch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/chrome/ConcaveSearch.h"
#include "reflection/chrome/LatticeStarts.h"

namespace reflection {

namespace {

/// Two descents that end nearer to each other than this (in radii) have found the same point: where the
/// residual is 1e-7 and the surface turns by at least 1 % of its radius per radius, they can differ by 1e-5.
constexpr double samePoint = 2e-5;

}  // namespace

std::vector<ReflectionPoint> everyReflectionPoint(const ReflectorMap& map, const glm::dvec3& eye,
                                                  const glm::dvec3& vertex, const SearchOptions& options) {
    if (map.bend() == Bend::concave)
        return searchConcave(map, eye, std::span(&vertex, 1), true, options).points;
    // The graphics card's starts: on which side of a rim a point within the tolerance of it ends is theirs.
    const std::vector<glm::dvec3> starts = latticeStarts(map, eye, vertex);
    std::vector<Candidate> ends(starts.size());
    SearchOptions patient = options;
    patient.lookups = 4 * options.lookups;
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
    return settle(map, eye, vertex, everyReflectionPoint(map, eye, vertex, options));
}

ReflectionPoint settle(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
                       std::span<const ReflectionPoint> all) {
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
