#include "app/commands/TracerBench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/commands/IntegerReference.h"
#include "app/commands/TextbookDda.h"
#include "reflection/tracing/GridTracer.h"

namespace app {
namespace {

TEST(IntegerReferenceTest, confirmsTheTracerAndCatchesEveryKindOfError) {
    const TracerBenchField town = blockTown(3, 200);
    const reflection::GridTracer tracer(town.field);
    const auto reference = IntegerReference::of(town.field);
    ASSERT_TRUE(reference);
    int hits = 0, misses = 0;
    for (int k = 0; k < 4000; ++k) {
        const glm::vec3 origin((k * 37 % 190) - 95 + 0.25f, (k * 53 % 190) - 95 + 0.5f, 45);
        const glm::vec3 direction(static_cast<float>(k % 64 - 32) / 32, static_cast<float>(k % 41 - 20) / 32,
                                  static_cast<float>(k % 19 - 14) / 32);
        if (direction == glm::vec3(0)) continue;
        const city::Ray ray{origin, direction};
        const reflection::TraceResult right = tracer.trace(ray);
        ASSERT_TRUE(reference->confirms(ray, right)) << k;
        reflection::TraceResult wrong = right;
        if (right.status == reflection::TraceStatus::miss) {
            ++misses;
            wrong = {reflection::TraceStatus::hit, 1, {3, 3}};
            EXPECT_FALSE(reference->confirms(ray, wrong));
            continue;
        }
        ++hits;
        wrong.status = reflection::TraceStatus::miss;
        EXPECT_FALSE(reference->confirms(ray, wrong));
        wrong = right;
        wrong.cell.x += 1;
        EXPECT_FALSE(reference->confirms(ray, wrong));
        if (right.t > 0) {
            // Half an ulp is allowed: the second float on either side is out whatever t's rounding was.
            wrong = right;
            wrong.t = std::nextafter(std::nextafter(right.t, 0.0f), 0.0f);
            EXPECT_FALSE(reference->confirms(ray, wrong)) << k;
            wrong.t = std::nextafter(std::nextafter(right.t, INFINITY), INFINITY);
            EXPECT_FALSE(reference->confirms(ray, wrong)) << k;
        }
    }
    EXPECT_GT(hits, 1000);
    EXPECT_GT(misses, 300);
}

TEST(IntegerReferenceTest, declinesFieldsThatItCannotHold) {
    EXPECT_FALSE(IntegerReference::of(city::Heightfield(4, 4, 0.1f, {0, 0})));
    EXPECT_FALSE(IntegerReference::of(city::Heightfield(4, 4, 1, {1e-9, 0})));
    EXPECT_TRUE(IntegerReference::of(city::Heightfield(4, 4, 0.5f, {-3.25, 8})));
}

TEST(TracerBenchTest, textbookWalkMeetsTheSameWallsUpToRounding) {
    const TracerBenchField town = blockTown(4, 200);
    const reflection::GridTracer tracer(town.field);
    int different = 0, rays = 0;
    for (int k = 0; k < 3000; ++k) {
        const float angle = static_cast<float>(k) * 0.37f;
        const city::Ray ray{{(k * 37 % 150) - 75 + 0.37f, (k * 53 % 150) - 75 + 0.71f, 2},
                            {std::cos(angle), std::sin(angle), 0.01f * static_cast<float>(k % 50 - 25)}};
        const float ours = tracer.trace(ray).t;
        const float theirs = textbookDda(town.field, town.field.highest(), ray);
        ++rays;
        different += !(ours == theirs || std::abs(ours - theirs) <= 1e-3f * (1 + ours));
    }
    EXPECT_LT(different, rays / 200) << "the yardstick does the same work";
}

TEST(TracerBenchTest, rowsNameEveryMethodAndFindNoDisagreement) {
    const TracerBenchField fields[] = {blockTown(1, 300)};
    TracerBenchOptions options;
    options.repeats = 1;
    options.origins = 1;
    options.checkedRays = 20000;
    double progress = 0;
    options.progress = [&](double share) { progress = share; };
    const nlohmann::json rows = runTracerBench(fields, options);
    ASSERT_EQ(rows.size(), 14u);  // 7 methods, 2 orders
    EXPECT_EQ(progress, 1);
    for (const auto& row : rows) {
        EXPECT_EQ(row["bench"], "tracer");
        EXPECT_EQ(row["city"], "block_town");
        EXPECT_GT(row["mrays_per_s"]["median"], 0);
        if (row["method"] == "trace" || row["method"] == "fan") {
            EXPECT_EQ(row["checked"], 20000);
            EXPECT_EQ(row["disagreements"], 0);
        }
    }
}

TEST(TracerBenchTest, interruptionKeepsWhatIsFinished) {
    const TracerBenchField fields[] = {blockTown(1, 300)};
    TracerBenchOptions options;
    options.embree = false;
    options.interrupted = [] { return true; };
    EXPECT_TRUE(runTracerBench(fields, options).empty());
}

}  // namespace
}  // namespace app
