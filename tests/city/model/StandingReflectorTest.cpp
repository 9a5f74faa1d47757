#include "city/model/StandingReflector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

namespace {

using city::Mesh;
using city::StandingReflector;

StandingReflector sphere(float radius) {
    return {
        "sphere",  StandingReflector::Shape::sphere, StandingReflector::Stuff::chrome, {3, -4, 0.5f}, radius,
        2 * radius};
}
StandingReflector pillar(float radius, float height) {
    return {
        "pillar", StandingReflector::Shape::pillar, StandingReflector::Stuff::granite, {3, -4, 0.5f}, radius,
        height};
}

struct Closer {
    bool operator()(const glm::vec3& a, const glm::vec3& b) const {
        for (int k = 0; k < 3; ++k)
            if (a[k] != b[k]) return a[k] < b[k];
        return false;
    }
};

/// Edges (by position) that do not have exactly one triangle on either side.
std::size_t openEdges(const Mesh& mesh) {
    std::map<glm::vec3, int, Closer> places;
    const auto place = [&](std::uint32_t i) {
        return places.try_emplace(mesh.vertices[i].position, static_cast<int>(places.size())).first->second;
    };
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
        for (std::size_t k = 0; k < 3; ++k)
            ++edges[{place(mesh.indices[t + k]), place(mesh.indices[t + (k + 1) % 3])}];
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        open += count != 1 || back == edges.end() || back->second != 1;
    }
    return open;
}

std::size_t insideOut(const Mesh& mesh) {
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const city::Vertex &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]],
                           &c = mesh.vertices[mesh.indices[t + 2]];
        wrong += glm::dot(glm::cross(b.position - a.position, c.position - a.position),
                          a.normal + b.normal + c.normal) <= 0;
    }
    return wrong;
}

}  // namespace

TEST(StandingReflector, aSphereIsClosedRoundAndOfTheSizeItSays) {
    for (int detail = 0; detail <= 5; ++detail) {
        const StandingReflector ball = sphere(1.1f);
        const Mesh mesh = city::reflectorMesh(ball, detail);
        EXPECT_EQ(mesh.triangleCount(), 20u << (2 * detail));
        EXPECT_EQ(openEdges(mesh), 0u) << detail;
        EXPECT_EQ(insideOut(mesh), 0u) << detail;
        for (const city::Vertex& v : mesh.vertices) {
            const glm::vec3 out = v.position - glm::vec3(0, 0, 1.1f);
            EXPECT_NEAR(glm::length(out), 1.1f, 1e-6);
            EXPECT_NEAR(glm::length(v.normal), 1, 1e-6);
            EXPECT_NEAR(glm::dot(glm::normalize(out), v.normal), 1, 1e-6);
        }
    }
}

TEST(StandingReflector, aPillarHasALidAndNoFloor) {
    for (int detail = 0; detail <= 5; ++detail) {
        const Mesh mesh = city::reflectorMesh(pillar(0.5f, 4), detail);
        const std::size_t sides = 6u << detail;
        EXPECT_EQ(mesh.triangleCount(), 3 * sides);
        EXPECT_EQ(openEdges(mesh), sides) << "its foot's";
        EXPECT_EQ(insideOut(mesh), 0u) << detail;
        EXPECT_EQ(mesh.bounds().min.z, 0);
        EXPECT_EQ(mesh.bounds().max.z, 4);
        for (const city::Vertex& v : mesh.vertices) {
            const float away = glm::length(glm::vec2(v.position));
            EXPECT_TRUE(std::abs(away - 0.5f) < 1e-6f || away == 0);
            if (v.normal.z == 0) {
                EXPECT_NEAR(glm::dot(glm::vec2(v.position), glm::vec2(v.normal)), 0.5f, 1e-6);
            }
        }
    }
}

TEST(StandingReflector, noPointOfAMeshLiesDeeperThanItsError) {
    for (const StandingReflector& body : {sphere(1.1f), pillar(0.5f, 4)}) {
        for (int detail = 0; detail <= 4; ++detail) {
            const Mesh mesh = city::reflectorMesh(body, detail);
            float deepest = 0;
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                const auto at = [&](std::size_t k) { return mesh.vertices[mesh.indices[t + k]].position; };
                // Of a sphere the middles of triangles lie deepest, of a pillar those of its edges.
                for (const glm::vec3& p : {(at(0) + at(1) + at(2)) / 3.0f, (at(0) + at(1)) / 2.0f,
                                           (at(1) + at(2)) / 2.0f, (at(2) + at(0)) / 2.0f}) {
                    const bool ball = body.shape == StandingReflector::Shape::sphere;
                    const float inside = ball ? body.radius - glm::length(p - glm::vec3(0, 0, body.radius))
                                              : body.radius - glm::length(glm::vec2(p));
                    if (ball || p.z < 0.99f * body.height) deepest = std::max(deepest, inside);
                }
            }
            EXPECT_NEAR(deepest, city::reflectorMeshError(body, detail), 1e-5) << detail;
        }
    }
}

TEST(StandingReflector, whatHasNoSizeHasNoMesh) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const float bad : {0.0f, -1.0f, nan, inf}) {
        EXPECT_TRUE(city::reflectorMesh(sphere(bad), 2).empty()) << bad;
        EXPECT_TRUE(city::reflectorMesh(pillar(0.5f, bad), 2).empty()) << bad;
        EXPECT_EQ(city::reflectorMeshError(sphere(bad), 2), 0) << bad;
    }
    EXPECT_EQ(city::reflectorMesh(sphere(1), -7).triangleCount(), 20u);
    EXPECT_EQ(city::reflectorMesh(sphere(1), 99).triangleCount(), 20u << 10);
}
