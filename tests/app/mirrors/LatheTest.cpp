// Lathes: their meshes lie on them, their normals are the surface's, and what is none is refused.
#include "app/mirrors/Lathe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "app/mirrors/MirrorTruth.h"

namespace app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double pi = 3.141592653589793;

/// A half circle from the lower pole to the upper one: a ball of radius 1 about (0, 0, 1).
Lathe ball(int points) {
    Lathe lathe;
    for (int i = 0; i <= points; ++i)
        lathe.profile.emplace_back(i == 0 || i == points ? 0 : std::sin(pi * i / points),
                                   1 - std::cos(pi * i / points));
    lathe.steps = 3;
    lathe.slices = 24;
    return lathe;
}

Lathe ring() {
    Lathe lathe;
    for (int i = 0; i < 16; ++i)
        lathe.profile.emplace_back(2 + 0.5 * std::cos(pi * i / 8), 0.5 * std::sin(pi * i / 8));
    lathe.profile.push_back(lathe.profile.front());
    lathe.steps = 2;
    return lathe;
}

/// A cup with creases at its foot, standing askew.
Lathe cup() {
    Lathe lathe;
    lathe.foot = {1, 2, 3};
    lathe.axis = {0.3, -0.5, 2};
    lathe.profile = {{0, 0}, {1, 0}, {1, 0}, {1.3, 1}, {1.2, 2}, {1.1, 2}, {1.1, 2}, {1, 1}, {0, 0.2}};
    lathe.steps = 4;
    return lathe;
}

double volumeOf(const LitMesh& m) {
    double volume = 0;
    for (std::size_t i = 0; i < m.indices.size(); i += 3) {
        const glm::dvec3 a(m.corners[m.indices[i]].position), b(m.corners[m.indices[i + 1]].position),
            c(m.corners[m.indices[i + 2]].position);
        volume += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return volume;
}

// The spline through points of a circle is off it by the fourth power of their distance: (pi/16)^4 / 384.
TEST(Lathe, OfAHalfCircleIsABallWithTheNormalsOfABall) {
    for (const LitMesh::Corner& c : LatheSurface(ball(16)).mesh(glm::vec3(1), glm::vec3(1)).corners) {
        const glm::vec3 fromCentre = c.position - glm::vec3(0, 0, 1);
        EXPECT_NEAR(glm::length(fromCentre), 1, 1e-4);
        EXPECT_NEAR(glm::length(c.normal), 1, 1e-6);
        EXPECT_LT(glm::distance(c.normal, glm::normalize(fromCentre)), 2e-3);
    }
}

TEST(Lathe, HasAsManyTrianglesAsItSaysAllWithAreasTowardsTheFront) {
    Lathe part = ring();
    part.from = -0.5;
    part.to = 1.5;
    for (const Lathe& lathe : {ball(8), ring(), cup(), part, ball(8).finer(2)}) {
        ASSERT_FALSE(latheProblem(lathe));
        const LitMesh mesh = LatheSurface(lathe).mesh(glm::vec3(1), glm::vec3(1));
        EXPECT_EQ(mesh.triangles(), static_cast<std::size_t>(lathe.triangles()));
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const LitMesh::Corner &a = mesh.corners[mesh.indices[i]], &b = mesh.corners[mesh.indices[i + 1]],
                                  &c = mesh.corners[mesh.indices[i + 2]];
            const glm::vec3 face = glm::cross(b.position - a.position, c.position - a.position);
            EXPECT_GT(glm::length(face), 1e-7f);
            EXPECT_GT(glm::dot(glm::normalize(face), glm::normalize(a.normal + b.normal + c.normal)), 0.9f);
        }
    }
    EXPECT_NEAR(volumeOf(LatheSurface(ball(16).finer(4)).mesh(glm::vec3(1), glm::vec3(1))), 4 * pi / 3, 0.02);
    EXPECT_NEAR(volumeOf(LatheSurface(ring().finer(4)).mesh(glm::vec3(1), glm::vec3(1))), pi * pi, 0.05);
}

TEST(Lathe, SecondColoursEveryOtherPartBetweenCreases) {
    const LitMesh mesh = LatheSurface(cup()).mesh(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0));
    // Foot, outside with rim, inside.
    EXPECT_EQ(mesh.corners.front().colour, glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.corners.back().colour, glm::vec3(1, 0, 0));
    std::size_t second = 0;
    for (const LitMesh::Corner& c : mesh.corners) second += c.colour.g > 0;
    EXPECT_EQ(second, 32u * (3 * 4 + 1));
}

