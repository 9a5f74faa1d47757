#include "city/model/RoofPlanes.h"

#include <algorithm>
#include <cmath>

#include "city/model/PolygonAlgebra.h"

namespace city {

namespace {

/// A footprint that fills this share of its oriented bounding rectangle carries a pitched roof; an L with
/// arms a third of its length wide fills 5/9, a house with a bay window or slanted end more than this.
constexpr double leastRectangularity = 0.8;

}  // namespace

std::vector<RoofPlane> roofPlanes(const Footprint& clean, RoofShape roof, double eaves, double ridge) {
    const double rise = ridge - eaves;
    if (roof == RoofShape::flat || roof == RoofShape::dome || !(rise > cornerTolerance) ||
        !clean.holes.empty())
        return {};
    const auto rectangle = orientedRectangle(clean);
    if (!rectangle || !(rectangle->half.y > 0)) return {};
    if (area(clean) < leastRectangularity * double(rectangle->area())) return {};

    const glm::dvec2 along = rectangle->axis;
    const glm::dvec2 across(-along.y, along.x);
    const glm::dvec2 half = rectangle->half;
    const glm::dvec2 centre = rectangle->centre;
    std::vector<RoofPlane> planes;
    const auto rising = [&](glm::dvec2 inward, double distance, double slope) {
        planes.push_back({inward * slope, centre - inward * distance, eaves});
    };
    rising(across, half.y, rise / half.y);
    rising(-across, half.y, rise / half.y);
    if (roof == RoofShape::hipped || roof == RoofShape::pyramidal) {
        const double slope = roof == RoofShape::hipped ? rise / half.y : rise / half.x;
        rising(along, half.x, slope);
        rising(-along, half.x, slope);
    }
    return planes;
}

bool carriesRoof(const Footprint& clean, RoofShape roof) {
    if (roof == RoofShape::flat) return true;
    if (roof == RoofShape::dome) return domeCentre(clean).has_value();
    return !roofPlanes(clean, roof, 0, 1).empty();
}

std::optional<glm::dvec2> domeCentre(const Footprint& clean) {
    if (!clean.holes.empty() || clean.outer.size() < 3) return std::nullopt;
    const std::size_t n = clean.outer.size();
    const glm::dvec2 origin = clean.outer.front();
    const auto at = [&](std::size_t i) { return glm::dvec2(clean.outer[i % n]) - origin; };
    glm::dvec2 moment(0);
    double twice = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double cross = at(i).x * at(i + 1).y - at(i).y * at(i + 1).x;
        twice += cross;
        moment += cross * (at(i) + at(i + 1));
    }
    if (!(twice > 0)) return std::nullopt;
    const glm::dvec2 centre = moment / (3 * twice);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec2 a = at(i) - centre;
        const glm::dvec2 b = at(i + 1) - centre;
        if (!(a.x * b.y - a.y * b.x > 0)) return std::nullopt;
    }
    return centre + origin;
}

double roofHeight(const std::vector<RoofPlane>& planes, glm::dvec2 p) {
    double lowest = planes.front().height(p);
    for (const RoofPlane& plane : planes) lowest = std::min(lowest, plane.height(p));
    return lowest;
}

std::vector<double> roofBreaks(const std::vector<RoofPlane>& planes, glm::dvec2 a, glm::dvec2 b) {
    std::vector<double> breaks;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        for (std::size_t j = i + 1; j < planes.size(); ++j) {
            const double atA = planes[i].height(a) - planes[j].height(a);
            const double atB = planes[i].height(b) - planes[j].height(b);
            if (!(atA * atB < 0)) continue;
            const double t = atA / (atA - atB);
            const glm::dvec2 p = a + t * (b - a);
            if (planes[i].height(p) <= roofHeight(planes, p) + 1e-6) breaks.push_back(t);
        }
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
}

std::vector<glm::vec2> roofRegion(const std::vector<RoofPlane>& planes, std::size_t index, glm::dvec2 centre,
                                  double reach) {
    std::vector<glm::dvec2> ring{centre + glm::dvec2(-reach, -reach), centre + glm::dvec2(reach, -reach),
                                 centre + glm::dvec2(reach, reach), centre + glm::dvec2(-reach, reach)};
    for (std::size_t other = 0; other < planes.size(); ++other) {
        if (other == index) continue;
        const auto excess = [&](glm::dvec2 p) { return planes[index].height(p) - planes[other].height(p); };
        std::vector<glm::dvec2> clipped;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec2 a = ring[i];
            const glm::dvec2 b = ring[(i + 1) % ring.size()];
            const double atA = excess(a);
            const double atB = excess(b);
            if (atA <= 0) clipped.push_back(a);
            if ((atA < 0 && atB > 0) || (atA > 0 && atB < 0))
                clipped.push_back(a + (atA / (atA - atB)) * (b - a));
        }
        ring = std::move(clipped);
    }
    return {ring.begin(), ring.end()};
}

}  // namespace city
