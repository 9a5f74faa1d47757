#include "app/mirrors/LitShapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace app {

namespace {

void addQuad(LitMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
             const glm::vec3& colour) {
    const auto base = static_cast<std::uint32_t>(mesh.corners.size());
    const glm::vec3 normal = glm::normalize(glm::cross(b - a, d - a));
    for (const glm::vec3& p : {a, b, c, d}) mesh.corners.push_back({p, normal, colour});
    for (std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(base + i);
}

}  // namespace

LitMesh litPanel(const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v, int columns, int rows,
                 const glm::vec3& colour, const glm::vec3& second) {
    LitMesh mesh;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto at = [&](int x, int y) {
                return origin + u * (static_cast<float>(x) / static_cast<float>(columns)) +
                       v * (static_cast<float>(y) / static_cast<float>(rows));
            };
            addQuad(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1),
                    (i + j) % 2 == 0 ? colour : second);
        }
    return mesh;
}

LitMesh litBox(const glm::vec3& low, const glm::vec3& high, const glm::vec3& colour) {
    LitMesh mesh;
    const auto p = [&](int x, int y, int z) {
        return glm::vec3(x != 0 ? high.x : low.x, y != 0 ? high.y : low.y, z != 0 ? high.z : low.z);
    };
    addQuad(mesh, p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0), colour);
    addQuad(mesh, p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1), colour);
    addQuad(mesh, p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1), colour);
    addQuad(mesh, p(1, 1, 0), p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), colour);
    addQuad(mesh, p(0, 1, 0), p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), colour);
    addQuad(mesh, p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1), colour);
    return mesh;
}

LitMesh litBall(const glm::vec3& centre, float radius, int slices, int stacks, const glm::vec3& colour) {
    LitMesh mesh;
    const auto add = [&](const glm::vec3& n) {
        mesh.corners.push_back({centre + radius * n, n, colour});
        return static_cast<std::uint32_t>(mesh.corners.size() - 1);
    };
    const std::uint32_t bottom = add({0, 0, -1});
    for (int j = 1; j < stacks; ++j)
        for (int i = 0; i < slices; ++i) {
            const double polar = 3.14159265358979 * j / stacks, around = 6.28318530717959 * i / slices;
            add({static_cast<float>(std::sin(polar) * std::cos(around)),
                 static_cast<float>(std::sin(polar) * std::sin(around)),
                 static_cast<float>(-std::cos(polar))});
        }
    const std::uint32_t top = add({0, 0, 1});
    const auto at = [&](int i, int j) {
        return bottom + 1 + static_cast<std::uint32_t>((j - 1) * slices + i % slices);
    };
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.indices.insert(mesh.indices.end(), {a, b, c});
    };
    for (int i = 0; i < slices; ++i) {
        triangle(bottom, at(i + 1, 1), at(i, 1));
        for (int j = 1; j + 1 < stacks; ++j) {
            triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
        triangle(at(i, stacks - 1), at(i + 1, stacks - 1), top);
    }
    return mesh;
}

LitMesh litPillar(const glm::vec3& foot, float radius, float height, int slices, const glm::vec3& colour) {
    LitMesh mesh;
    for (int i = 0; i <= slices; ++i) {
        const double around = 6.28318530717959 * i / slices;
        const glm::vec3 n(static_cast<float>(std::cos(around)), static_cast<float>(std::sin(around)), 0);
        mesh.corners.push_back({foot + radius * n, n, colour});
        mesh.corners.push_back({foot + radius * n + glm::vec3(0, 0, height), n, colour});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(slices); ++i)
        mesh.indices.insert(mesh.indices.end(), {2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1});
    return mesh;
}

void bakeLight(LitMesh& mesh) {
    const glm::vec3 towards = glm::normalize(glm::vec3(0.35f, -0.6f, 0.72f));
    for (LitMesh::Corner& c : mesh.corners) {
        const float even = 0.45f + 0.2f * c.normal.z,
                    direct = 0.45f * std::max(glm::dot(c.normal, towards), 0.f);
        c.colour = glm::min(c.colour * (even + direct), glm::vec3(1));
    }
}

LitMesh subdivided(const LitMesh& mesh, float longest) {
    LitMesh fine;
    struct Triangle {
        LitMesh::Corner a, b, c;
    };
    std::vector<Triangle> left;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        left.push_back({mesh.corners[mesh.indices[i]], mesh.corners[mesh.indices[i + 1]],
                        mesh.corners[mesh.indices[i + 2]]});
    const auto middle = [](const LitMesh::Corner& a, const LitMesh::Corner& b) {
        const glm::vec3 n = a.normal + b.normal;
        return LitMesh::Corner{0.5f * (a.position + b.position),
                               glm::dot(n, n) > 0 ? glm::normalize(n) : a.normal,
                               0.5f * (a.colour + b.colour)};
    };
    while (!left.empty()) {
        const Triangle t = left.back();
        left.pop_back();
        const float ab = glm::distance(t.a.position, t.b.position),
                    bc = glm::distance(t.b.position, t.c.position),
                    ca = glm::distance(t.c.position, t.a.position);
        if (!(std::max({ab, bc, ca}) > longest)) {
            const auto base = static_cast<std::uint32_t>(fine.corners.size());
            fine.corners.insert(fine.corners.end(), {t.a, t.b, t.c});
            fine.indices.insert(fine.indices.end(), {base, base + 1, base + 2});
            continue;
        }
        // The longest edge is halved, on both its sides alike: no cracks.
        if (ab >= bc && ab >= ca) {
            const LitMesh::Corner m = middle(t.a, t.b);
            left.push_back({t.a, m, t.c});
            left.push_back({m, t.b, t.c});
        } else if (bc >= ca) {
            const LitMesh::Corner m = middle(t.b, t.c);
            left.push_back({t.a, t.b, m});
            left.push_back({t.a, m, t.c});
        } else {
            const LitMesh::Corner m = middle(t.c, t.a);
            left.push_back({t.a, t.b, m});
            left.push_back({m, t.b, t.c});
        }
    }
    return fine;
}

city::Mesh withoutLight(const LitMesh& mesh) {
    city::Mesh surface;
    for (const LitMesh::Corner& c : mesh.corners) {
        city::Vertex v;
        v.position = c.position;
        v.normal = c.normal;
        surface.vertices.push_back(v);
    }
    surface.indices = mesh.indices;
    return surface;
}

}  // namespace app
