#include "reflection/chrome/PrincipalAxes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace reflection {

namespace {

/// Eigenvectors of a symmetric matrix as columns. Jacobi's method converges quadratically; a few sweeps over
/// the three pairs reach rounding.
glm::dmat3 eigenvectors(glm::dmat3 a) {
    glm::dmat3 v(1);
    for (int sweep = 0; sweep < 12; ++sweep)
        for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
            if (a[p][q] == 0) continue;
            const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
            const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
            const double c = 1 / std::sqrt(t * t + 1), s = t * c;
            glm::dmat3 turn(1);
            turn[p][p] = c, turn[q][q] = c, turn[q][p] = s, turn[p][q] = -s;
            a = glm::transpose(turn) * a * turn;
            v = v * turn;
        }
    return v;
}

}  // namespace

PrincipalBox principalBox(const std::vector<std::array<glm::dvec3, 3>>& triangles) {
    PrincipalBox box;
    glm::dvec3 mean(0);
    double area = 0;
    const auto areaOf = [](const std::array<glm::dvec3, 3>& t) {
        return glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) / 2;
    };
    for (const auto& t : triangles) {
        mean += areaOf(t) * (t[0] + t[1] + t[2]) / 3.0;
        area += areaOf(t);
    }
    if (area > 0) {
        mean /= area;
        glm::dmat3 covariance(0);
        for (const auto& t : triangles)
            for (const glm::dvec3& p : t) covariance += areaOf(t) * glm::outerProduct(p - mean, p - mean);
        box.axes = eigenvectors(covariance);
        box.axes[2] = glm::cross(box.axes[0], box.axes[1]);
    }
    glm::dvec3 low(1e300), high(-1e300);
    for (const auto& t : triangles)
        for (const glm::dvec3& p : t) {
            const glm::dvec3 local = p * box.axes;
            low = glm::min(low, local), high = glm::max(high, local);
        }
    if (triangles.empty()) return box;
    box.middle = box.axes * ((low + high) * 0.5);
    box.halfExtent = (high - low) * 0.5;
    return box;
}

}  // namespace reflection