// Against every corner of a mesh sixteen times as fine.
TEST(Lathe, TheNearestPointIsNearerThanAnyOfAFineMesh) {
    std::mt19937_64 random(4);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (const Lathe& lathe : {ball(8), ring(), cup()}) {
        const LatheSurface surface(lathe);
        const LitMesh fine = LatheSurface(lathe.finer(8)).mesh(glm::vec3(1), glm::vec3(1));
        for (int k = 0; k < 60; ++k) {
            const glm::dvec3 p = lathe.foot + glm::dvec3(6 * unit() - 3, 6 * unit() - 3, 6 * unit() - 2);
            const LatheSurface::Point near = surface.nearest(p);
            double least = 1e9;
            for (const LitMesh::Corner& c : fine.corners)
                least = std::min(least, glm::distance(p, glm::dvec3(c.position)));
            const double here = glm::distance(p, near.position);
            EXPECT_LE(here, least + 1e-6);
            EXPECT_GE(here, least - 0.05);
            EXPECT_NEAR(glm::length(near.normal), 1, 1e-12);
            // The way there is along the normal, but at creases.
            if (near.within && here > 0.05 && lathe.profile.size() != 9) {
                EXPECT_GT(std::abs(glm::dot(near.normal, p - near.position)) / here, 1 - 1e-9);
            }
        }
        // Corners of its own mesh are their own nearest points, normals agree.
        const LitMesh mesh = surface.mesh(glm::vec3(1), glm::vec3(1));
        for (std::size_t i = 0; i < mesh.corners.size(); i += 17) {
            const LatheSurface::Point near = surface.nearest(glm::dvec3(mesh.corners[i].position));
            EXPECT_LT(glm::distance(near.position, glm::dvec3(mesh.corners[i].position)), 1e-6);
        }
    }
}

TEST(Lathe, TellsWhatLiesWithinItsArcAndItsEnds) {
    Lathe lathe;
    lathe.profile = {{1, 0}, {1, 2}};
    lathe.from = 0;
    lathe.to = pi / 2;
    const LatheSurface surface(lathe);
    EXPECT_TRUE(surface.nearest({2, 2, 1}).within);
    EXPECT_FALSE(surface.nearest({-2, 2, 1}).within);
    EXPECT_FALSE(surface.nearest({2, 2, 3}).within);
    EXPECT_FALSE(surface.nearest({2, 2, -1}).within);
    EXPECT_TRUE(LatheSurface(ball(8)).nearest({0, 0, 5}).within);  // a pole is no end
    EXPECT_TRUE(LatheSurface(ring()).nearest({3, 0, 0}).within);   // nor is a ring's seam
}

