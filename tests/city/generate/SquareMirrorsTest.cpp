#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "city/model/CityHeightfield.h"

namespace {

using city::CityModel;
using city::StandingReflector;

float toLanes(const CityModel& city, glm::vec2 p) {
    float nearest = 1e9f;
    for (const city::Lane& lane : city.roads.lanes)
        for (std::size_t i = 0; i + 1 < lane.centreLine.size(); ++i) {
            const glm::vec2 a(lane.centreLine[i]), d = glm::vec2(lane.centreLine[i + 1]) - a;
            const float t =
                glm::dot(d, d) > 0 ? std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0f, 1.0f) : 0;
            nearest = std::min(nearest, glm::length(a + t * d - p) - 0.5f * lane.width);
        }
    return nearest;
}

/// Metres between a reflector's body and the nearest corner of what is placed in the city.
float toThings(const CityModel& city, const StandingReflector& reflector) {
    float nearest = 1e9f;
    for (const city::Placement& placement : city.placements) {
        const glm::mat4& m = placement.worldFromPrototype;
        if (glm::length(glm::vec2(m[3]) - glm::vec2(reflector.foot)) > 20) continue;
        for (const city::Vertex& v : city.prototypes[placement.prototype].levels.front().mesh.vertices) {
            const glm::vec3 p(m * glm::vec4(v.position, 1));
            if (p.z > reflector.foot.z + reflector.height + 0.5f) continue;
            nearest =
                std::min(nearest, glm::length(glm::vec2(p) - glm::vec2(reflector.foot)) - reflector.radius);
        }
    }
    return nearest;
}

void expectSound(const CityModel& city, const std::string& what) {
    for (const StandingReflector& r : city.reflectors) {
        EXPECT_GT(toLanes(city, glm::vec2(r.foot)), 6) << what << ": " << r.name << " stands at a lane";
        EXPECT_GT(toThings(city, r), 0.25f) << what << ": " << r.name << " stands in something";
        for (std::size_t i = 0; i + 1 < city.tour.size(); ++i)
            for (const float t : {0.0f, 0.33f, 0.67f}) {
                const glm::vec3 eye = glm::mix(city.tour[i].eye, city.tour[i + 1].eye, t);
                const glm::vec3 off = eye - r.centre();
                const float up = std::max(0.0f, std::abs(off.z) - 0.5f * r.height);
                EXPECT_GT(std::hypot(glm::length(glm::vec2(off)), up), r.radius + 1)
                    << what << ": " << r.name << " stands in the tour's way";
            }
    }
}

}  // namespace

TEST(SquareMirrors, aChromeSphereAndAPillarStandOnTheBoulevardsSquare) {
    const CityModel city = city::generateBoulevard();
    ASSERT_EQ(city.reflectors.size(), 2u);
    EXPECT_EQ(city.reflectors[0].shape, StandingReflector::Shape::sphere);
    EXPECT_EQ(city.reflectors[0].stuff, StandingReflector::Stuff::chrome);
    EXPECT_EQ(city.reflectors[1].shape, StandingReflector::Shape::pillar);
    for (const StandingReflector& r : city.reflectors)
        EXPECT_LT(toLanes(city, glm::vec2(r.foot)), 25) << r.name << " is too far off to mirror the cars";
}

TEST(SquareMirrors, standClearOfLanesThingsAndTheTourWhateverTheSeedAndSize) {
    std::size_t stand = 0, cities = 0;
    for (const double size : {200.0, 300.0, 600.0})
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            const CityModel city = city::generateBoulevard({seed, size});
            expectSound(city, "seed " + std::to_string(seed) + ", " + std::to_string(size) + " m");
            stand += city.reflectors.size();
            ++cities;
        }
    EXPECT_GE(stand, 2 * cities - 2) << "nearly all find a place";
}

TEST(SquareMirrors, otherSeedsPutThemElsewhere) {
    const CityModel a = city::generateBoulevard({1, 600}), b = city::generateBoulevard({2, 600});
    ASSERT_FALSE(a.reflectors.empty() || b.reflectors.empty());
    EXPECT_NE(a.reflectors[0].foot, b.reflectors[0].foot);
}

TEST(SquareMirrors, restOnTheirPlinthsAndAreNoColumnsOfTheHeightfield) {
    const CityModel city = city::generateBoulevard({1, 300});
    ASSERT_FALSE(city.reflectors.empty());
    const city::Heightfield field = city::cityHeightfield(city, 1);
    for (const StandingReflector& r : city.reflectors) {
        // The four cells of the slab around the foot, which lies on whole metres.
        for (const float x : {-0.5f, 0.5f})
            for (const float y : {-0.5f, 0.5f}) {
                const float slab = field.heightAt(r.foot.x + x, r.foot.y + y);
                EXPECT_GT(slab, 0.3f) << r.name;
                EXPECT_LE(slab, r.foot.z) << r.name;
                EXPECT_GT(slab, r.foot.z - 0.3f) << r.name;
            }
        EXPECT_LT(field.heightAt(r.foot.x + 1.5, r.foot.y + 0.5), 0.3f) << r.name;
    }
}

TEST(SquareMirrors, thePaperCityHasNone) {
    EXPECT_TRUE(city::generatePaperCity().reflectors.empty());
}
