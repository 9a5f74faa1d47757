#include "city/model/StandingReflector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>
#include <vector>

namespace city {

namespace {

constexpr int mostDetail = 5;

/// Points of a circle by halving angles from a hexagon's: roots and sums alone, the same bits everywhere.
std::vector<glm::vec2> circle(int doublings) {
    const double root = std::sqrt(0.75);
    std::vector<glm::dvec2> points{{1, 0}, {0.5, root}, {-0.5, root}, {-1, 0}, {-0.5, -root}, {0.5, -root}};
    for (int k = 0; k < doublings; ++k) {
        std::vector<glm::dvec2> finer;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec2 sum = points[i] + points[(i + 1) % points.size()];
            finer.push_back(points[i]);
            finer.push_back(sum / std::sqrt(sum.x * sum.x + sum.y * sum.y));
        }
        points = std::move(finer);
    }
    std::vector<glm::vec2> result;
    for (const glm::dvec2& p : points) result.emplace_back(p);
    return result;
}

/// Unit sphere out of an icosahedron.
struct Globe {
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::uint32_t, 3>> faces;

    explicit Globe(int detail) {
        const double g = (1 + std::sqrt(5.0)) / 2, length = std::sqrt(1 + g * g);
        for (const double s : {-1.0, 1.0})
            for (const double t : {-1.0, 1.0}) {
                points.push_back(glm::dvec3(0, s, t * g) / length);
                points.push_back(glm::dvec3(s, t * g, 0) / length);
                points.push_back(glm::dvec3(t * g, 0, s) / length);
            }
        // Its faces are the triples of points that are an edge apart.
        const double edge = 2 / length;
        const auto joined = [&](std::uint32_t a, std::uint32_t b) {
            return glm::distance(points[a], points[b]) < 1.01 * edge;
        };
        for (std::uint32_t a = 0; a < 12; ++a)
            for (std::uint32_t b = a + 1; b < 12; ++b)
                for (std::uint32_t c = b + 1; c < 12; ++c) {
                    if (!joined(a, b) || !joined(b, c) || !joined(c, a)) continue;
                    const bool outwards =
                        glm::dot(points[a], glm::cross(points[b] - points[a], points[c] - points[a])) > 0;
                    faces.push_back(outwards ? std::array{a, b, c} : std::array{a, c, b});
                }
        for (int k = 0; k < detail; ++k) divide();
    }

    void divide() {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, isNew] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
            if (isNew) {
                const glm::dvec3 sum = points[a] + points[b];
                points.push_back(sum / std::sqrt(glm::dot(sum, sum)));
            }
            return place->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
};

bool sound(const StandingReflector& reflector) {
    return std::isfinite(reflector.radius) && std::isfinite(reflector.height) && reflector.radius > 0 &&
           reflector.height > 0;
}

}  // namespace

Mesh reflectorMesh(const StandingReflector& reflector, int detail) {
    Mesh mesh;
    if (!sound(reflector)) return mesh;
    detail = std::clamp(detail, 0, mostDetail);
    if (reflector.shape == StandingReflector::Shape::sphere) {
        const Globe globe(detail);
        const glm::vec3 centre(0, 0, reflector.radius);
        for (const glm::dvec3& p : globe.points) {
            const glm::vec3 normal(p);
            mesh.vertices.push_back({centre + reflector.radius * normal, normal, {0, 0}, 0});
        }
        for (const auto& face : globe.faces)
            mesh.indices.insert(mesh.indices.end(), face.begin(), face.end());
        return mesh;
    }
    const std::vector<glm::vec2> ring = circle(detail);
    const auto sides = static_cast<std::uint32_t>(ring.size());
    for (const glm::vec2& p : ring)
        for (const float z : {0.0f, reflector.height})
            mesh.vertices.push_back({{reflector.radius * p, z}, {p, 0}, {0, 0}, 0});
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
        mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
    const auto lid = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::vec2& p : ring)
        mesh.vertices.push_back({{reflector.radius * p, reflector.height}, {0, 0, 1}, {0, 0}, 0});
    mesh.vertices.push_back({{0, 0, reflector.height}, {0, 0, 1}, {0, 0}, 0});
    for (std::uint32_t i = 0; i < sides; ++i)
        mesh.indices.insert(mesh.indices.end(), {lid + sides, lid + i, lid + (i + 1) % sides});
    return mesh;
}

float reflectorMeshError(const StandingReflector& reflector, int detail) {
    if (!sound(reflector)) return 0;
    detail = std::clamp(detail, 0, mostDetail);
    double nearest = 1;
    if (reflector.shape == StandingReflector::Shape::sphere) {
        const Globe globe(detail);
        for (const auto& [a, b, c] : globe.faces)
            nearest =
                std::min(nearest, glm::length((globe.points[a] + globe.points[b] + globe.points[c]) / 3.0));
    } else {
        const std::vector<glm::vec2> ring = circle(detail);
        nearest = glm::length(0.5 * (glm::dvec2(ring[0]) + glm::dvec2(ring[1])));
    }
    return static_cast<float>((1 - nearest) * reflector.radius);
}

}  // namespace city
