#include "vehicles/models/Parts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace vehicles {
namespace {

city::Vertex corner(const glm::vec3& p, const glm::vec3& n, Surface surface) {
    return {p, n, glm::vec2(0), static_cast<std::uint32_t>(surface)};
}

float signedPower(float base, float exponent) {
    return std::copysign(std::pow(std::abs(base), exponent), base);
}

}  // namespace

void addRevolved(city::Mesh& mesh, const std::vector<glm::vec2>& profile, int segments, Surface surface) {
    const std::size_t n = profile.size();
    if (n < 2) return;
    const auto normalOf = [&](std::size_t i) {  // of the piece from i to i + 1: to the right of its direction
        const glm::vec2 d = profile[i + 1] - profile[i];
        return glm::normalize(glm::vec2(d.y, -d.x));
    };
    constexpr float smooth = 0.766f;  // cosine of 40 degrees
    for (std::size_t i = 0; i + 1 < n; ++i) {
        if (glm::length(profile[i + 1] - profile[i]) < 1e-6f) continue;
        const glm::vec2 own = normalOf(i);
        glm::vec2 first = own, second = own;
        if (i > 0 && glm::dot(normalOf(i - 1), own) > smooth) first = glm::normalize(own + normalOf(i - 1));
        if (i + 2 < n && glm::dot(normalOf(i + 1), own) > smooth)
            second = glm::normalize(own + normalOf(i + 1));
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (int s = 0; s < segments; ++s) {
            const float angle = glm::two_pi<float>() * static_cast<float>(s) / static_cast<float>(segments);
            const float c = std::cos(angle), w = std::sin(angle);
            for (const auto& [at, normal] : {std::pair{profile[i], first}, std::pair{profile[i + 1], second}})
                mesh.vertices.push_back(
                    corner({c * at.y, at.x, w * at.y}, {c * normal.y, normal.x, w * normal.y}, surface));
        }
        const auto count = static_cast<std::uint32_t>(segments);
        for (std::uint32_t s = 0; s < count; ++s) {
            const std::uint32_t a = base + 2 * s, b = base + 2 * ((s + 1) % count);
            if (profile[i].y > 1e-6f) mesh.indices.insert(mesh.indices.end(), {a, b, a + 1});
            if (profile[i + 1].y > 1e-6f) mesh.indices.insert(mesh.indices.end(), {b, b + 1, a + 1});
        }
    }
}

void addRounded(city::Mesh& mesh, const glm::vec3& centre, const glm::vec3& half, float exponent,
                int segments, Surface surface, const glm::mat3& turn) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    const int rows = segments / 2;
    const float e = 2 / exponent;
    for (int r = 0; r <= rows; ++r)
        for (int s = 0; s < segments; ++s) {
            const float u = glm::pi<float>() * (static_cast<float>(r) / static_cast<float>(rows) - 0.5f);
            const float v = glm::two_pi<float>() * static_cast<float>(s) / static_cast<float>(segments);
            const bool pole = r == 0 || r == rows;
            const float cu = pole ? 0.0f : std::cos(u), su = std::sin(u);
            const glm::vec3 unit{signedPower(cu, e) * signedPower(std::cos(v), e),
                                 signedPower(cu, e) * signedPower(std::sin(v), e), signedPower(su, e)};
            glm::vec3 n{0, 0, su};  // at a pole, where the rest would vanish
            if (!pole)
                n = {signedPower(cu, 2 - e) * signedPower(std::cos(v), 2 - e) / half.x,
                     signedPower(cu, 2 - e) * signedPower(std::sin(v), 2 - e) / half.y,
                     signedPower(su, 2 - e) / half.z};
            mesh.vertices.push_back(corner(centre + turn * (half * unit), turn * glm::normalize(n), surface));
        }
    const auto count = static_cast<std::uint32_t>(segments);
    for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(rows); ++r)
        for (std::uint32_t s = 0; s < count; ++s) {
            const std::uint32_t a = base + r * count + s, b = base + r * count + (s + 1) % count;
            // At the poles one edge has no length.
            if (r > 0) mesh.indices.insert(mesh.indices.end(), {a, b, b + count});
            if (r + 1 < static_cast<std::uint32_t>(rows))
                mesh.indices.insert(mesh.indices.end(), {a, b + count, a + count});
        }
}

void addPlate(city::Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
              const glm::vec3& d, Surface surface) {
    const glm::vec3 n = glm::normalize(glm::cross(c - a, d - b));
    mesh.addQuad(corner(a, n, surface), corner(b, n, surface), corner(c, n, surface), corner(d, n, surface));
}

void addBox(city::Mesh& mesh, const glm::vec3& low, const glm::vec3& high, Surface surface) {
    const auto at = [&](int x, int y, int z) {
        return glm::vec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
    };
    addPlate(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1), surface);
    addPlate(mesh, at(0, 1, 0), at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), surface);
    addPlate(mesh, at(1, 1, 0), at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), surface);
    addPlate(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1), surface);
    addPlate(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1), surface);
    addPlate(mesh, at(0, 1, 0), at(1, 1, 0), at(1, 0, 0), at(0, 0, 0), surface);
}

void addBar(city::Mesh& mesh, const glm::vec3& from, const glm::vec3& to, float radius, int segments,
            Surface surface) {
    const glm::vec3 axis = glm::normalize(to - from);
    const glm::vec3 side =
        glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0)));
    const glm::vec3 up = glm::cross(side, axis);
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto count = static_cast<std::uint32_t>(segments);
    for (std::uint32_t s = 0; s < count; ++s) {
        const float angle = glm::two_pi<float>() * static_cast<float>(s) / static_cast<float>(count);
        const glm::vec3 n = std::cos(angle) * side + std::sin(angle) * up;
        mesh.vertices.push_back(corner(from + radius * n, n, surface));
        mesh.vertices.push_back(corner(to + radius * n, n, surface));
    }
    for (std::uint32_t s = 0; s < count; ++s) {
        const std::uint32_t a = base + 2 * s, b = base + 2 * ((s + 1) % count);
        // side x up = -axis, so this order faces outwards.
        mesh.indices.insert(mesh.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
}

void addMirrored(city::Mesh& mesh) {
    city::Mesh image = mesh;
    for (city::Vertex& v : image.vertices) {
        v.position.y = -v.position.y;
        v.normal.y = -v.normal.y;
    }
    for (std::size_t i = 0; i < image.indices.size(); i += 3)
        std::swap(image.indices[i + 1], image.indices[i + 2]);
    mesh.append(image);
}

}  // namespace vehicles
