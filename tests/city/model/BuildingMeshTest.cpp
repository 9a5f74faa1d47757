#include "city/model/BuildingMesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "city/model/PolygonAlgebra.h"

namespace city {
namespace {

using Ring = std::vector<glm::vec2>;

double uniform(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * (double(random() >> 11) / 9007199254740992.0);
}

Ring rectangle(glm::vec2 centre, double width, double depth, double turn) {
    const glm::dvec2 u(std::cos(turn), std::sin(turn));
    const glm::dvec2 v(-u.y, u.x);
    Ring ring;
    for (const glm::dvec2 s : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        ring.emplace_back(glm::dvec2(centre) + 0.5 * s.x * width * u + 0.5 * s.y * depth * v);
    return ring;
}

/// Star-shaped about the centre: simple by construction.
Ring star(std::mt19937_64& random, glm::vec2 centre, int corners, double least, double most) {
    Ring ring;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + uniform(random, 0.1, 0.9)) / corners;
        const double radius = uniform(random, least, most);
        ring.emplace_back(centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle));
    }
    return ring;
}

/// Volume below the mesh and above z = base, by the divergence theorem: the missing floor lies in z = base
/// and contributes nothing when heights are counted from there.
double volumeAbove(const Mesh& mesh, double base) {
    double sum = 0;
    const glm::dvec3 origin(glm::dvec2(mesh.vertices.front().position), base);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = glm::dvec3(mesh.vertices[mesh.indices[i]].position) - origin;
        const glm::dvec3 b = glm::dvec3(mesh.vertices[mesh.indices[i + 1]].position) - origin;
        const glm::dvec3 c = glm::dvec3(mesh.vertices[mesh.indices[i + 2]].position) - origin;
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

/// The vector area of walls and roof equals that of the missing floor, turned: (0, 0, area). Holes in the
/// surface show.
glm::dvec3 vectorArea(const Mesh& mesh) {
    glm::dvec3 sum(0);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = mesh.vertices[mesh.indices[i]].position;
        const glm::dvec3 b = mesh.vertices[mesh.indices[i + 1]].position;
        const glm::dvec3 c = mesh.vertices[mesh.indices[i + 2]].position;
        sum += 0.5 * glm::cross(b - a, c - a);
    }
    return sum;
}

void expectNormalsAgreeWithWinding(const Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = mesh.vertices[mesh.indices[i]].position;
        const glm::dvec3 b = mesh.vertices[mesh.indices[i + 1]].position;
        const glm::dvec3 c = mesh.vertices[mesh.indices[i + 2]].position;
        const glm::dvec3 n = glm::cross(b - a, c - a);
        const double area2 = glm::length(n);
        if (area2 < 1e-2) continue;  // slivers: rounding to float turns their plane
        for (int k = 0; k < 3; ++k) {
            const Vertex& v = mesh.vertices[mesh.indices[i + std::size_t(k)]];
            ASSERT_NEAR(glm::length(v.normal), 1.0f, 1e-5f);
            ASSERT_GT(glm::dot(glm::dvec3(v.normal), n / area2), 0.99);
        }
    }
}

void expectFinite(const Mesh& mesh) {
    for (const Vertex& v : mesh.vertices) {
        for (int k = 0; k < 3; ++k) {
            ASSERT_TRUE(std::isfinite(v.position[k]));
            ASSERT_TRUE(std::isfinite(v.normal[k]));
        }
        ASSERT_TRUE(std::isfinite(v.texcoord.x) && std::isfinite(v.texcoord.y));
    }
}

BuildingShape flatBuilding(Footprint footprint) {
    BuildingShape shape;
    shape.footprint = std::move(footprint);
    shape.base = 1.5f;
    shape.eaves = 19.25f;
    shape.ridge = shape.eaves;
    shape.groundFloorHeight = 4;
    shape.wallMaterial = 1;
    shape.groundFloorMaterial = 2;
    shape.roofMaterial = 3;
    return shape;
}

double triangleArea(const std::vector<glm::vec2>& corners) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        sum += signedArea(std::span(corners).subspan(i, 3));
    return sum;
}

