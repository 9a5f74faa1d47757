#include "reflection/chrome/StarCentre.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace reflection {

double starMargin(const FacingTriangle& triangle, const glm::dvec3& centre, double sign) {
    double margin = 1;
    for (const glm::dvec3& p : triangle.corners) {
        const glm::dvec3 line = p - centre;
        const double length = glm::length(line);
        margin = std::min(margin, length > 0 ? sign * glm::dot(triangle.normal, line) / length : -1.0);
    }
    return margin;
}

namespace {

double leastMargin(const std::vector<FacingTriangle>& triangles, const glm::dvec3& centre, double sign) {
    double least = 1;
    for (const FacingTriangle& t : triangles) least = std::min(least, starMargin(t, centre, sign));
    return least;
}

}  // namespace

double drawStarCentre(const std::vector<FacingTriangle>& triangles, double sign, const glm::dvec3& target,
                      double least, glm::dvec3& centre) {
    const glm::dvec3 from = centre;
    const double wanted = std::min(least, leastMargin(triangles, from, sign));
    double near = 0, far = 1;
    for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (near + far);
        if (leastMargin(triangles, target + middle * (from - target), sign) >= wanted)
            far = middle;
        else
            near = middle;
    }
    centre = target + far * (from - target);
    return leastMargin(triangles, centre, sign);
}

double findStarCentre(const std::vector<FacingTriangle>& triangles, double sign, double wanted, int steps,
                      glm::dvec3& centre) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const FacingTriangle& t : triangles)
        for (const glm::dvec3& p : t.corners) low = glm::min(low, p), high = glm::max(high, p);
    const double size = glm::length(high - low);
    glm::dvec3 at = centre;
    double best = -2;
    for (int k = 0; k <= steps; ++k) {
        double worst = 2;
        const FacingTriangle* facing = nullptr;
        for (const FacingTriangle& t : triangles) {
            const double margin = starMargin(t, at, sign);
            if (margin < worst) worst = margin, facing = &t;
        }
        if (worst > best) {
            best = worst;
            centre = at;
        }
        if (facing == nullptr || best >= wanted) break;
        // A series that falls slowly enough to reach anywhere and fast enough to settle.
        at -= (0.1 * size / std::sqrt(1.0 + k)) * sign * facing->normal;
        // From farther away than the triangles' own size they would cover few cells of a map.
        const glm::dvec3 middle = 0.5 * (low + high);
        const double away = glm::length(at - middle);
        if (away > size) at = middle + (size / away) * (at - middle);
    }
    return best;
}

}  // namespace reflection
