#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

namespace {

glm::dvec3 unit(const glm::dvec3& v) {
    return v / std::max(glm::length(v), 1e-300);
}

/// One lookup of the pair of maps and what the paper makes of it.
struct Field {
    ReflectorMap::Sample at;
    glm::dvec3 direction{0};  ///< on the cube, stretch taken out
    glm::dvec3 drift{0};      ///< B' projected onto the cube's face from the centre
    double error = 1;         ///< E = (1 - B . N) / 2
};

Field fieldAt(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex,
              const glm::dvec3& direction, bool inverse) {
    Field f;
    const glm::dvec3 size = glm::abs(direction);
    f.direction = direction / std::max({size.x, size.y, size.z, 1e-300});
    const glm::dvec3& stretch = map.frame().stretch;
    f.at = map.sample(stretch * f.direction);
    const glm::dvec3& p = f.at.position;
    const glm::dvec3& n = f.at.normal;
    // The inverse search mirrors the hidden vertex to the front of the current tangent plane (section 6.1).
    const glm::dvec3 seen = inverse ? vertex - 2.0 * glm::dot(vertex - p, n) * n : vertex;
    const glm::dvec3 bisector = unit(unit(eye - p) + unit(seen - p));
    f.error = (1 - glm::dot(bisector, n)) / 2;
    const glm::dvec3 turn = (bisector - n) / stretch;
    // The image on the face of p + e turn for small e: the part along the axis that is 1 on this face moves
    // nothing.
    const glm::dvec3 s = glm::abs(f.direction);
    const int major = s.x >= s.y && s.x >= s.z ? 0 : s.y >= s.z ? 1 : 2;
    f.drift = (turn - (turn[major] / f.direction[major]) * f.direction) / glm::length(p / stretch) *
              glm::length(f.direction);
    return f;
}

Field walk(const ReflectorMap& map, const glm::dvec3& eye, const glm::dvec3& vertex, int steps, bool inverse,
           int& lookups) {
    const glm::dvec3 start =
        map.directionOfNormal(inverse ? unit(eye) : unit(unit(eye) + unit(vertex))) / map.frame().stretch;
    Field f = fieldAt(map, eye, vertex, start, inverse);
    double length = 0.5;
    for (int k = 0; k < steps; ++k) {
        const Field middle = fieldAt(map, eye, vertex, f.direction + 0.5 * length * f.drift, inverse);
        const double apart = glm::length(middle.drift - f.drift), whole = glm::length(f.drift);
        f = fieldAt(map, eye, vertex, f.direction + length * middle.drift, inverse);
        if (apart > 0.5 * whole)
            length *= 0.5;
        else if (apart < 0.1 * whole)
            length *= 2;
        lookups += 2;
    }
    return f;
}

}  // namespace

void findReflectionPointsAsPublished(const ReflectorMap& map, const glm::dvec3& eye,
                                     std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                                     const PublishedOptions& options) {
    const auto finite = [](const glm::dvec3& p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        ReflectionPoint& r = points[k];
        r = {};
        if (map.empty() || !finite(eye) || !finite(vertices[k])) continue;
        const glm::dvec3 o = map.frame().toMap(eye), v = map.frame().toMap(vertices[k]);
        int lookups = 0;
        Field f = walk(map, o, v, options.steps, false, lookups);
        const bool behind = glm::dot(v - f.at.position, f.at.normal) < 0;
        if (behind) f = walk(map, o, v, options.steps, true, lookups);
        r.point = map.frame().fromMap(f.at.position);
        r.normal = map.frame().fromMapDirection(f.at.normal);
        r.path = map.frame().scale * (glm::length(o - f.at.position) + glm::length(v - f.at.position));
        r.residual = std::acos(std::clamp(1 - 2 * f.error, -1.0, 1.0));
        r.lookups = static_cast<std::uint8_t>(std::min(lookups, 255));
        if (!(f.error <= options.threshold))
            r.status = ReflectionStatus::outOfSteps;
        else if (behind)
            r.status = ReflectionStatus::hidden;
        else
            r.status = map.covered(f.at.position) ? ReflectionStatus::found : ReflectionStatus::unreflected;
    }
}

}  // namespace reflection