TEST(BuildingMesh, VolumeIsAreaTimesHeightForRandomFootprintsWithCourtyards) {
    std::mt19937_64 random(7);
    for (int trial = 0; trial < 300; ++trial) {
        const glm::vec2 centre(float(uniform(random, -3000, 3000)), float(uniform(random, -3000, 3000)));
        Footprint footprint{star(random, centre, 3 + trial % 17, 12, 40), {}};
        // Inside the least radius at every angle: a triangle of radius 12 may come within 12 cos(60 deg) and
        // less.
        if (trial % 2 && footprint.outer.size() > 9) footprint.holes.push_back(star(random, centre, 5, 2, 6));
        if (trial % 3 == 0) std::reverse(footprint.outer.begin(), footprint.outer.end());
        const BuildingShape shape = flatBuilding(footprint);
        Mesh mesh;
        ASSERT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
        expectFinite(mesh);
        expectNormalsAgreeWithWinding(mesh);
        const double expected = area(footprint) * (double(shape.eaves) - shape.base);
        EXPECT_NEAR(volumeAbove(mesh, shape.base), expected, 1e-3 * expected) << trial;
        const glm::dvec3 flux = vectorArea(mesh);
        EXPECT_NEAR(flux.z, area(footprint), 1e-3 * area(footprint));
        EXPECT_LT(std::hypot(flux.x, flux.y), 0.05) << trial;
    }
}

TEST(BuildingMesh, CourtyardWallsFaceTheCourt) {
    Footprint footprint{rectangle({0, 0}, 40, 30, 0), {rectangle({0, 0}, 20, 10, 0)}};
    Mesh mesh;
    ASSERT_EQ(appendBuilding(flatBuilding(footprint), mesh), BuildStatus::built);
    int court = 0;
    for (const Vertex& v : mesh.vertices) {
        if (v.normal.z > 0.5f) continue;
        const bool onCourt = std::abs(v.position.x) < 11 && std::abs(v.position.y) < 6;
        const float away = glm::dot(v.normal, v.position);
        if (onCourt) {
            EXPECT_LT(away, 0);
            ++court;
        } else {
            EXPECT_GT(away, 0);
        }
    }
    EXPECT_EQ(court, 4 * 2 * 4);  // four walls, two bands, four corners
}

TEST(BuildingMesh, WallsHoldWholeBaysAndStoreys) {
    BuildingShape shape = flatBuilding({rectangle({5, 5}, 20, 10.4, 0.3), {}});
    shape.base = 0;
    shape.eaves = 17.1f;  // 13.1 m above the ground floor: four storeys of 3.2 m, stretched
    Mesh mesh;
    appendBuilding(shape, mesh);
    float mostBays = 0;
    for (const Vertex& v : mesh.vertices) {
        if (v.material == 3) continue;
        EXPECT_FLOAT_EQ(v.texcoord.x, std::round(v.texcoord.x));
        EXPECT_FLOAT_EQ(v.texcoord.y, std::round(v.texcoord.y));
        EXPECT_FLOAT_EQ(v.texcoord.y, v.position.z < 0.1f ? 0
                                      : v.position.z > 17 ? 4
                                      : v.material == 2   ? 1
                                                          : 0);
        mostBays = std::max(mostBays, v.texcoord.x);
    }
    EXPECT_FLOAT_EQ(mostBays, 7);  // 20 m in bays of 3 m
}

TEST(BuildingMesh, CurvedWallCountsBaysOverTheWholeCurve) {
    Ring circle;
    for (int i = 0; i < 64; ++i) {
        const double a = 2 * std::numbers::pi * i / 64;
        circle.emplace_back(10 * std::cos(a), 10 * std::sin(a));
    }
    Mesh mesh;
    appendBuilding(flatBuilding({circle, {}}), mesh);
    float most = 0;
    for (const Vertex& v : mesh.vertices)
        if (v.material == 1) most = std::max(most, v.texcoord.x);
    EXPECT_NEAR(most, 21, 1e-3);  // 62.8 m in bays of 3 m
}

