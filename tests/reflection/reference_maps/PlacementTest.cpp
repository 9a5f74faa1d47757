#include "reflection/reference_maps/Placement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "reflection/reference_maps/Selection.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

/// A street from south to north crosses two others; all 14 m wide, between blocks 15 m high.
city::Heightfield streets() {
    city::Heightfield field(120, 120, 1, {-60, -60});
    for (int j = 0; j < 120; ++j)
        for (int i = 0; i < 120; ++i) {
            const bool street = std::abs(i - 59.5f) < 7 || std::abs(j - 29.5f) < 7 || std::abs(j - 89.5f) < 7;
            field.set(i, j, street ? 0.0f : 15.0f);
        }
    return field;
}

std::vector<glm::vec3> lanes() {
    std::vector<glm::vec3> positions;
    for (int k = -55; k <= 55; k += 2) {
        positions.emplace_back(k, -32, 0.01f);
        positions.emplace_back(k, 28, 0.01f);
        positions.emplace_back(2, k, 0.01f);
    }
    return positions;
}

/// Share of the surface visible from the driving positions that the maps see: counted afresh, with single
/// rays, other directions and no cubes, so that it can differ from the placement's own count only by
/// sampling.
double coverageByHand(const GridTracer& tracer, const std::vector<glm::vec3>& driving,
                      const std::vector<glm::vec3>& maps) {
    SeededRandom random(21);
    int seen = 0, all = 0;
    while (all < 3000) {
        const glm::vec3 eye =
            driving[static_cast<std::size_t>(random.below(static_cast<int>(driving.size())))] +
            glm::vec3(0, 0, 0.8f);
        const double z = random.between(-1, 1), angle = random.between(0, 6.2831853),
                     r = std::sqrt(1 - z * z);
        const glm::vec3 d(r * std::cos(angle), r * std::sin(angle), z);
        const TraceResult hit = tracer.trace({eye, d});
        if (hit.status != TraceStatus::hit || hit.t > 100) continue;
        ++all;
        const glm::vec3 point = eye + d * (hit.t - 1e-3f);
        for (const glm::vec3& map : maps)
            if (!tracer.occluded(map, point, 0.05f)) {
                ++seen;
                break;
            }
    }
    return static_cast<double>(seen) / all;
}

TEST(PlacementTest, reachesTheCoverageItReports) {
    const GridTracer tracer(streets());
    const std::vector<glm::vec3> driving = lanes();
    for (const float coverage : {0.8f, 0.98f}) {
        PlacementOptions options;
        options.coverage = coverage;
        options.spacing = 0;
        const Placement placement = placeReferenceMaps(tracer, driving, options);
        ASSERT_FALSE(placement.positions.empty());
        EXPECT_GE(placement.coverage, coverage);
        EXPECT_LE(placement.coverage, 1.0f);
        EXPECT_GT(placement.samples, 500u);
        EXPECT_LE(placement.positions.size(), placement.candidates);
        // Weighted by what cars see rather than by area, large near surfaces count for more: no worse than
        // the area's share less sampling (3 sigma of 3000 draws: 0.022) and the cubes' size.
        EXPECT_GT(coverageByHand(tracer, driving, placement.positions), coverage - 0.04);
    }
}

TEST(PlacementTest, lessCoverageIsABeginningOfMore) {
    // The greedy choice does not look ahead: it stops earlier.
    const GridTracer tracer(streets());
    PlacementOptions options;
    options.spacing = 0;
    options.coverage = 0.99f;
    const Placement all = placeReferenceMaps(tracer, lanes(), options);
    options.coverage = 0.5f;
    const Placement half = placeReferenceMaps(tracer, lanes(), options);
    EXPECT_LT(half.positions.size(), all.positions.size());
    for (std::size_t i = 0; i < half.positions.size(); ++i) EXPECT_EQ(half.positions[i], all.positions[i]);
}

