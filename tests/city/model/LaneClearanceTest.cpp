#include "city/model/LaneClearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "city/model/CityHeightfield.h"

namespace {

city::Heightfield solid(int width, int height, float cell, glm::dvec2 origin) {
    city::Heightfield field(width, height, cell, origin);
    std::fill(field.cells().begin(), field.cells().end(), 8.0f);
    return field;
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) nearest = std::min(nearest, glm::length(p - glm::mix(a, b, k / 2000.0)));
    return nearest;
}

city::Mesh slab(float x0, float x1, float y0, float y1, float z) {
    city::Mesh mesh;
    mesh.addQuad({{x0, y0, z}}, {{x1, y0, z}}, {{x1, y1, z}}, {{x0, y1, z}});
    return mesh;
}

city::Chunk chunk(city::ChunkKind kind, city::Mesh mesh) {
    const city::Aabb bounds = mesh.bounds();
    return {kind, std::move(mesh), bounds};
}

city::Lane lane(std::vector<glm::vec3> centreLine, float width = 3) {
    city::Lane made;
    made.centreLine = std::move(centreLine);
    made.width = width;
    return made;
}

}  // namespace

TEST(LaneClearance, clearsExactlyTheCellsWhoseCentresLieOverTheLane) {
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    for (int trial = 0; trial < 20; ++trial) {
        const glm::dvec2 origin(uniform(-500, 500), uniform(-500, 500));
        const float cell = static_cast<float>(uniform(0.3, 3));
        const double side = 24 * cell;
        // Also partly and wholly beside the field.
        const glm::vec3 a(origin.x + uniform(-0.5, 1.5) * side, origin.y + uniform(-0.5, 1.5) * side, 0);
        const glm::vec3 b(origin.x + uniform(-0.5, 1.5) * side, origin.y + uniform(-0.5, 1.5) * side, 0);
        city::RoadNetwork roads;
        roads.lanes.push_back(lane({a, b}));
        city::Heightfield field = solid(24, 20, cell, origin);
        city::clearLanes(roads, 1, field);
        for (int j = 0; j < field.height(); ++j)
            for (int i = 0; i < field.width(); ++i) {
                const glm::dvec2 centre = origin + glm::dvec2(i + 0.5, j + 0.5) * static_cast<double>(cell);
                const double distance = distanceToSegment(centre, glm::dvec2(a), glm::dvec2(b));
                // The oracle walks the segment in steps of at most 48 cells / 2000.
                if (std::abs(distance - 2.5) < 0.024 * static_cast<double>(cell)) continue;
                EXPECT_EQ(std::isinf(field.at(i, j)), distance < 2.5) << trial << ": " << i << ", " << j;
            }
    }
}

TEST(LaneClearance, waysAcrossJunctionsAreAsWideAsTheLaneTheyComeFrom) {
    city::RoadNetwork roads;
    roads.lanes.push_back(lane({{-50, 0, 0}, {-40, 0, 0}}, 5));
    city::Connection way;
    way.fromLane = 0;
    way.centreLine = {{0, 0, 0}, {10, 0, 0}};
    roads.connections.push_back(way);
    city::Heightfield field = solid(10, 10, 1, {0, -5});
    city::clearLanes(roads, 0, field);
    EXPECT_TRUE(std::isinf(field.heightAt(5, 2.4)));
    EXPECT_EQ(field.heightAt(5, 3.4), 8);
}

TEST(LaneClearance, linesThatAreNoneClearNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    city::RoadNetwork roads;
    roads.lanes.push_back(lane({{5, 5, 0}}));
    roads.lanes.push_back(lane({{nan, 5, 0}, {5, 5, 0}}));
    roads.lanes.push_back(lane({{5, 5, 0}, {5, std::numeric_limits<float>::infinity(), 0}}));
    city::Heightfield field = solid(10, 10, 1, {0, 0});
    city::clearLanes(roads, 1, field);
    for (const float z : field.cells()) EXPECT_EQ(z, 8);
}