TEST(BuildingMesh, ShortWallsShowBlankPier) {
    // A 0.5 m step in the facade.
    Mesh mesh;
    appendBuilding(flatBuilding({{{0, 0}, {10, 0}, {10, 0.5f}, {20, 0.5f}, {20, 10}, {0, 10}}, {}}), mesh);
    int seen = 0;
    for (const Vertex& v : mesh.vertices) {
        if (v.material == 3 || v.normal.x < 0.9f || v.position.x > 11) continue;
        EXPECT_LT(std::abs(v.texcoord.x), 0.1f);
        ++seen;
    }
    EXPECT_EQ(seen, 8);  // two bands of four corners
}

TEST(BuildingMesh, PitchedRoofsHoldTheirAnalyticVolume) {
    std::mt19937_64 random(11);
    for (int trial = 0; trial < 100; ++trial) {
        const double depth = uniform(random, 6, 15);
        const double width = depth + uniform(random, 0.5, 30);
        const double rise = uniform(random, 0.5, 8);
        const glm::vec2 centre(float(uniform(random, -1000, 1000)), float(uniform(random, -1000, 1000)));
        BuildingShape shape = flatBuilding({rectangle(centre, width, depth, uniform(random, 0, 3)), {}});
        shape.ridge = shape.eaves + float(rise);
        const double walls = width * depth * (double(shape.eaves) - shape.base);
        struct Case {
            RoofShape roof;
            double attic;
        };
        const double ridgeLength = width - depth;
        for (const Case& c : {Case{RoofShape::gabled, width * depth * rise / 2},
                              Case{RoofShape::pyramidal, width * depth * rise / 3},
                              Case{RoofShape::hipped, depth * rise * (ridgeLength / 2 + depth / 3)}}) {
            shape.roof = c.roof;
            Mesh mesh;
            ASSERT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
            expectNormalsAgreeWithWinding(mesh);
            EXPECT_NEAR(volumeAbove(mesh, shape.base), walls + c.attic, 2e-3 * (walls + c.attic));
            EXPECT_NEAR(mesh.bounds().max.z, shape.ridge, 2e-3);
            const glm::dvec3 flux = vectorArea(mesh);
            EXPECT_LT(std::hypot(flux.x, flux.y), 0.2);
        }
    }
}

TEST(BuildingMesh, PitchedRoofMeetsWallsOfACrookedHouse) {
    // Not a rectangle: a bay on one side and slanted ends. Walls must end in the roof all the same.
    const Ring crooked{{0, 0},      {9, -0.6f}, {9, -1.4f}, {12, -1.4f},
                       {12, -0.5f}, {20, 0.4f}, {19, 9},    {1, 9.5f}};
    for (const RoofShape roof : {RoofShape::gabled, RoofShape::hipped, RoofShape::pyramidal}) {
        BuildingShape shape = flatBuilding({crooked, {}});
        shape.roof = roof;
        shape.ridge = shape.eaves + 4;
        Mesh mesh;
        ASSERT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
        const glm::dvec3 flux = vectorArea(mesh);
        EXPECT_LT(std::hypot(flux.x, flux.y), 0.05);
        EXPECT_NEAR(flux.z, area(shape.footprint), 0.05);
        EXPECT_GT(mesh.bounds().max.z, shape.eaves + 3.5f);
    }
}

TEST(BuildingMesh, PitchedRoofFallsBackToFlatOnAnglesAndCourtyards) {
    BuildingShape shape = flatBuilding({{{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 30}, {0, 30}}, {}});
    shape.roof = RoofShape::hipped;
    shape.ridge = shape.eaves + 4;
    Mesh mesh;
    ASSERT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
    EXPECT_FLOAT_EQ(mesh.bounds().max.z, shape.eaves);
    shape.footprint = {rectangle({0, 0}, 40, 30, 0), {rectangle({0, 0}, 20, 10, 0)}};
    Mesh court;
    ASSERT_EQ(appendBuilding(shape, court), BuildStatus::built);
    EXPECT_FLOAT_EQ(court.bounds().max.z, shape.eaves);
}

