#include "app/commands/FacingFronts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

namespace app {
namespace {

/// A shop front from a to b on the ground, seen from the right of that way, 1 to 4 m high.
city::GlassFront front(glm::dvec2 a, glm::dvec2 b, city::Pattern pattern = city::Pattern::shopFront,
                       double low = 1) {
    city::GlassFront made;
    const glm::dvec2 along = glm::normalize(b - a);
    made.normal = {along.y, -along.x, 0};
    made.outline = {glm::dvec3(a, low), glm::dvec3(b, low), glm::dvec3(b, low + 3), glm::dvec3(a, low + 3)};
    made.pattern = pattern;
    return made;
}

TEST(FacingFrontsTest, TwoAcrossAStreetFaceEachOtherOverWhatOverlaps) {
    // The first looks south, the second, 12 m south of it, looks north and begins 4 m further east.
    const std::vector<city::GlassFront> fronts{front({0, 0}, {10, 0}), front({16, -12}, {4, -12})};
    const auto pairs = facingFronts(fronts);
    ASSERT_EQ(pairs.size(), 2u);
    for (const FacingFronts& pair : pairs) {
        EXPECT_NE(pair.one, pair.other);
        EXPECT_NEAR(pair.across, 12, 1e-12);
        EXPECT_NEAR(pair.to - pair.from, 6, 1e-12);
        // 4 to 10 m of the first are 6 to 12 m of the second, which runs the other way.
        EXPECT_NEAR(pair.from, pair.one == 0 ? 4 : 6, 1e-12);
    }
}

TEST(FacingFrontsTest, WhatDoesNotFaceIsPassedOver) {
    const city::GlassFront one = front({0, 0}, {10, 0});
    const auto count = [&](const city::GlassFront& other) {
        return facingFronts(std::vector<city::GlassFront>{one, other}).size();
    };
    EXPECT_EQ(count(front({10, -12}, {0, -12})), 2u);
    EXPECT_EQ(count(front({0, -12}, {10, -12})), 0u) << "looks the same way";
    EXPECT_EQ(count(front({10, 12}, {0, 12})), 0u) << "back to back";
    EXPECT_EQ(count(front({10, -7}, {0, -7})), 0u) << "too near";
    EXPECT_EQ(count(front({10, -31}, {0, -31})), 0u) << "too far";
    EXPECT_EQ(count(front({17, -12}, {7, -12})), 0u) << "three metres of overlap";
    EXPECT_EQ(count(front({10, -12}, {10, -2})), 0u) << "round the corner";
    EXPECT_EQ(count(front({10, -12}, {0, -12}, city::Pattern::facadeGlass)), 0u) << "no shop";
    EXPECT_EQ(count(front({10, -12}, {0, -12}, city::Pattern::shopFront, 5)), 0u) << "a storey higher";
    EXPECT_EQ(count(front({10, -12}, {0, -11})), 2u) << "nearly parallel";
    EXPECT_EQ(count(front({10, -14}, {0, -10})), 0u) << "22 degrees off";
    city::GlassFront none = one;
    none.outline.fill(glm::dvec3(0));
    EXPECT_EQ(count(none), 0u);
    none.outline.fill(glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
    EXPECT_EQ(count(none), 0u);
}

TEST(FacingFrontsTest, ThoseThatFaceEachOtherMostComeFirst) {
    const std::vector<city::GlassFront> fronts{front({0, 0}, {10, 0}), front({10, -25}, {0, -25}),
                                               front({100, 0}, {110, 0}), front({110, -10}, {100, -10})};
    const auto pairs = facingFronts(fronts);
    ASSERT_EQ(pairs.size(), 4u);
    EXPECT_EQ(pairs[0].one, 2u);
    EXPECT_EQ(pairs[1].one, 3u);
    EXPECT_EQ(pairs[2].one, 0u);
}

TEST(FacingFrontsTest, MirroredRaysGoWhereTheImageLies) {
    // The oracle: a ray towards the image of a place behind the glass arrives at the place itself.
    std::mt19937_64 random(7);
    const auto draw = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        const double turn = draw(0, 6.28);
        const glm::dvec2 along(std::cos(turn), std::sin(turn)), a(draw(-500, 500), draw(-500, 500));
        const city::GlassFront glass = front(a, a + draw(4, 20) * along);
        const auto place = [&] {
            return glass.outline[0] + draw(-5, 25) * glm::dvec3(along, 0) + draw(0.5, 20) * glass.normal +
                   glm::dvec3(0, 0, draw(-1, 4));
        };
        const glm::dvec3 eye = place(), seen = place();
        const glm::dvec3 image = seen - 2 * glm::dot(seen - glass.outline[0], glass.normal) * glass.normal;
        const auto hit = meetFront(glass, eye, image - eye);
        const double s = glm::dot(eye - glass.outline[0], glass.normal) / glm::dot(eye - image, glass.normal);
        const glm::dvec3 at = eye + s * (image - eye);
        const double alongAt = glm::dot(at - glass.outline[0], glm::dvec3(along, 0));
        const bool within = alongAt >= 0 && alongAt <= glm::length(glass.outline[1] - glass.outline[0]) &&
                            at.z >= 1 && at.z <= 4;
        ASSERT_EQ(hit.has_value(), within) << i;
        if (!hit) continue;
        ++met;
        EXPECT_NEAR(hit->way, s, 1e-9);
        EXPECT_NEAR(hit->along, alongAt, 1e-9);
        EXPECT_NEAR(hit->up, at.z - 1, 1e-9);
        EXPECT_LT(glm::length(hit->at + (1 - hit->way) * hit->mirror - seen), 1e-9) << i;
        EXPECT_NEAR(glm::length(hit->mirror), glm::length(image - eye), 1e-9);
    }
    EXPECT_GT(met, 200);
}

TEST(FacingFrontsTest, RaysThatCannotMeetTheGlassGiveNothing) {
    const city::GlassFront glass = front({0, 0}, {10, 0});
    EXPECT_TRUE(meetFront(glass, {5, -3, 2}, {0, 1, 0}));
    EXPECT_FALSE(meetFront(glass, {5, -3, 2}, {0, -1, 0})) << "away";
    EXPECT_FALSE(meetFront(glass, {5, 3, 2}, {0, -1, 0})) << "from behind";
    EXPECT_FALSE(meetFront(glass, {5, -3, 2}, {1, 0, 0})) << "along";
    EXPECT_FALSE(meetFront(glass, {5, 0, 2}, {0, 1, 0})) << "from within the plane";
    EXPECT_FALSE(meetFront(glass, {5, -3, 2}, {0, 0, 0}));
    const double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(meetFront(glass, {5, -3, 2}, {none, 1, 0}));
    EXPECT_FALSE(meetFront(glass, {5, -3, none}, {0, 1, 0}));
    EXPECT_FALSE(meetFront(glass, {5, -3, 2}, {0, std::numeric_limits<double>::infinity(), 0}));
}

TEST(FacingFrontsTest, FresnelGoesFromStraightToAll) {
    EXPECT_DOUBLE_EQ(schlick(0.08, 1), 0.08);
    EXPECT_DOUBLE_EQ(schlick(0.08, 0), 1);
    EXPECT_NEAR(schlick(0.04, 0.5), 0.07, 1e-12);
}

}  // namespace
}  // namespace app
