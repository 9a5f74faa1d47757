#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "city/model/CityModel.h"

/// What must hold for every mesh of every generated city.
inline void checkMesh(const city::Mesh& mesh, std::size_t materials, const std::string& what) {
    ASSERT_EQ(mesh.indices.size() % 3, 0u) << what;
    for (const std::uint32_t i : mesh.indices) ASSERT_LT(i, mesh.vertices.size()) << what;
    for (const city::Vertex& v : mesh.vertices) {
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(v.position[k])) << what;
        ASSERT_TRUE(std::isfinite(v.texcoord.x) && std::isfinite(v.texcoord.y)) << what;
        ASSERT_NEAR(glm::length(v.normal), 1, 1e-3) << what;
        ASSERT_LT(v.material, materials) << what;
    }
}

/// Faces whose winding contradicts their corners' normals: inside out.
inline std::size_t contradictions(const city::Mesh& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const city::Vertex &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]],
                           &c = mesh.vertices[mesh.indices[t + 2]];
        const glm::vec3 n = glm::cross(b.position - a.position, c.position - a.position);
        if (glm::dot(n, a.normal + b.normal + c.normal) < 0) ++count;
    }
    return count;
}

/// Triangles with less than a square millimetre.
inline std::size_t slivers(const city::Mesh& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::vec3 a = mesh.vertices[mesh.indices[t]].position,
                        b = mesh.vertices[mesh.indices[t + 1]].position,
                        c = mesh.vertices[mesh.indices[t + 2]].position;
        if (glm::length(glm::cross(b - a, c - a)) < 2e-6f) ++count;
    }
    return count;
}
