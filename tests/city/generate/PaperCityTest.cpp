#include "city/generate/PaperCity.h"

#include <gtest/gtest.h>

#include "tests/city/generate/CityChecks.h"

namespace {

const city::CityModel& paper() {
    static const city::CityModel model = city::generatePaperCity();
    return model;
}

}  // namespace

// Meyer & Loscos 2003, section 7: 500,000 triangles, 25,600 of them buildings, 8 trees of 59,100 each, 1 km2.
TEST(PaperCity, hasThePapersTriangleCounts) {
    const city::CityModel& city = paper();
    EXPECT_EQ(city.triangleCount(), 500000u);
    std::size_t buildings = 0, ground = 0;
    for (const city::Chunk& chunk : city.chunks) {
        (chunk.kind == city::ChunkKind::ground ? ground : buildings) += chunk.mesh.triangleCount();
    }
    EXPECT_EQ(buildings, 25600u);
    EXPECT_EQ(ground, 1600u);
    ASSERT_EQ(city.placements.size(), 8u);
    for (const city::Placement& tree : city.placements) {
        EXPECT_EQ(city.prototypes[tree.prototype].levels.front().mesh.triangleCount(), 59100u);
    }
}

TEST(PaperCity, coversASquareKilometre) {
    const glm::vec3 size = paper().bounds.size();
    EXPECT_NEAR(size.x, 1000, 1);
    EXPECT_NEAR(size.y, 1000, 1);
}

TEST(PaperCity, keepsItsCountsForOtherSeeds) {
    for (const std::uint64_t seed : {2u, 3u, 77u}) {
        const city::CityModel city = city::generatePaperCity(seed);
        EXPECT_EQ(city.triangleCount(), 500000u) << seed;
        EXPECT_NE(city.contentHash(), paper().contentHash());
    }
    EXPECT_EQ(city::generatePaperCity(1).contentHash(), paper().contentHash());
}

TEST(PaperCity, meshesAreSound) {
    const city::CityModel& city = paper();
    for (const city::Chunk& chunk : city.chunks) {
        checkMesh(chunk.mesh, city.materials.size(), "chunk");
        EXPECT_EQ(contradictions(chunk.mesh), 0u);
        EXPECT_EQ(slivers(chunk.mesh), 0u);
    }
    for (const city::Prototype& prototype : city.prototypes) {
        for (const city::Prototype::Level& level : prototype.levels)
            checkMesh(level.mesh, city.materials.size(), prototype.name);
    }
}
