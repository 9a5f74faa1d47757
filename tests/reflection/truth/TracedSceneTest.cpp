// Rays against placed meshes: an oracle that tries every triangle, backs, holes, and what is in the way.
#include "reflection/truth/TracedScene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <random>

namespace reflection {
namespace {

using Backs = TracedScene::Backs;

/// Corners (0,0,0) (1,0,0) (1,1,0) (0,1,0), front towards +z.
city::Mesh square() {
    city::Mesh mesh;
    const auto at = [](float x, float y) { return city::Vertex{{x, y, 0}, {0, 0, 1}, {x, y}, 0}; };
    mesh.addQuad(at(0, 0), at(1, 0), at(1, 1), at(0, 1));
    return mesh;
}

TracedHit hitOf(const TracedScene& scene, const TracedRay& ray, Backs backs = Backs::pass) {
    TracedHit hit;
    scene.trace({&ray, 1}, {&hit, 1}, backs);
    return hit;
}

float uniform(std::mt19937_64& random) {
    return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53);
}
glm::vec3 inCube(std::mt19937_64& random, float half) {
    return half * (2.0f * glm::vec3(uniform(random), uniform(random), uniform(random)) - 1.0f);
}

/// Moeller and Trumbore in double; infinity for a miss.
double meet(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& a, const glm::dvec3& b,
            const glm::dvec3& c, double& margin) {
    const glm::dvec3 e1 = b - a, e2 = c - a, p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    const double u = glm::dot(o - a, p) / det, v = glm::dot(d, glm::cross(o - a, e1)) / det;
    const double t = glm::dot(e2, glm::cross(o - a, e1)) / det;
    margin = std::min({u, v, 1 - u - v});
    return margin >= 0 && t >= 0 ? t : INFINITY;
}

TEST(TracedSceneTest, hitsNameInstancePartTriangleAndPlace) {
    TracedMeshes meshes;
    const city::Mesh mesh = square(), nothing;
    const std::vector<TracedMeshes::Part> parts{{&nothing, false, nullptr}, {&mesh, false, nullptr}};
    const std::uint32_t id = meshes.add(parts);
    TracedScene scene(meshes);
    glm::mat4 far(1), near(1);
    far[3] = glm::vec4(0, 0, -5, 1);
    near[3] = glm::vec4(10, 0, -2, 1);
    EXPECT_EQ(scene.place(id, far), 0u);
    EXPECT_EQ(scene.place(id, near), 1u);
    scene.commit();

    const TracedHit hit = hitOf(scene, {{10.75f, 0.25f, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit.found());
    EXPECT_FLOAT_EQ(hit.t, 3);
    EXPECT_EQ(hit.instance, 1u);
    EXPECT_EQ(hit.part, 1u);
    EXPECT_EQ(hit.triangle, 0u);
    // (0.75, 0.25) = 0.5 (1, 0) + 0.25 (1, 1).
    EXPECT_NEAR(hit.u, 0.5f, 1e-5f);
    EXPECT_NEAR(hit.v, 0.25f, 1e-5f);
    EXPECT_EQ(hitOf(scene, {{0.5f, 0.25f, 1}, {0, 0, -1}}).instance, 0u);
    EXPECT_FALSE(hitOf(scene, {{5, 5, 1}, {0, 0, -1}}).found());
    EXPECT_EQ(hitOf(scene, {{5, 5, 1}, {0, 0, -1}}).t, INFINITY);
}

TEST(TracedSceneTest, backsArePassedOnlyWhereAskedAndOneSided) {
    TracedMeshes meshes;
    const city::Mesh mesh = square();
    const std::vector<TracedMeshes::Part> oneSided{{&mesh, false, nullptr}}, twoSided{{&mesh, true, nullptr}};
    const std::uint32_t one = meshes.add(oneSided), two = meshes.add(twoSided);
    TracedScene scene(meshes);
    scene.place(one, glm::mat4(1));
    glm::mat4 above(1);
    above[3] = glm::vec4(0, 0, 4, 1);
    scene.place(two, above);
    scene.commit();
    const TracedRay upwards{{0.5f, 0.25f, -1}, {0, 0, 1}}, downwards{{0.5f, 0.25f, 2}, {0, 0, -1}};
    EXPECT_FLOAT_EQ(hitOf(scene, upwards, Backs::pass).t, 5);
    EXPECT_FLOAT_EQ(hitOf(scene, upwards, Backs::stop).t, 1);
    EXPECT_FLOAT_EQ(hitOf(scene, downwards, Backs::pass).t, 2);
}

/// Open in the left half; remembers the widest footprint asked with.
class LeftHalf final : public Holes {
  public:
    bool openAt(std::uint32_t triangle, float u, float v, float footprint) const override {
        widest = std::max(widest, footprint);
        return (triangle == 0 ? u + v : u) < 0.5f;
    }
    mutable float widest = 0;
};

TEST(TracedSceneTest, raysGoThroughHolesAndTellTheirWidth) {
    TracedMeshes meshes;
    const city::Mesh mesh = square();
    const LeftHalf holes;
    const std::vector<TracedMeshes::Part> parts{{&mesh, true, &holes}};
    TracedScene scene(meshes);
    scene.place(meshes.add(parts), glm::mat4(1));
    scene.commit();
    const float infinity = std::numeric_limits<float>::infinity();
    const TracedRay left{{0.25f, 0.1f, 2}, {0, 0, -1}, 0, infinity, 0.5f, 0.25f};
    const TracedRay right{{0.75f, 0.1f, 2}, {0, 0, -1}};
    EXPECT_FALSE(hitOf(scene, left).found());
    EXPECT_FLOAT_EQ(holes.widest, 1);
    EXPECT_TRUE(hitOf(scene, right).found());
    const std::vector<TracedRay> both{left, right};
    std::vector<std::uint8_t> blocked(2);
    scene.blocked(both, blocked);
    EXPECT_EQ(blocked, (std::vector<std::uint8_t>{0, 1}));
}

TEST(TracedSceneTest, firstHitsAreThoseOfTryingEveryTriangle) {
    std::mt19937_64 random(7);
    city::Mesh mesh;
    for (int i = 0; i < 60; ++i) {
        const glm::vec3 at = inCube(random, 3);
        const auto corner = [&] { return city::Vertex{at + inCube(random, 1.5f), {0, 0, 1}, {0, 0}, 0}; };
        mesh.addTriangle(corner(), corner(), corner());
    }
    TracedMeshes meshes;
    const std::vector<TracedMeshes::Part> parts{{&mesh, true, nullptr}};
    const std::uint32_t id = meshes.add(parts);
    TracedScene scene(meshes);
    std::vector<glm::mat4> places;
    for (int k = 0; k < 5; ++k) {
        const glm::vec3 axis = glm::normalize(inCube(random, 1) + glm::vec3(0, 0, 2));
        const glm::vec3 u = glm::normalize(glm::cross(axis, glm::vec3(1, 0, 0)));
        const float scale = 0.5f + uniform(random);
        places.emplace_back(glm::vec4(scale * u, 0), glm::vec4(scale * glm::cross(axis, u), 0),
                            glm::vec4(scale * axis, 0), glm::vec4(inCube(random, 6), 1));
        scene.place(id, places.back());
    }
    scene.commit();
    std::vector<TracedRay> rays;
    for (int i = 0; i < 3000; ++i) rays.push_back({inCube(random, 12), glm::normalize(inCube(random, 1))});
    std::vector<TracedHit> hits(rays.size());
    scene.trace(rays, hits, Backs::pass);
    int found = 0;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        double nearest = INFINITY, closeCall = 1;
        std::uint32_t instance = TracedHit::none, triangle = 0;
        for (std::uint32_t k = 0; k < places.size(); ++k)
            for (std::uint32_t i = 0; i < mesh.triangleCount(); ++i) {
                const auto at = [&](std::size_t c) {
                    return glm::dvec3(glm::dmat4(places[k]) *
                                      glm::dvec4(mesh.vertices[mesh.indices[3 * i + c]].position, 1));
                };
                double margin = 0;
                const double t = meet(rays[r].origin, rays[r].direction, at(0), at(1), at(2), margin);
                closeCall = std::min(closeCall, std::abs(margin));
                if (t < nearest) {
                    nearest = t;
                    instance = k;
                    triangle = i;
                }
            }
        if (closeCall < 1e-5) continue;  // along an outline both answers are right
        EXPECT_EQ(hits[r].instance, instance) << r;
        if (instance == TracedHit::none) continue;
        ++found;
        EXPECT_EQ(hits[r].triangle, triangle) << r;
        EXPECT_NEAR(hits[r].t, nearest, 1e-4) << r;
    }
    EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace reflection
