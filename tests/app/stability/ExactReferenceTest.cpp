// The campaign's reference against the literal transcription of the rules, and its judgement against planted
// errors.
#include "app/stability/ExactReference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/stability/AdversarialRays.h"
#include "tests/reflection/tracing/ExactOracle.h"

namespace app::stability {
namespace {

using reflection::ExactOracle;
using reflection::TraceStatus;

TEST(ExactReferenceTest, agreesWithTheLiteralTranscription) {
    int hits = 0, misses = 0;
    for (const FieldKind& kind : fieldKinds()) {
        if (kind.width > 50) continue;  // the transcription lists every border
        SeededRandom random(11);
        const city::Heightfield field = makeField(kind, random);
        const ExactReference reference(field);
        const ExactOracle oracle(field);
        for (int f = 0; f < static_cast<int>(RayFamily::count); ++f)
            for (int k = 0; k < 60; ++k) {
                const auto family = static_cast<RayFamily>(f);
                const glm::vec3 start = startOf(family, field, random);
                const city::Ray ray{start, directionOf(family, field, start, random)};
                const ExactReference::Answer answer = reference.trace(ray);
                ExactOracle::Answer truth = oracle.trace(ray);
                if (truth.status == TraceStatus::hit && ExactOracle::beyondFloats(truth))
                    truth.status = TraceStatus::miss;
                ASSERT_EQ(answer.status, truth.status) << kind.name << ", " << nameOf(family);
                if (truth.status != TraceStatus::hit) {
                    ++misses;
                    continue;
                }
                ++hits;
                ASSERT_EQ(answer.cell, truth.cell) << kind.name << ", " << nameOf(family);
                const auto t = static_cast<float>(answer.numerator / answer.denominator);
                EXPECT_TRUE(ExactOracle::withinBound(t, truth));
                EXPECT_LE(ExactReference::shareOfBound(t, answer), 1);
            }
    }
    EXPECT_GT(hits, 3000);
    EXPECT_GT(misses, 1000);
}

TEST(ExactReferenceTest, twoFloatsOffAreBeyondTheBound) {
    city::Heightfield field(8, 8, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(6, 3, 10);
    const auto answer = ExactReference(field).trace({{0.3f, 3.7f, 1}, {0.9f, -0.05f, 0}});
    ASSERT_EQ(answer.status, TraceStatus::hit);
    EXPECT_EQ(answer.cell, glm::ivec2(6, 3));
    const auto t = static_cast<float>(answer.numerator / answer.denominator);
    EXPECT_LE(ExactReference::shareOfBound(t, answer), 1);
    for (const float direction : {0.0f, std::numeric_limits<float>::infinity()})
        EXPECT_GT(
            ExactReference::shareOfBound(std::nextafter(std::nextafter(t, direction), direction), answer), 1);
}

TEST(ExactReferenceTest, passagesAreToldFromTouches) {
    city::Heightfield field(4, 4, 1, {0, 0});
    for (float& h : field.cells()) h = 0;
    field.set(2, 1, 10);
    const ExactReference reference(field);
    const auto depth = [&](const city::Ray& ray) {
        return reference.depthOfPassage(ray, reference.trace(ray));
    };
    EXPECT_NEAR(depth({{0.5f, 1.5f, 5}, {1, 0, 0}}), 0.5, 1e-6);    // through the middle
    EXPECT_NEAR(depth({{0.5f, 1.25f, 5}, {1, 0, 0}}), 0.25, 1e-6);  // a quarter beside a wall
    EXPECT_NEAR(depth({{2.5f, 1.25f, 20}, {0, 0, -1}}), 0.25, 1e-6);
    EXPECT_EQ(depth({{0.5f, 0.5f, 5}, {1, 1, 0}}), 0);   // through the corner (2, 2) alone
    EXPECT_EQ(depth({{0.5f, 1.5f, 10}, {1, 0, 0}}), 0);  // in the plane of the top
}

}  // namespace
}  // namespace app::stability
