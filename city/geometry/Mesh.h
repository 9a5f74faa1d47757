#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "city/geometry/Aabb.h"

namespace city {

/// One corner of a triangle mesh.
struct Vertex {
    glm::vec3 position{0};       ///< metres
    glm::vec3 normal{0, 0, 1};   ///< unit length
    glm::vec2 texcoord{0};       ///< in repeats of the material's pattern (see Material)
    std::uint32_t material = 0;  ///< index into the owner's material table
};

/// Indexed triangles, counter-clockwise seen from their front. Vertices are shared only where position,
/// normal, texture coordinate and material all agree.
struct Mesh {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;  ///< three per triangle

    std::size_t triangleCount() const { return indices.size() / 3; }
    bool empty() const { return indices.empty(); }

    Aabb bounds() const {
        Aabb box;
        for (const Vertex& v : vertices) box.extend(v.position);
        return box;
    }

    /// Adds the other mesh's triangles behind these. Cost: linear in the other mesh.
    void append(const Mesh& other) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        indices.reserve(indices.size() + other.indices.size());
        for (std::uint32_t i : other.indices) indices.push_back(base + i);
    }

    /// Adds one flat triangle corner by corner order a, b, c (counter-clockwise from the front).
    void addTriangle(const Vertex& a, const Vertex& b, const Vertex& c) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c});
        indices.insert(indices.end(), {base, base + 1, base + 2});
    }

    /// Adds the quad a, b, c, d (counter-clockwise from the front) as two triangles.
    void addQuad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c, d});
        indices.insert(indices.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
    }
};

}  // namespace city