/// A car under a crown or in a passage is not inside a column; beside the lane both stand.
TEST(LaneClearance, carsUnderCrownsAndInPassagesStandInTheOpen) {
    city::CityModel city;
    city.chunks.push_back(chunk(city::ChunkKind::ground, slab(-40, 40, -40, 40, 0)));
    city.chunks.push_back(chunk(city::ChunkKind::building, slab(-30, -20, -20, 20, 15)));
    city::Prototype tree;
    tree.levels.push_back({slab(-4, 4, -4, 4, 9), 0});
    city.prototypes.push_back(tree);
    glm::mat4 place(1);
    place[3] = glm::vec4(20, 4, 0, 1);
    city.placements.push_back({0, place});
    city.roads.lanes.push_back(lane({{-40, 0, 0}, {40, 0, 0}}));
    const city::Heightfield field = city::cityHeightfield(city, 1);
    EXPECT_EQ(field.heightAt(-25, 0.5), 0) << "in the passage";
    EXPECT_EQ(field.heightAt(-25, 3.5), 15) << "the building beside it";
    EXPECT_EQ(field.heightAt(20, 0.5), 0) << "under the crown";
    EXPECT_EQ(field.heightAt(20, 2.5), 0) << "over the parking strip";
    EXPECT_EQ(field.heightAt(20, 5.5), 9) << "the crown itself";
}

/// A crown hangs, wherever it is: over the pavement who stands there is under it, not inside a column. What
/// has no air beneath stays a column.
TEST(LaneClearance, crownsHangOverWhoeverStandsUnderThem) {
    city::CityModel city;
    city.chunks.push_back(chunk(city::ChunkKind::ground, slab(-40, 40, -40, 40, 0)));
    city::Prototype tree;
    city::Mesh crown = slab(-4, 4, -4, 4, 9);
    const city::Mesh below = slab(-4, 4, -4, 4, 2.5f);
    const auto first = static_cast<std::uint32_t>(crown.vertices.size());
    crown.vertices.insert(crown.vertices.end(), below.vertices.begin(), below.vertices.end());
    for (const std::uint32_t index : below.indices) crown.indices.push_back(first + index);
    // A trunk whose foot lies under a cell's centre.
    const city::Mesh foot = slab(0.4f, 0.6f, 0.4f, 0.6f, 0.1f);
    const auto second = static_cast<std::uint32_t>(crown.vertices.size());
    crown.vertices.insert(crown.vertices.end(), foot.vertices.begin(), foot.vertices.end());
    for (const std::uint32_t index : foot.indices) crown.indices.push_back(second + index);
    tree.levels.push_back({crown, 0});
    city::Prototype bush;
    bush.levels.push_back({slab(-2, 2, -2, 2, 1.2f), 0});
    city.prototypes = {tree, bush};
    glm::mat4 place(1);
    place[3] = glm::vec4(20, 4, 0, 1);
    city.placements.push_back({0, place});
    place[3] = glm::vec4(-20, 10, 0, 1);
    city.placements.push_back({1, place});
    city.roads.lanes.push_back(lane({{-40, 0, 0}, {40, 0, 0}}));
    const city::CityColumns columns = city::cityColumns(city, 1);
    const city::Heightfield& solid = columns.solid;
    EXPECT_EQ(solid.heightAt(20.5, 4.5), 0) << "under the crown, where its trunk stands";
    EXPECT_EQ(columns.hanging.underside.heightAt(20.5, 4.5), 2.5f);
    EXPECT_EQ(columns.hanging.top.heightAt(20.5, 4.5), 9);
    EXPECT_EQ(columns.hanging.underside.heightAt(20.5, 0.5), 3) << "over the lane, cut to height";
    EXPECT_EQ(columns.hanging.top.heightAt(30.5, 4.5), -std::numeric_limits<float>::infinity());
    EXPECT_EQ(solid.heightAt(-20.5, 10.5), 1.2f) << "a bush";
    EXPECT_EQ(columns.hanging.top.heightAt(-20.5, 10.5), -std::numeric_limits<float>::infinity());
}