TEST(BuildingMesh, BowTieIsRepairedIntoTwoTriangles) {
    const Footprint bowTie{{{0, 0}, {10, 10}, {10, 0}, {0, 10}}, {}};
    const BuildingShape shape = flatBuilding(bowTie);
    Mesh mesh;
    EXPECT_EQ(appendBuilding(shape, mesh), BuildStatus::repaired);
    expectNormalsAgreeWithWinding(mesh);
    EXPECT_NEAR(volumeAbove(mesh, shape.base), 50 * (double(shape.eaves) - shape.base), 0.1);
    EXPECT_NEAR(triangleArea(triangulate(bowTie)), 50, 1e-3);
}

TEST(BuildingMesh, HoleReachingOutOfItsRingIsRepaired) {
    const Footprint footprint{rectangle({0, 0}, 20, 20, 0), {rectangle({10, 0}, 10, 10, 0)}};
    Mesh mesh;
    EXPECT_EQ(appendBuilding(flatBuilding(footprint), mesh), BuildStatus::repaired);
    EXPECT_NEAR(triangleArea(triangulate(footprint)), 400 - 50, 1e-3);
}

TEST(BuildingMesh, RepeatedAndCollinearCornersLeaveFourWalls) {
    Ring ring{{0, 0}, {0, 0}, {3, 0}, {6, 0}, {10, 0}, {10, 0}, {10, 5}, {10, 8}, {0, 8}, {0, 0}};
    BuildingShape shape = flatBuilding({ring, {}});
    shape.groundFloorHeight = 0;
    Mesh mesh;
    EXPECT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
    std::size_t wallVertices = 0;
    for (const Vertex& v : mesh.vertices) wallVertices += v.normal.z < 0.5f;
    EXPECT_EQ(wallVertices, 16u);
    EXPECT_NEAR(volumeAbove(mesh, shape.base), 80 * (double(shape.eaves) - shape.base), 0.01);
}

TEST(BuildingMesh, DegenerateInputAddsNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const Ring good = rectangle({0, 0}, 10, 10, 0);
    const std::vector<Footprint> bad{{},
                                     {{{0, 0}}, {}},
                                     {{{0, 0}, {1, 1}}, {}},
                                     {{{0, 0}, {5, 5}, {10, 10}}, {}},
                                     {{{3, 3}, {3, 3}, {3, 3}, {3, 3}}, {}},
                                     {{{0, 0}, {nan, 0}, {10, 10}}, {}},
                                     {{{0, 0}, {inf, 0}, {10, 10}}, {}},
                                     {{{0, 0}, {1e30f, 0}, {1e30f, 1e30f}}, {}},
                                     {{{0, 0}, {0.01f, 0}, {0, 0.01f}}, {}},
                                     {good, {{{1, 1}, {nan, 2}, {2, 3}}}}};
    for (const Footprint& footprint : bad) {
        Mesh mesh;
        EXPECT_EQ(appendBuilding(flatBuilding(footprint), mesh), BuildStatus::degenerate);
        EXPECT_TRUE(mesh.vertices.empty() && mesh.indices.empty());
        EXPECT_TRUE(triangulate(footprint).empty());
    }
    const auto expectDegenerate = [&](auto change) {
        BuildingShape shape = flatBuilding({good, {}});
        change(shape);
        Mesh mesh;
        EXPECT_EQ(appendBuilding(shape, mesh), BuildStatus::degenerate);
        EXPECT_TRUE(mesh.vertices.empty());
    };
    expectDegenerate([&](BuildingShape& s) { s.eaves = s.base; });
    expectDegenerate([&](BuildingShape& s) { s.eaves = nan; });
    expectDegenerate([&](BuildingShape& s) { s.base = -inf; });
    expectDegenerate([&](BuildingShape& s) { s.bayWidth = 0; });
    expectDegenerate([&](BuildingShape& s) { s.storeyHeight = -1; });
}

