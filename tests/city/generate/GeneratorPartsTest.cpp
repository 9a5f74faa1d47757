#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <tuple>

#include "city/generate/BroadleafTree.h"
#include "city/generate/PerimeterBlock.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"
#include "tests/city/generate/CityChecks.h"

namespace {

double area(const std::vector<glm::vec2>& ring) {
    double sum = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::vec2 a = ring[i], b = ring[(i + 1) % ring.size()];
        sum += 0.5 * (static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x);
    }
    return sum;
}

}  // namespace

TEST(Random, drawsThePublishedSequence) {
    // SplitMix64 from seed 1234567: the reference values of its publication.
    city::Random random(1234567);
    EXPECT_EQ(random.next(), 6457827717110365317ull);
    EXPECT_EQ(random.next(), 3203168211198807973ull);
    EXPECT_EQ(random.next(), 9817491932198370423ull);
}

TEST(Random, staysInItsRanges) {
    city::Random random(5);
    for (int k = 0; k < 10000; ++k) {
        const float r = random.range(-2, 3);
        EXPECT_GE(r, -2);
        EXPECT_LE(r, 3);
        const int i = random.integer(4, 6);
        EXPECT_GE(i, 4);
        EXPECT_LE(i, 6);
    }
    EXPECT_EQ(random.integer(7, 3), 7);
}

TEST(Turn, agreesWithTheMathLibrary) {
    for (int k = -5000; k <= 5000; ++k) {
        const double turns = k * 0.00137;
        const city::Turn turn(turns);
        EXPECT_NEAR(turn.sin, std::sin(2 * std::numbers::pi * turns), 2e-7) << turns;
        EXPECT_NEAR(turn.cos, std::cos(2 * std::numbers::pi * turns), 2e-7) << turns;
    }
}

TEST(Shapes, boxesAndLathesAreClosedAndFaceOutwards) {
    city::Mesh box;
    city::addBox(box, {3, -2}, glm::normalize(glm::vec2(1, 2)), {-1, 2, -0.5f, 0.5f, 0, 4}, 0, city::boxAll);
    city::Mesh ball;
    const std::array<glm::vec2, 4> profile{{{0, 0}, {1, 0.5f}, {1, 1.5f}, {0, 2}}};
    city::addLathe(ball, {1, 1, 1}, profile, 12, 0);
    for (const city::Mesh* mesh : {&box, &ball}) {
        EXPECT_EQ(contradictions(*mesh), 0u);
        // Divergence theorem: the signed volume of a closed mesh that faces outwards is positive.
        double volume = 0;
        glm::dvec3 flux(0);
        for (std::size_t t = 0; t + 2 < mesh->indices.size(); t += 3) {
            const glm::dvec3 a(mesh->vertices[mesh->indices[t]].position),
                b(mesh->vertices[mesh->indices[t + 1]].position),
                c(mesh->vertices[mesh->indices[t + 2]].position);
            volume += glm::dot(a, glm::cross(b, c)) / 6;
            flux += glm::cross(b - a, c - a);
        }
        EXPECT_GT(volume, 1);
        EXPECT_NEAR(glm::length(flux), 0, 1e-4);  // closed
    }
}

TEST(BroadleafTree, hasExactlyTheTrianglesAskedFor) {
    city::TreeShape shape;
    for (const std::size_t count : {60u, 61u, 500u, 4401u, 59100u}) {
        const std::array<std::size_t, 2> levels{count, 50};
        const city::Prototype tree = city::makeBroadleafTree("tree", shape, levels, 3);
        ASSERT_EQ(tree.levels.size(), 2u);
        EXPECT_EQ(tree.levels[0].mesh.triangleCount(), count);
        EXPECT_EQ(tree.levels[1].mesh.triangleCount(), 50u);
        EXPECT_EQ(tree.levels[0].error, 0);
        EXPECT_GT(tree.levels[1].error, 0);
    }
}

TEST(BroadleafTree, levelsKeepTheCrownsSizeAndStandOnTheGround) {
    city::TreeShape shape;
    const std::array<std::size_t, 4> levels{20000, 4000, 800, 120};
    const city::Prototype tree = city::makeBroadleafTree("tree", shape, levels, 9);
    for (const city::Prototype::Level& level : tree.levels) {
        const city::Aabb box = level.mesh.bounds();
        EXPECT_LT(box.min.z, 0.01f);
        EXPECT_GT(box.min.z, -0.3f);
        EXPECT_NEAR(box.max.z, shape.height, 0.12f * shape.height);
        EXPECT_NEAR(0.5f * box.size().x, shape.crownRadius, 0.25f * shape.crownRadius);
        EXPECT_NEAR(0.5f * box.size().y, shape.crownRadius, 0.25f * shape.crownRadius);
    }
}

TEST(PerimeterBlock, fillsTheRingBetweenStreetAndCourtWithHouses) {
    const city::Palette palette = city::makePalette();
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        city::Random random(seed);
        city::BlockPlan plan;
        plan.boundary = {{random.range(-50, -40), random.range(-50, -40)},
                         {random.range(40, 50), random.range(-50, -40)},
                         {random.range(40, 50), random.range(40, 50)},
                         {random.range(-50, -40), random.range(40, 50)}};
        plan.sides.assign(4, {});
        const city::PlannedBlock block = city::planPerimeterBlock(plan, palette, 0, random);
        ASSERT_FALSE(block.court.empty());
        double houses = 0;
        for (const city::PlannedHouse& house : block.houses) {
            std::vector<glm::vec2> ring;
            for (const auto& corner : house.lot.corners) ring.push_back(corner.position);
            EXPECT_GT(area(ring), 20) << seed;
            houses += area(ring);
        }
        // No gap and no overlap: the lots' areas sum up to the ring's.
        EXPECT_NEAR(houses, area(plan.boundary) - area(block.court), 1) << seed;
    }
}

TEST(PerimeterBlock, givesUpWhereThereIsNoRoom) {
    const city::Palette palette = city::makePalette();
    city::Random random(1);
    city::BlockPlan plan;
    plan.boundary = {{0, 0}, {12, 0}, {12, 80}, {0, 80}};
    plan.sides.assign(4, {});
    EXPECT_TRUE(city::planPerimeterBlock(plan, palette, 0, random).houses.empty());
    plan.boundary.clear();
    EXPECT_TRUE(city::planPerimeterBlock(plan, palette, 0, random).houses.empty());
}

TEST(InsetRing, movesEverySideByItsDistance) {
    const std::vector<glm::vec2> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    const std::array<float, 4> distances{1, 2, 3, 4};
    const std::vector<glm::vec2> inner = city::insetRing(square, distances);
    ASSERT_EQ(inner.size(), 4u);
    EXPECT_NEAR(glm::length(inner[0] - glm::vec2(4, 1)), 0, 1e-5);
    EXPECT_NEAR(glm::length(inner[1] - glm::vec2(8, 1)), 0, 1e-5);
    EXPECT_NEAR(glm::length(inner[2] - glm::vec2(8, 7)), 0, 1e-5);
    EXPECT_NEAR(glm::length(inner[3] - glm::vec2(4, 7)), 0, 1e-5);
    EXPECT_TRUE(city::insetRing(square, 5.5f).empty());
}
