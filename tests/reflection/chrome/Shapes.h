#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec3.hpp>
#include <random>

#include "city/geometry/Mesh.h"

namespace reflection {

/// Fills position and normal of a surface in a direction from the origin.
using StarShape = std::function<void(const glm::dvec3& direction, glm::dvec3& position, glm::dvec3& normal)>;

/// A star-shaped surface as a mesh of rings and sectors, from one polar angle to another (radians from +z).
/// `inward`: triangles and normals face the origin.
inline city::Mesh meshOf(const StarShape& shape, int rings, double fromPolar = 0,
                         double toPolar = glm::pi<double>(), bool inward = false) {
    city::Mesh mesh;
    const int sectors = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= sectors; ++i) {
            const double polar = fromPolar + (toPolar - fromPolar) * j / rings;
            const double turn = glm::two_pi<double>() * (i % sectors) / sectors;
            glm::dvec3 p, n;
            // A pole is one point, not a ring of rounding errors.
            const double sine = polar > glm::pi<double>() - 1e-9 ? 0.0 : std::sin(polar);
            shape({sine * std::cos(turn), sine * std::sin(turn), std::cos(polar)}, p, n);
            city::Vertex v;
            v.position = glm::vec3(p);
            v.normal = glm::vec3(inward ? -n : n);
            mesh.vertices.push_back(v);
        }
    const auto row = static_cast<std::uint32_t>(sectors + 1);
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rings); ++j)
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sectors); ++i) {
            const std::uint32_t a = j * row + i, b = a + 1, c = a + row, d = c + 1;
            if (inward)
                mesh.indices.insert(mesh.indices.end(), {a, d, c, a, b, d});
            else
                mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
        }
    return mesh;
}

inline StarShape ellipsoid(const glm::dvec3& radii) {
    return [radii](const glm::dvec3& d, glm::dvec3& p, glm::dvec3& n) {
        p = d * radii;
        n = glm::normalize(d / radii);
    };
}

/// |x|^e + |y|^e + |z|^e = 1, stretched: a rounded box, nearly flat on its sides.
inline StarShape roundedBox(const glm::dvec3& radii, double e) {
    return [radii, e](const glm::dvec3& d, glm::dvec3& p, glm::dvec3& n) {
        const glm::dvec3 a = glm::abs(d);
        const double q = std::pow(std::pow(a.x, e) + std::pow(a.y, e) + std::pow(a.z, e), 1 / e);
        p = d / q * radii;
        n = glm::normalize(glm::sign(d) * glm::pow(a / q, glm::dvec3(e - 1)) / radii);
    };
}

/// A ring around z.
inline city::Mesh torus(double ring, double tube, int around, int across) {
    city::Mesh mesh;
    for (int j = 0; j <= around; ++j)
        for (int i = 0; i <= across; ++i) {
            const double a = glm::two_pi<double>() * (j % around) / around;
            const double b = glm::two_pi<double>() * (i % across) / across;
            const glm::dvec3 out(std::cos(a), std::sin(a), 0);
            const glm::dvec3 n = out * std::cos(b) + glm::dvec3(0, 0, std::sin(b));
            city::Vertex v;
            v.position = glm::vec3(out * ring + n * tube);
            v.normal = glm::vec3(n);
            mesh.vertices.push_back(v);
        }
    const auto row = static_cast<std::uint32_t>(across + 1);
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(around); ++j)
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(across); ++i) {
            const std::uint32_t a = j * row + i, b = a + 1, c = a + row, d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
        }
    return mesh;
}

/// A square plate in the plane z = 0, facing +z.
inline city::Mesh plate(float half) {
    const auto corner = [half](float x, float y) {
        return city::Vertex{{x * half, y * half, 0}, {0, 0, 1}, {}, 0};
    };
    city::Mesh mesh;
    mesh.addQuad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
    return mesh;
}

/// Seeded points; the same on every machine.
class Scatter {
  public:
    explicit Scatter(std::uint64_t seed) : bits(seed) {}
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 d(between(-1, 1), between(-1, 1), between(-1, 1));
            const double length = glm::length(d);
            if (length > 0.1 && length < 1) return d / length;
        }
    }

  private:
    std::mt19937_64 bits;
};

/// Radians between the bisector towards eye and vertex and a normal, in double precision throughout.
inline double bisectorAngle(const glm::dvec3& eye, const glm::dvec3& vertex, const glm::dvec3& point,
                            const glm::dvec3& normal) {
    const glm::dvec3 h = glm::normalize(eye - point) + glm::normalize(vertex - point);
    return std::atan2(glm::length(glm::cross(h, normal)), glm::dot(h, normal));
}

}  // namespace reflection
