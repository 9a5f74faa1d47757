#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "reflection/tracing/GridTracer.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int side = 24;

struct Wood {
    city::Heightfield solid{side, side, 1, {-12, -12}};
    city::Overhang hanging{{side, side, 1, {-12, -12}}, {side, side, 1, {-12, -12}}};

    /// Uneven ground, houses, and crowns of several heights, side by side with gaps.
    explicit Wood(SeededRandom& random) {
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                solid.set(i, j, static_cast<float>(random.between(0, 0.3)));
                if (random.below(12) == 0) solid.set(i, j, 9);
                if (random.below(3) == 0) {
                    const auto underside = static_cast<float>(random.between(1.8, 5));
                    hanging.underside.set(i, j, underside);
                    hanging.top.set(i, j, underside + static_cast<float>(random.between(0.5, 6)));
                }
            }
    }
};

/// The rule, cell by cell, from sorted border crossings.
double slowEntry(const Wood& wood, const city::Ray& ray, double tMax) {
    std::vector<double> at{0, tMax};
    for (int axis = 0; axis < 2; ++axis)
        for (int k = 0; k <= side; ++k) {
            const double d = static_cast<double>(ray.direction[axis]);
            if (d == 0) continue;
            const double t = (k - 12 - static_cast<double>(ray.origin[axis])) / d;
            if (t > 0 && t < tMax) at.push_back(t);
        }
    std::ranges::sort(at);
    const auto z = [&](double t) {
        return static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z);
    };
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
        const double middle = 0.5 * (at[k] + at[k + 1]);
        const int i = static_cast<int>(std::floor(static_cast<double>(ray.origin.x) +
                                                  middle * static_cast<double>(ray.direction.x) + 12));
        const int j = static_cast<int>(std::floor(static_cast<double>(ray.origin.y) +
                                                  middle * static_cast<double>(ray.direction.y) + 12));
        if (i < 0 || j < 0 || i >= side || j >= side) continue;
        double first = std::numeric_limits<double>::infinity();
        const auto enter = [&](double low, double high) {
            const double z0 = z(at[k]), z1 = z(at[k + 1]);
            if (z0 >= low && z0 <= high) first = std::min(first, at[k]);
            for (const double level : {low, high})
                if ((z0 - level) * (z1 - level) < 0)
                    first = std::min(first, at[k] + (at[k + 1] - at[k]) * (level - z0) / (z1 - z0));
        };
        enter(-1e9, static_cast<double>(wood.solid.at(i, j)));
        if (wood.hanging.hangs(i, j))
            enter(static_cast<double>(wood.hanging.underside.at(i, j)),
                  static_cast<double>(wood.hanging.top.at(i, j)));
        if (std::isfinite(first)) return first;
    }
    return std::numeric_limits<double>::infinity();
}

TEST(HangingTracer, agreesWithASlowWalkUnderInAndAboveCrowns) {
    SeededRandom random(5);
    int hung = 0;
    for (int town = 0; town < 8; ++town) {
        const Wood wood(random);
        const GridTracer tracer(wood.solid, wood.hanging), bare(wood.solid);
        for (int n = 0; n < 64; ++n) {
            const glm::vec3 origin(random.between(-11, 11), random.between(-11, 11), random.between(0.4, 13));
            std::array<float, 64> x, y, z, t, without;
            for (std::size_t k = 0; k < x.size(); ++k) {
                x[k] = static_cast<float>(random.between(-1, 1));
                y[k] = static_cast<float>(random.between(-1, 1));
                z[k] = static_cast<float>(random.between(-0.6, 0.6));
            }
            tracer.traceFan(origin, x, y, z, t);
            bare.traceFan(origin, x, y, z, without);
            for (std::size_t k = 0; k < x.size(); ++k) {
                const city::Ray ray{origin, {x[k], y[k], z[k]}};
                const double expected = slowEntry(wood, ray, 1e3);
                if (std::isinf(expected))
                    EXPECT_EQ(t[k], infinity);
                else
                    EXPECT_NEAR(static_cast<double>(t[k]), expected, 1e-4 * (1 + expected));
                const TraceResult one = tracer.trace(ray);
                EXPECT_EQ(one.status == TraceStatus::hit ? one.t : infinity, t[k]);
                hung += t[k] < without[k] ? 1 : 0;
            }
        }
    }
    EXPECT_GT(hung, 5000) << "of 32768 rays";
}

TEST(HangingTracer, endsAtTheLimitUnderCrownsToo) {
    SeededRandom random(7);
    const Wood wood(random);
    const GridTracer tracer(wood.solid, wood.hanging);
    int cut = 0;
    for (int n = 0; n < 4000; ++n) {
        const city::Ray ray{{random.between(-11, 11), random.between(-11, 11), random.between(0.4, 3)},
                            {random.between(-1, 1), random.between(-1, 1), random.between(-0.2, 0.2)}};
        const TraceResult all = tracer.trace(ray);
        if (all.status != TraceStatus::hit || all.t == 0) continue;
        EXPECT_EQ(tracer.trace(ray, all.t).t, all.t);
        EXPECT_EQ(tracer.trace(ray, 0.999f * all.t).status, TraceStatus::miss) << all.t;
        ++cut;
    }
    EXPECT_GT(cut, 2000);
}

TEST(HangingTracer, refusesOtherCells) {
    const city::Heightfield solid(4, 4, 1, {0, 0}), other(4, 4, 1, {1, 0});
    city::Overhang hanging{other, other};
    hanging.underside.set(0, 0, 2);
    hanging.top.set(0, 0, 3);
    EXPECT_THROW(GridTracer(solid, hanging), std::invalid_argument);
}

/// Who stands under a crown sees out below it, and has it overhead.
TEST(HangingTracer, underACrownTheStreetIsOpen) {
    Wood wood = [] {
        SeededRandom random(1);
        return Wood(random);
    }();
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            wood.solid.set(i, j, i > 20 ? 8.0f : 0.0f);
            const bool crown = i >= 8 && i < 16 && j >= 8 && j < 16;
            wood.hanging.underside.set(i, j, crown ? 3 : -infinity);
            wood.hanging.top.set(i, j, crown ? 8 : -infinity);
        }
    const GridTracer tracer(wood.solid, wood.hanging);
    EXPECT_EQ(tracer.trace({{0, 0, 1}, {1, 0, 0}}).t, 9) << "the house across the street";
    EXPECT_EQ(tracer.trace({{0, 0, 1}, {0, 0, 1}}).t, 2) << "the leaves overhead";
    EXPECT_EQ(tracer.trace({{-10, 0, 9}, {1, 0, -0.25f}}).t, 6) << "the crown's side from above the street";
    EXPECT_EQ(tracer.trace({{-10, 0, 5}, {1, 0, 0}}).t, 6) << "its side, level";
    EXPECT_TRUE(tracer.occluded({0, 0, 1}, {0, 0, 6}));
    EXPECT_FALSE(tracer.occluded({-10, 0, 1}, {8, 0, 1}));
    EXPECT_EQ(tracer.trace({{0, 0, 1}, {std::nanf(""), 0, 1}}).status, TraceStatus::invalid);
}

}  // namespace
}  // namespace reflection
