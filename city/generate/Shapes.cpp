#include "city/generate/Shapes.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/Random.h"

namespace city {

namespace {

constexpr float degenerateLength = 1e-6f;  // metres; below it a direction means nothing

glm::vec3 normalOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 n = glm::cross(b - a, c - a);
    const float length = glm::length(n);
    return length > degenerateLength * degenerateLength ? n / length : glm::vec3(0, 0, 1);
}

/// Two unit vectors that make a right-handed frame with the unit axis.
std::array<glm::vec3, 2> across(const glm::vec3& axis) {
    const glm::vec3 helper = std::abs(axis.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    const glm::vec3 u = glm::normalize(glm::cross(helper, axis));
    return {u, glm::cross(axis, u)};
}

}  // namespace

glm::vec2 outward(glm::vec2 a, glm::vec2 b) {
    const glm::vec2 d = b - a;
    const float length = glm::length(d);
    return length > degenerateLength ? glm::vec2(d.y, -d.x) / length : glm::vec2(0, -1);
}

void addWall(Mesh& mesh, glm::vec2 a, glm::vec2 b, float z0, float z1, std::uint32_t material, float uRepeats,
             float vRepeats) {
    const glm::vec3 n(outward(a, b), 0);
    mesh.addQuad({{a, z0}, n, {0, 0}, material}, {{b, z0}, n, {uRepeats, 0}, material},
                 {{b, z1}, n, {uRepeats, vRepeats}, material}, {{a, z1}, n, {0, vRepeats}, material});
}

void addPanel(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
              std::uint32_t material, float u, float v) {
    const glm::vec3 n = normalOf(a, b, c);
    mesh.addQuad({a, n, {0, 0}, material}, {b, n, {u, 0}, material}, {c, n, {u, v}, material},
                 {d, n, {0, v}, material});
}

void addFacet(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t material,
              float repeat) {
    const glm::vec3 n = normalOf(a, b, c);
    const glm::vec3 side = b - a;
    const float length = glm::length(side);
    const glm::vec3 u = length > degenerateLength ? side / length : glm::vec3(1, 0, 0);
    const glm::vec3 v = glm::cross(n, u);
    const auto corner = [&](const glm::vec3& p) {
        return Vertex{p, n, glm::vec2(glm::dot(p - a, u), glm::dot(p - a, v)) / repeat, material};
    };
    mesh.addTriangle(corner(a), corner(b), corner(c));
}

void addDeck(Mesh& mesh, std::span<const glm::vec2> ring, float z, std::uint32_t material, float repeat,
             bool up) {
    if (ring.size() < 3) return;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::vec2& p : ring)
        mesh.vertices.push_back({{p, z}, {0, 0, up ? 1 : -1}, p / repeat, material});
    for (std::uint32_t i = 1; i + 1 < ring.size(); ++i) {
        mesh.indices.insert(mesh.indices.end(), {base, base + (up ? i : i + 1), base + (up ? i + 1 : i)});
    }
}

void addPrism(Mesh& mesh, std::span<const glm::vec2> ring, float z0, float z1, std::uint32_t side,
              std::uint32_t top, float repeat) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::vec2 a = ring[i], b = ring[(i + 1) % ring.size()];
        addWall(mesh, a, b, z0, z1, side, glm::length(b - a) / repeat, (z1 - z0) / repeat);
    }
    addDeck(mesh, ring, z1, top, repeat);
}

void addBox(Mesh& mesh, glm::vec2 origin, glm::vec2 along, const BoxExtent& e, std::uint32_t material,
            unsigned faces, float repeat) {
    const glm::vec2 out(along.y, -along.x);
    const auto at = [&](float s, float t) { return origin + s * along + t * out; };
    const auto wall = [&](glm::vec2 a, glm::vec2 b) {
        addWall(mesh, a, b, e.z0, e.z1, material, glm::length(b - a) / repeat, (e.z1 - e.z0) / repeat);
    };
    const std::array ring{at(e.s0, e.t1), at(e.s1, e.t1), at(e.s1, e.t0), at(e.s0, e.t0)};
    if (faces & boxFront) wall(ring[0], ring[1]);
    if (faces & boxRight) wall(ring[1], ring[2]);
    if (faces & boxBack) wall(ring[2], ring[3]);
    if (faces & boxLeft) wall(ring[3], ring[0]);
    if (faces & boxTop) addDeck(mesh, ring, e.z1, material, repeat);
    if (faces & boxBottom) addDeck(mesh, ring, e.z0, material, repeat, false);
}

void addTube(Mesh& mesh, const glm::vec3& p0, const glm::vec3& p1, float radius0, float radius1, int sides,
             std::uint32_t material, float repeat) {
    const float length = glm::length(p1 - p0);
    if (!(length > degenerateLength) || sides < 3) return;
    const glm::vec3 axis = (p1 - p0) / length;
    const auto [u, v] = across(axis);
    const float slope = (radius0 - radius1) / length;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    // Whole repeats around, so that the seam closes.
    const float around = std::max(1.0f, std::round(6.2831853f * std::max(radius0, radius1) / repeat));
    for (int i = 0; i <= sides; ++i) {
        const float f = static_cast<float>(i) / static_cast<float>(sides);
        const Turn turn(f);
        const glm::vec3 d = turn.cos * u + turn.sin * v;
        const glm::vec3 n = glm::normalize(d + slope * axis);
        mesh.vertices.push_back({p0 + radius0 * d, n, {around * f, 0}, material});
        mesh.vertices.push_back({p1 + radius1 * d, n, {around * f, length / repeat}, material});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
        const std::uint32_t a = base + 2 * i;
        if (radius0 > 0) mesh.indices.insert(mesh.indices.end(), {a, a + 2, a + 1});
        if (radius1 > 0) mesh.indices.insert(mesh.indices.end(), {a + 1, a + 2, a + 3});
    }
}

void addLathe(Mesh& mesh, const glm::vec3& foot, std::span<const glm::vec2> profile, int sides,
              std::uint32_t material, float repeat) {
    float along = 0;
    for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
        const glm::vec2 a = profile[k], b = profile[k + 1];
        const float length = glm::length(b - a);
        if (!(length > degenerateLength)) continue;
        const glm::vec2 n2 = glm::vec2(b.y - a.y, a.x - b.x) / length;
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (int i = 0; i <= sides; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(sides);
            const Turn turn(f);
            const glm::vec3 n(n2.x * turn.cos, n2.x * turn.sin, n2.y);
            const float around = std::max(1.0f, std::round(6.2831853f * std::max(a.x, b.x) / repeat));
            const auto at = [&](glm::vec2 p) {
                return foot + glm::vec3(p.x * turn.cos, p.x * turn.sin, p.y);
            };
            mesh.vertices.push_back({at(a), n, {around * f, along / repeat}, material});
            mesh.vertices.push_back({at(b), n, {around * f, (along + length) / repeat}, material});
        }
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
            const std::uint32_t v = base + 2 * i;
            if (a.x > 0) mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1});
            if (b.x > 0) mesh.indices.insert(mesh.indices.end(), {v + 1, v + 2, v + 3});
        }
        along += length;
    }
}

}  // namespace city