TEST(BuildingMesh, TinyFootprintIsBuilt) {
    BuildingShape shape = flatBuilding({rectangle({2000, -2000}, 0.4, 0.4, 0.2), {}});
    Mesh mesh;
    EXPECT_EQ(appendBuilding(shape, mesh), BuildStatus::built);
    expectFinite(mesh);
    EXPECT_NEAR(volumeAbove(mesh, shape.base), 0.16 * (double(shape.eaves) - shape.base), 0.02);
}

TEST(BuildingMesh, TriangulationCoversTheFootprintAndNothingElse) {
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 50; ++trial) {
        Footprint footprint{star(random, {0, 0}, 20, 15, 40), {star(random, {0, 0}, 7, 3, 9)}};
        const std::vector<glm::vec2> triangles = triangulate(footprint);
        EXPECT_NEAR(triangleArea(triangles), area(footprint), 1e-4 * area(footprint));
        // Oracle: a point is in some triangle exactly when the even-odd rule says it is inside.
        for (int k = 0; k < 200; ++k) {
            const glm::vec2 p(float(uniform(random, -40, 40)), float(uniform(random, -40, 40)));
            int covered = 0;
            double margin = 1;
            for (std::size_t i = 0; i < triangles.size(); i += 3) {
                double least = 1e9;
                for (std::size_t e = 0; e < 3; ++e) {
                    const glm::dvec2 a = triangles[i + e];
                    const glm::dvec2 b = triangles[i + (e + 1) % 3];
                    const glm::dvec2 d = b - a;
                    least = std::min(least, (d.x * (p.y - a.y) - d.y * (p.x - a.x)) / std::hypot(d.x, d.y));
                }
                margin = std::min(margin, std::abs(least));
                covered += least >= 0;
            }
            if (margin < 1e-3) continue;  // on an edge
            EXPECT_EQ(covered, contains(footprint, p) ? 1 : 0);
        }
    }
}

TEST(PolygonAlgebra, AreasOfSetOperationsAddUp) {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<Footprint> a{{star(random, {0, 0}, 12, 10, 30), {}}};
        const std::vector<Footprint> b{{star(random, {15, 5}, 9, 10, 30), {}}};
        const auto sum = [](const std::vector<Footprint>& all) {
            double total = 0;
            for (const Footprint& f : all) total += area(f);
            return total;
        };
        const double both = sum(intersection(a, b));
        EXPECT_NEAR(sum(difference(a, b)) + both, sum(a), 0.2);
        EXPECT_NEAR(sum(unite({a[0], b[0]})), sum(a) + sum(b) - both, 0.2);
    }
}

TEST(PolygonAlgebra, OffsetOfARectangleIsAnalytic) {
    const Footprint room{rectangle({100, 50}, 20, 10, 0.4), {}};
    const auto grown = offset(room, 2);
    const auto shrunk = offset(room, -2);
    ASSERT_EQ(grown.size(), 1u);
    ASSERT_EQ(shrunk.size(), 1u);
    EXPECT_NEAR(area(grown[0]), 24 * 14, 0.01);
    EXPECT_NEAR(area(shrunk[0]), 16 * 6, 0.01);
    EXPECT_TRUE(offset(room, -6).empty());
}

TEST(PolygonAlgebra, OrientedRectangleOfATurnedRectangleIsItself) {
    std::mt19937_64 random(9);
    for (int trial = 0; trial < 50; ++trial) {
        const double depth = uniform(random, 3, 20);
        const double width = depth + uniform(random, 0.1, 30);
        const double turn = uniform(random, 0, 3.1);
        const auto found = orientedRectangle({rectangle({300, -200}, width, depth, turn), {}});
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->half.x, width / 2, 1e-3);
        EXPECT_NEAR(found->half.y, depth / 2, 1e-3);
        EXPECT_NEAR(std::abs(found->axis.x * std::sin(turn) - found->axis.y * std::cos(turn)), 0, 1e-3);
    }
    EXPECT_FALSE(orientedRectangle({{{0, 0}, {5, 5}, {9, 9}}, {}}));
}

}  // namespace
}  // namespace city