std::string complaintOf(const std::string& object, int triangles) {
    try {
        parseMirrorWorld(R"({"name":"n","source":"s","licence":"l","depth":1,)"
                         R"("camera":{"eye":[0,0,1],"target":[1,0,1],"fov_y_deg":60},"triangles":)" +
                             std::to_string(triangles) + R"(,"objects":[)" + object + "]}",
                         "scene.json");
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "";
}

TEST(Lathe, FilesAreRefusedWithThePlaceAndTheRemedy) {
    const auto lathe = [](const std::string& profile, const std::string& more = "") {
        return R"({"kind":"lathe","foot":[0,0,0],"profile":)" + profile +
               R"(,"steps":1,"slices":8,"colour":[1,1,1])" + more + "}";
    };
    ASSERT_EQ(complaintOf(lathe("[[1,0],[1,2]]"), 16), "");
    ASSERT_EQ(complaintOf(lathe("[[0,0],[1,1],[1,1],[0,2]]"), 16), "");
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]"), 17), HasSubstr("have 16 triangles"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]"), 15), HasSubstr("more than 'triangles' says"));
    EXPECT_THAT(complaintOf(lathe("[[1,0]]"), 16),
                AllOf(HasSubstr("scene.json, objects[0]"), HasSubstr("fewer than two"), HasSubstr("add")));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1]]"), 16), HasSubstr("profile[1]: has 1 numbers"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[-1,1]]"), 16), HasSubstr("profile[1][0]: -1 lies outside"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[0,1],[1,2]]"), 16),
                AllOf(HasSubstr("point 1 of the profile, [0, 1], lies on the axis"), HasSubstr("first")));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,0],[1,1]]"), 16), HasSubstr("twice at an end"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[2,0],[2,0],[2,0],[1,1]]"), 16), HasSubstr("three times"));
    EXPECT_THAT(complaintOf(lathe("[[0,0],[0,1]]"), 16), HasSubstr("lies on the axis"));
    // A steep bend beside the axis throws the curve across it.
    EXPECT_THAT(complaintOf(R"({"kind":"lathe","foot":[0,0,0],"profile":[[4,0],[0.05,0.1],[0.05,2]],)"
                            R"("steps":16,"slices":8,"colour":[1,1,1]})",
                            16),
                HasSubstr("crosses the axis"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]", R"(,"axis":[0,0,0])"), 16), HasSubstr("no direction"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]", R"(,"arc":[20,20])"), 16), HasSubstr("arc is empty"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]", R"(,"arc":[0,361])"), 16), HasSubstr("whole turn"));
    EXPECT_THAT(complaintOf(lathe("[[1,0],[1,2]]", R"(,"reflectance":[1,1,1])"), 16),
                HasSubstr("there is no 'reflectance' here"));
    EXPECT_THAT(
        complaintOf(R"({"kind":"chrome lathe","foot":[0,0,0],"profile":[[1,0],[1,2]],"steps":1,"slices":8})",
                    16),
        HasSubstr("'reflectance' is missing"));
    EXPECT_THAT(complaintOf(R"({"kind":"chrome lathe","foot":[0,0,0],"profile":[[1,0],[1,2]],)"
                            R"("steps":64,"slices":512,"fine":16,"reflectance":[1,1,1]})",
                            65536),
                AllOf(HasSubstr("more than 4000000"), HasSubstr("smaller")));
}

TEST(ChromeLathe, IsKeptAsDrawnAndAsFineAsItIs) {
    const MirrorWorld world =
        parseMirrorWorld(R"({"name":"n","source":"s","licence":"l","depth":1,)"
                         R"("camera":{"eye":[0,0,1],"target":[1,0,1],"fov_y_deg":60},"triangles":112,)"
                         R"("objects":[{"kind":"chrome lathe","foot":[5,0,0],"steps":2,"slices":8,"fine":4,)"
                         R"("profile":[[0,0],[1,0.3],[1.2,1],[0.6,1.8],[0,2]],"reflectance":[1,1,1]}]})",
                         "scene.json");
    ASSERT_EQ(world.curved.size(), 1u);
    const MirrorWorld::Curved& c = world.curved.front();
    EXPECT_EQ(c.mesh.triangles(), 112u);
    EXPECT_EQ(c.fine.triangles(), 32u * (2 * 8 * 4 - 2));
    EXPECT_EQ(&c.finest(), &c.fine);
    for (const LitMesh::Corner& corner : c.fine.corners) {
        EXPECT_LE(glm::distance(glm::dvec3(corner.position), c.reflector.centre), c.reflector.radius);
        EXPECT_LT(glm::distance(c.surface->nearest(glm::dvec3(corner.position)).position,
                                glm::dvec3(corner.position)),
                  1e-6);
    }
}

// The picture's reflectors are those that the description promises, and each fills a part of it.
TEST(Kitchen, HasThreeReflectorsThatAreSeenAndTensOfThousandsOfVertices) {
    const MirrorWorld world =
        loadMirrorWorld(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/scenes/kitchen.json");
    EXPECT_EQ(world.curved.size(), 3u);
    EXPECT_EQ(world.mirrors.size(), 0u);
    EXPECT_EQ(world.objects.size(), 102u);
    EXPECT_EQ(world.triangles(), 115220u);
    std::size_t corners = 0;
    for (const LitMesh& m : world.objects) corners += m.corners.size();
    EXPECT_GT(corners, 50000u);
    for (const MirrorWorld::Curved& c : world.curved) EXPECT_GT(c.fine.triangles(), 8 * c.mesh.triangles());
    const TracedPicture picture = MirrorTruth(world).picture(world.view({160, 120}), {.depth = 2});
    std::size_t curved = 0;
    for (const std::uint8_t c : picture.curved) curved += c;
    EXPECT_GT(curved, picture.curved.size() / 8);
}

}  // namespace
}  // namespace app