TEST(PlacementTest, keepsTheSpacing) {
    const GridTracer tracer(streets());
    const std::vector<glm::vec3> driving = lanes();
    for (const float spacing : {6.0f, 15.0f, 40.0f}) {
        PlacementOptions options;
        options.spacing = spacing;
        const Placement placement = placeReferenceMaps(tracer, driving, options);
        for (const glm::vec3& p : driving) {
            float nearest = 1e9f;
            for (const glm::vec3& map : placement.positions)
                nearest = std::min(nearest, glm::distance(map, p + glm::vec3(0, 0, options.mapHeight)));
            // One position is looked at in each square of 8 m (Placement.h).
            EXPECT_LE(nearest, spacing + 8 * std::sqrt(2.0f));
        }
    }
}

TEST(PlacementTest, isDeterministic) {
    const GridTracer tracer(streets());
    const Placement a = placeReferenceMaps(tracer, lanes(), {});
    const Placement b = placeReferenceMaps(tracer, lanes(), {});
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.coverage, b.coverage);
}

TEST(PlacementTest, emptyInputIsFullyCovered) {
    const GridTracer tracer(streets());
    const Placement none = placeReferenceMaps(tracer, {}, {});
    EXPECT_TRUE(none.positions.empty());
    EXPECT_EQ(none.coverage, 1.0f);
    // Nothing to be seen: spacing alone decides, and a single position gets its map.
    const GridTracer nothing(city::Heightfield(4, 4, 1, {0, 0}));
    const std::vector<glm::vec3> one{{1, 1, 0}};
    const Placement single = placeReferenceMaps(nothing, one, {});
    EXPECT_EQ(single.positions.size(), 1u);
    EXPECT_EQ(single.coverage, 1.0f);
}

TEST(SelectionTest, visibleMapsComeFirstAndNearerOnesEarlier) {
    const GridTracer tracer(streets());
    ReferenceMap plain;
    plain.faceSize = 4;
    plain.colour.assign(plain.texelCount(), glm::vec3(1));
    plain.distance.assign(plain.texelCount(), 5);
    SeededRandom random(22);
    std::vector<PackedReferenceMap> maps;
    for (const glm::vec3& p : lanes()) {
        if (random.below(3) != 0) continue;
        plain.position = glm::dvec3(p) + glm::dvec3(0, 0, 2.5);
        maps.emplace_back(plain, 1.0f);
    }
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 centre =
            k % 2 ? glm::dvec3(random.between(-50, 50), -32, 1) : glm::dvec3(2, random.between(-50, 50), 1);
        const std::vector<Candidate> chosen = selectCandidates(maps, centre, tracer, 6);
        ASSERT_EQ(chosen.size(), 6u);
        bool hiddenBefore = false;
        float last = 0;
        for (const Candidate& c : chosen) {
            const bool hidden = tracer.occluded(glm::vec3(centre), glm::vec3(c.map->position()));
            EXPECT_FALSE(hiddenBefore && !hidden);
            const float d = glm::length(c.offset);
            if (hidden == hiddenBefore) {
                EXPECT_GE(d, last);
            }
            EXPECT_NEAR(glm::length(glm::dvec3(c.offset) - (c.map->position() - centre)), 0, 1e-4);
            hiddenBefore = hidden;
            last = d;
        }
        const std::vector<Candidate> two = selectNearestTwo(maps, centre);
        ASSERT_EQ(two.size(), 2u);
        for (const PackedReferenceMap& map : maps)
            if (&map != two[0].map && &map != two[1].map) {
                EXPECT_GE(glm::length(glm::vec3(map.position() - centre)),
                          glm::length(two[1].offset) - 1e-4f);
            }
    }
    EXPECT_TRUE(selectCandidates({}, glm::dvec3(0), tracer, 4).empty());
    EXPECT_EQ(selectNearestTwo(std::span(maps).first(1), glm::dvec3(0)).size(), 1u);
}

}  // namespace
}  // namespace reflection
