#include "city/model/CityHeightfield.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace {

/// A level square of 4 m around (x, y) at height z.
city::Mesh slab(float x, float y, float z) {
    city::Mesh mesh;
    mesh.addQuad({{x - 2, y - 2, z}}, {{x + 2, y - 2, z}}, {{x + 2, y + 2, z}}, {{x - 2, y + 2, z}});
    return mesh;
}

city::Chunk chunk(city::ChunkKind kind, city::Mesh mesh) {
    const city::Aabb bounds = mesh.bounds();
    return {kind, std::move(mesh), bounds};
}

city::CityModel smallCity() {
    city::CityModel city;
    city.chunks.push_back(chunk(city::ChunkKind::ground, slab(0, 0, 0)));
    city.chunks.push_back(chunk(city::ChunkKind::building, slab(10, 0, 12)));
    city.chunks.push_back(chunk(city::ChunkKind::furniture, slab(20, 0, 3)));
    for (const bool column : {true, false}) {
        city::Prototype prototype;
        prototype.levels.push_back({slab(0, 0, 5), 0});
        prototype.inHeightfield = column;
        city.prototypes.push_back(prototype);
        glm::mat4 place(1);
        place[3] = glm::vec4(column ? 30 : 40, 0, 0, 1);
        city.placements.push_back({column ? 0u : 1u, place});
    }
    return city;
}

}  // namespace

TEST(CityHeightfield, holdsGroundBuildingsAndColumnsButNothingThatHangs) {
    const city::Heightfield field = city::cityHeightfield(smallCity(), 1);
    EXPECT_EQ(field.heightAt(0, 0), 0);
    EXPECT_EQ(field.heightAt(10, 0), 12);
    EXPECT_TRUE(std::isinf(field.heightAt(20, 0)));
    EXPECT_EQ(field.heightAt(30, 0), 5);
    EXPECT_TRUE(std::isinf(field.heightAt(40, 0)));
}

TEST(CityHeightfield, occludersAreBuildingsAlone) {
    const city::Heightfield field = city::occluderHeightfield(smallCity(), 1);
    EXPECT_EQ(field.heightAt(10, 0), 12);
    for (const double x : {0.0, 20.0, 30.0, 40.0}) EXPECT_TRUE(std::isinf(field.heightAt(x, 0))) << x;
}

TEST(CityHeightfield, anEmptyCityGivesOneEmptyCell) {
    const city::Heightfield field = city::cityHeightfield({}, 1);
    EXPECT_EQ(field.width() * field.height(), 1);
    EXPECT_TRUE(std::isinf(field.at(0, 0)));
}

TEST(CityHeightfield, refusesAbsurdCells) {
    for (const float cell : {0.0f, -1.0f, std::nanf(""), 1e-6f}) {
        EXPECT_THROW(city::cityHeightfield(smallCity(), cell), std::invalid_argument) << cell;
    }
}
