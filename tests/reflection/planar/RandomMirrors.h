#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "reflection/planar/MirrorPlane.h"

/// Seeded points, directions and mirrors across magnitudes. Own distributions: the standard's differ between
/// libraries.
struct RandomMirrors {
    std::mt19937_64 engine;
    explicit RandomMirrors(std::uint64_t seed) : engine(seed) {}

    double unit() { return static_cast<double>(engine() >> 11) * 0x1p-53; }
    double between(double a, double b) { return a + (b - a) * unit(); }
    double magnitude(double low, double high) { return low * std::pow(high / low, unit()); }
    glm::dvec3 direction() {
        const double z = between(-1, 1), a = between(0, 6.283185307179586), r = std::sqrt(1 - z * z);
        return {r * std::cos(a), r * std::sin(a), z};
    }
    /// A regular polygon of 3 .. 8 corners, squeezed by up to ten.
    std::vector<glm::dvec3> polygon(const glm::dvec3& centre, const glm::dvec3& normal, double radius) {
        const glm::dvec3 u = glm::normalize(
            glm::cross(normal, std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
        const glm::dvec3 v = glm::cross(normal, u);
        const auto n = static_cast<int>(between(3, 8.999));
        const double turn = between(0, 6.28), squeeze = between(0.1, 1);
        std::vector<glm::dvec3> corners;
        for (int i = 0; i < n; ++i) {
            const double a = 6.283185307179586 * i / n + turn;
            corners.push_back(centre + radius * (std::cos(a) * u + squeeze * std::sin(a) * v));
        }
        return corners;
    }
};
