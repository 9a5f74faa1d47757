#include "app/commands/FacingFronts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace app {

std::vector<FacingFronts> facingFronts(std::span<const city::GlassFront> fronts, const FacingLimits& limits) {
    std::vector<FacingFronts> found;
    for (std::uint32_t i = 0; i < fronts.size(); ++i) {
        const city::GlassFront& one = fronts[i];
        const double width = glm::length(one.outline[1] - one.outline[0]);
        if (one.pattern != city::Pattern::shopFront || !(width > 0)) continue;
        const glm::dvec3 along = (one.outline[1] - one.outline[0]) / width;
        for (std::uint32_t j = 0; j < fronts.size(); ++j) {
            const city::GlassFront& other = fronts[j];
            if (other.pattern != city::Pattern::shopFront ||
                !(glm::dot(one.normal, other.normal) <= limits.mostTurn - 1))
                continue;
            // What lies right across, in metres along `one`.
            const double a = glm::dot(other.outline[0] - one.outline[0], along);
            const double b = glm::dot(other.outline[1] - one.outline[0], along);
            const double from = std::max(0.0, std::min(a, b)), to = std::min(width, std::max(a, b));
            if (!(to - from >= limits.leastOverlap)) continue;
            const double t = (0.5 * (from + to) - a) / (b - a);
            const glm::dvec3 faced = other.outline[0] + t * (other.outline[1] - other.outline[0]);
            const double across = glm::dot(faced - one.outline[0], one.normal);
            if (!(across >= limits.nearest && across <= limits.farthest)) continue;
            const double low = std::max(one.outline[0].z, other.outline[0].z),
                         high = std::min(one.outline[2].z, other.outline[2].z);
            if (!(high > low)) continue;
            found.push_back({i, j, across, from, to});
        }
    }
    std::stable_sort(found.begin(), found.end(), [](const FacingFronts& a, const FacingFronts& b) {
        return (a.to - a.from) * b.across > (b.to - b.from) * a.across;
    });
    return found;
}

std::optional<FrontHit> meetFront(const city::GlassFront& front, const glm::dvec3& origin,
                                  const glm::dvec3& direction) {
    const double towards = -glm::dot(direction, front.normal);
    const double before = glm::dot(origin - front.outline[0], front.normal);
    const double length = glm::length(direction), width = glm::length(front.outline[1] - front.outline[0]);
    if (!(towards > 0) || !(before > 0) || !(width > 0) || !std::isfinite(length)) return std::nullopt;
    FrontHit hit;
    hit.way = before / towards;
    hit.at = origin + hit.way * direction;
    const glm::dvec3 from = hit.at - front.outline[0];
    hit.along = glm::dot(from, front.outline[1] - front.outline[0]) / width;
    hit.up = from.z;
    if (!(hit.along >= 0 && hit.along <= width && hit.up >= 0 &&
          hit.up <= front.outline[2].z - front.outline[0].z))
        return std::nullopt;
    hit.cosine = towards / length;
    hit.mirror = mirroredBy(front.normal, direction);
    return hit;
}

glm::dvec3 mirroredBy(const glm::dvec3& normal, const glm::dvec3& direction) {
    return direction - 2 * glm::dot(direction, normal) * normal;
}

double schlick(double straight, double cosine) {
    return straight + (1 - straight) * std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5);
}

}  // namespace app
