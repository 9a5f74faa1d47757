#include "vehicles/models/Bumper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "vehicles/models/Bodies.h"
#include "vehicles/models/Levels.h"
#include "vehicles/models/Parts.h"

namespace vehicles {
namespace {

/// The left half of an upright cylinder of 2 m around the origin.
Shell halfCylinder() {
    Shell shell;
    constexpr int sides = 90;
    for (int i = 0; i <= sides; ++i) {
        const float a = std::numbers::pi_v<float> * static_cast<float>(i) / sides;
        for (const float z : {0.0f, 1.0f}) {
            shell.positions.push_back({2 * std::cos(a), 2 * std::sin(a), z});
            shell.normals.push_back({std::cos(a), std::sin(a), 0});
        }
    }
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t a = 2 * i;
        shell.triangles.push_back({{a, a + 1, a + 2}, Surface::paint});
        shell.triangles.push_back({{a + 2, a + 1, a + 3}, Surface::paint});
    }
    return shell;
}

TEST(Bumper, MeetsTheShellWhereARayWould) {
    const Shell shell = halfCylinder();
    for (const float angle : {0.1f, 0.8f, 1.5f, 2.9f}) {
        EXPECT_NEAR(outlineAt(shell, 0.4f, 0, angle), 2, 2e-3f);
        // From beside the axis: by the law of cosines.
        const float c = std::cos(angle);
        EXPECT_NEAR(outlineAt(shell, 0.4f, 0.5f, angle), -0.5f * c + std::sqrt(4 - 0.25f + 0.25f * c * c),
                    2e-3f);
    }
    EXPECT_EQ(outlineAt(shell, 1.5f, 0, 0.3f), 0);   // above it
    EXPECT_EQ(outlineAt(shell, 0.4f, 0, -0.3f), 0);  // the other half
}

TEST(Bumper, FollowsTheShellOutsideItWithNormalsOfItsSurface) {
    const Shell shell = halfCylinder();
    for (const bool rear : {false, true}) {
        BumperShape shape{.z = 0.5f, .halfHeight = 0.06f, .depth = 0.05f, .standOff = 0.02f, .centre = 0};
        shape.rear = rear;
        city::Mesh mesh;
        addBumper(mesh, shell, shape);
        ASSERT_GT(mesh.triangleCount(), 300u);
        float farthest = 0;
        int behind = 0;
        for (const city::Vertex& v : mesh.vertices) {
            const float r = glm::length(glm::vec2(v.position));
            if (r < 2.01f) {
                ++behind;
                EXPECT_EQ(v.position.y, 0);
                continue;
            }
            EXPECT_LT(r, 2.075f);
            EXPECT_LE(std::abs(v.position.z - 0.5f), 0.0601f);
            EXPECT_NEAR(glm::length(v.normal), 1, 1e-5f);
            const glm::vec3 axis(glm::vec2(v.position) * (2.02f / r), 0.5f);
            EXPECT_GT(glm::dot(v.normal, v.position - axis), 0);
            EXPECT_EQ(v.material, static_cast<std::uint32_t>(Surface::chrome));
            EXPECT_EQ(v.position.x < 0, rear);
            farthest = std::max(farthest, r);
            // Both halves must meet without a crease.
            if (v.position.y == 0) {
                EXPECT_EQ(v.normal.y, 0);
            }
        }
        EXPECT_EQ(behind, 2);
        // Facets of 2 degrees, smoothed over some degrees: a little inside the circle.
        EXPECT_NEAR(farthest, 2.07f, 3e-3f);
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const city::Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                               &c = mesh.vertices[mesh.indices[i + 2]];
            const glm::vec3 flat = glm::cross(b.position - a.position, c.position - a.position);
            EXPECT_GT(glm::dot(flat, a.normal + b.normal + c.normal), 0) << i / 3;
        }
    }
}

TEST(Bumper, BothHalvesMakeOneClosedConvexBody) {
    for (const bool rear : {false, true}) {
        BumperShape shape{.z = 0.5f, .centre = 0};
        shape.rear = rear;
        city::Mesh mesh;
        addBumper(mesh, halfCylinder(), shape);
        addMirrored(mesh);
        // Every edge has two triangles that face the same way.
        std::map<std::array<float, 6>, int> edges;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
            for (std::size_t c = 0; c < 3; ++c) {
                const glm::vec3& a = mesh.vertices[mesh.indices[i + c]].position;
                const glm::vec3& b = mesh.vertices[mesh.indices[i + (c + 1) % 3]].position;
                // 0 + x: minus zero is zero.
                ++edges[{0 + a.x, 0 + a.y, 0 + a.z, 0 + b.x, 0 + b.y, 0 + b.z}];
                --edges[{0 + b.x, 0 + b.y, 0 + b.z, 0 + a.x, 0 + a.y, 0 + a.z}];
            }
        for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
        // No corner lies before any face by more than the facets' own sag.
        float farthest = 0;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const glm::vec3 a = mesh.vertices[mesh.indices[i]].position,
                            b = mesh.vertices[mesh.indices[i + 1]].position,
                            c = mesh.vertices[mesh.indices[i + 2]].position;
            const glm::vec3 flat = glm::cross(b - a, c - a);
            if (glm::length(flat) < 1e-7f) continue;
            for (const city::Vertex& v : mesh.vertices)
                farthest = std::max(farthest, glm::dot(glm::normalize(flat), v.position - a));
        }
        EXPECT_LT(farthest, 5e-3f);
    }
}

TEST(Bumper, WhereTheShellIsMissedThereIsNone) {
    city::Mesh mesh;
    addBumper(mesh, halfCylinder(), {.z = 3, .centre = 0});
    addBumper(mesh, {}, {});
    EXPECT_TRUE(mesh.vertices.empty());
}

TEST(Cyclist, StandsOnTwoWheelsWithAllLevels) {
    const VehicleModel m = cyclist();
    ASSERT_EQ(m.wheels.size(), 2u);
    const city::Mesh whole = withWheels(m.levels[0].body, m, m.wheel);
    const city::Aabb box = whole.bounds();
    EXPECT_NEAR(box.min.z, 0, 2e-3f);
    EXPECT_NEAR(box.max.z, m.height, 0.05f);
    EXPECT_NEAR(box.size().x, m.length, 0.05f);
    EXPECT_NEAR(box.size().y, m.width, 0.05f);
    EXPECT_NEAR(m.wheels[0].centre.x + m.wheels[1].centre.x, 0, 1e-6f);
    for (const city::Vertex& v : whole.vertices) {
        ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
        ASSERT_NEAR(glm::length(v.normal), 1, 1e-3f);
    }
    ASSERT_GE(m.levels.size(), 3u);
    EXPECT_LE(m.levels[0].body.triangleCount(), 12000u);
    for (std::size_t k = 1; k < m.levels.size(); ++k)
        EXPECT_LT(m.levels[k].body.triangleCount(), m.levels[k - 1].body.triangleCount());
    // Somebody sits on it: at every height from the saddle to the head there is something.
    for (float z = 0.95f; z < 1.65f; z += 0.05f)
        EXPECT_TRUE(std::any_of(whole.vertices.begin(), whole.vertices.end(), [&](const city::Vertex& v) {
            return std::abs(v.position.z - z) < 0.04f && std::abs(v.position.y) < 0.3f;
        })) << z;
}

}  // namespace
}  // namespace vehicles
