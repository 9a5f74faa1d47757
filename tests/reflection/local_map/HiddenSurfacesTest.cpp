// What a lookup makes of surfaces that a reference map does not see.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "reflection/local_map/ReferenceLookup.h"
#include "tests/reflection/EveryInstructionSet.h"
#include "tests/reflection/local_map/AnalyticScene.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

LocalMap emptyMap(int n) {
    LocalMap map;
    map.resize(n);
    return map;
}

TEST(HiddenSurfacesTest, whatTheNearestMapCannotSeeComesFromTheOther) {
    // Between the nearer map and the local map's centre stands a red board; the farther one sees the room.
    const glm::dvec3 centre(2, 0, 1), near(0.5, 0.3, 1.2), far(2.5, -3, 1.5);
    const Scene hidden = [](const glm::dvec3& from, const glm::dvec3& d) {
        SceneHit hit = roomScene(from, d);
        if (d.x > 0 && 0.3 / d.x < hit.t) hit = {0.3 / d.x, 9, glm::dvec3(3, 0.01, 0.01)};
        return hit;
    };
    const PackedReferenceMap blind = mapOf(hidden, near, 128), clear = mapOf(roomScene, far, 128);
    const std::vector<Candidate> candidates{{&blind, glm::vec3(near - centre)},
                                            {&clear, glm::vec3(far - centre)}};
    const int n = 32;
    LocalMap map = emptyMap(n);
    std::vector<float> start;
    for (int i = 0; i < n * n; ++i)
        start.push_back(static_cast<float>(
            1 / roomScene(centre, glm::dvec3(cubeDirection(0, glm::vec2(i % n, i / n) + 0.5f, n))).t));
    onEveryInstructionSet([&] {
        lookUpRefined(0, start, candidates, {}, map);
        int red = 0;
        for (int i = 0; i < n * n; ++i) {
            const auto at = static_cast<std::size_t>(i);
            red += map.red[at] > 2 * map.green[at] ? 1 : 0;
            EXPECT_NEAR(map.depth[at] * start[at], 1, 0.15);
        }
        EXPECT_EQ(red, 0);
    });
}

TEST(HiddenSurfacesTest, skyThatARoofHidesFromTheMapIsSkyAllTheSame) {
    // The map stands at the foot of the left wall, which hides from it what the local map sees over the wall.
    const glm::dvec3 centre(7, 0, 10), low(-7, 0, 1);
    const PackedReferenceMap street = mapOf(streetScene, low, 128);
    const Candidate candidate{&street, glm::vec3(low - centre)};
    onEveryInstructionSet([&] {
        for (const int n : {5, 16, 33}) {
            LocalMap sky = emptyMap(n), map = emptyMap(n);
            std::fill(sky.red.begin(), sky.red.end(), 0.5f);
            std::fill(sky.green.begin(), sky.green.end(), 0.7f);
            std::fill(sky.blue.begin(), sky.blue.end(), 1.1f);
            LookupOptions options;
            options.sky = &sky;
            const int face = 1;  // towards the wall
            std::vector<float> start;
            int open = 0, built = 0;
            for (int i = 0; i < n * n; ++i)
                start.push_back(static_cast<float>(
                    1 /
                    streetScene(centre, glm::dvec3(cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n)))
                        .t));
            lookUpRefined(face, start, std::span(&candidate, 1), options, map);
            for (int i = 0; i < n * n; ++i) {
                const std::size_t at = map.faceOffset(face) + static_cast<std::size_t>(i);
                if (start[static_cast<std::size_t>(i)] == 0) {
                    ++open;
                    EXPECT_EQ(map.blue[at], 1.1f);
                    EXPECT_EQ(map.depth[at], infinity);
                } else {
                    ++built;
                    EXPECT_LT(map.depth[at], 100);
                }
            }
            EXPECT_GT(open, n);
            EXPECT_GT(built, n);
        }
    });
}

TEST(HiddenSurfacesTest, betweenAnEdgeAndWhatIsBehindItThereIsNoSurface) {
    // A board before a wall. The local map looks behind it, the first reference map does not: interpolated
    // over the board's edge it has a sheet from the board to the wall, which rays on their way to the wall
    // would meet and be content with. The second sees the wall.
    const auto scene = [](const glm::dvec3& from, const glm::dvec3& d) {
        SceneHit hit;
        if (d.x <= 0) return hit;
        hit = {(20 - from.x) / d.x, 0, glm::dvec3(0.2, 0.4, 0.2)};
        const double t = (5 - from.x) / d.x;
        if (t > 0 && (from + t * d).y < 0) hit = {t, 1, glm::dvec3(0.9, 0.3, 0.1)};
        return hit;
    };
    const glm::dvec3 centre(0, 4, 0), front(0, 0.3, 0), aside(0, 8, 0);
    const PackedReferenceMap blind = mapOf(scene, front, 64), clear = mapOf(scene, aside, 64);
    const std::vector<Candidate> candidates{{&blind, glm::vec3(front - centre)},
                                            {&clear, glm::vec3(aside - centre)}};
    const int n = 64;
    LocalMap map = emptyMap(n);
    std::vector<float> start;
    for (int i = 0; i < n * n; ++i)
        start.push_back(static_cast<float>(
            1 / scene(centre, glm::dvec3(cubeDirection(0, glm::vec2(i % n, i / n) + 0.5f, n))).t));
    onEveryInstructionSet([&] {
        lookUpRefined(0, start, candidates, {}, map);
        int between = 0;
        for (int i = 0; i < n * n; ++i) {
            const double x = map.depth[static_cast<std::size_t>(i)];
            between += x > 6 && x < 17 ? 1 : 0;
        }
        EXPECT_EQ(between, 0);
    });
}

}  // namespace
}  // namespace reflection
