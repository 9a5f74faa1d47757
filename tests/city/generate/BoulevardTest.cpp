#include "city/generate/Boulevard.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "tests/city/generate/CityChecks.h"

namespace {

const city::CityModel& boulevard() {
    static const city::CityModel model = city::generateBoulevard();
    return model;
}

}  // namespace

TEST(Boulevard, meshesAreSound) {
    const city::CityModel& city = boulevard();
    std::size_t triangles = 0, thin = 0;
    for (const city::Chunk& chunk : city.chunks) {
        checkMesh(chunk.mesh, city.materials.size(), "chunk");
        EXPECT_EQ(contradictions(chunk.mesh), 0u);
        triangles += chunk.mesh.triangleCount();
        thin += slivers(chunk.mesh);
    }
    EXPECT_LT(thin, triangles / 1000);
    for (const city::Prototype& prototype : city.prototypes) {
        ASSERT_FALSE(prototype.levels.empty()) << prototype.name;
        std::size_t last = std::numeric_limits<std::size_t>::max();
        for (const city::Prototype::Level& level : prototype.levels) {
            checkMesh(level.mesh, city.materials.size(), prototype.name);
            EXPECT_LT(level.mesh.triangleCount(), last) << prototype.name;
            last = level.mesh.triangleCount();
        }
    }
    for (const city::Placement& placement : city.placements)
        EXPECT_LT(placement.prototype, city.prototypes.size());
}

TEST(Boulevard, sameSeedSameCityOtherSeedOther) {
    EXPECT_EQ(city::generateBoulevard({1, 300}).contentHash(),
              city::generateBoulevard({1, 300}).contentHash());
    EXPECT_NE(city::generateBoulevard({1, 300}).contentHash(),
              city::generateBoulevard({2, 300}).contentHash());
}

TEST(Boulevard, refusesSizesOutsideItsRange) {
    for (const double size : {0.0, -5.0, 199.0, 2001.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(city::generateBoulevard({1, size}), std::invalid_argument) << size;
    }
}

TEST(Boulevard, buildsAtEverySize) {
    for (const double size : {200.0, 260.0, 430.0, 900.0}) {
        const city::CityModel city = city::generateBoulevard({3, size});
        EXPECT_GT(city.triangleCount(), 10000u) << size;
        EXPECT_FALSE(city.roads.lanes.empty()) << size;
        EXPECT_LE(city.bounds.size().x, size + 1);
        EXPECT_LE(city.bounds.size().y, size + 1);
    }
}
