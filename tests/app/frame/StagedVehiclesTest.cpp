#include "app/frame/StagedVehicles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "app/frame/StandingReflectors.h"

namespace app {
namespace {

constexpr double pi = std::numbers::pi;

StagedVehicle onPath(std::vector<glm::dvec3> path, double speed) {
    StagedVehicle v;
    v.path = std::move(path);
    v.speed = speed;
    return v;
}

TEST(StagedVehicles, StandWhereTheyAreAtAnyTime) {
    StagedVehicle parked;
    parked.path = {{3, 4, 0.1}};
    parked.heading = 0.7;
    parked.model = 5;
    for (const double time : {0.0, 7.3, 1e6, -2.0}) {
        const auto poses = stagedPoses(std::span(&parked, 1), time);
        ASSERT_EQ(poses.size(), 1u);
        EXPECT_EQ(poses[0].position, glm::dvec3(3, 4, 0.1));
        EXPECT_EQ(poses[0].heading, 0.7);
        EXPECT_EQ(poses[0].speed, 0);
        EXPECT_EQ(poses[0].model, 5u);
        EXPECT_FALSE(stands(poses[0]));  // a vehicle with a shadow, no reflector of the city's
    }
}

TEST(StagedVehicles, GoTheirWayAtTheirSpeedAndThenAnew) {
    StagedVehicle v = onPath({{0, 0, 0}, {30, 0, 0}, {30, 40, 0}}, 5);
    v.since = 15;
    const auto at = [&](double time) { return stagedPoses(std::span(&v, 1), time).at(0); };
    EXPECT_EQ(at(0).position, glm::dvec3(0));  // not yet
    EXPECT_NEAR(glm::distance(at(17).position, {10, 0, 0}), 0, 1e-9);
    EXPECT_NEAR(at(17).heading, 0, 1e-9);
    EXPECT_NEAR(glm::distance(at(25).position, {30, 20, 0}), 0, 1e-9);
    EXPECT_NEAR(at(25).heading, pi / 2, 1e-9);
    EXPECT_NEAR(glm::distance(at(30).position, {5, 0, 0}), 0, 1e-9);  // 75 m on a path of 70
    // The wheels roll what is driven.
    const double before = static_cast<double>(at(17).wheelAngle),
                 after = static_cast<double>(at(17.01).wheelAngle);
    EXPECT_NEAR(std::remainder(after - before, 2 * pi), 0.05 / 0.32, 1e-4);
}

TEST(StagedVehicles, TurnEvenlyAtCorners) {
    const StagedVehicle v = onPath({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, 1);
    double before = 0;
    for (double time = 5; time < 15; time += 0.02) {
        const double heading = stagedPoses(std::span(&v, 1), time).at(0).heading;
        EXPECT_GE(heading, before - 1e-9);
        EXPECT_LT(heading - before, 0.05);  // two metres of turning in a hundred steps
        before = heading;
    }
    EXPECT_NEAR(before, pi / 2, 1e-9);
}

TEST(StagedVehicles, DegeneratePathsStandOrAreLeftOut) {
    const StagedVehicle all[]{onPath({}, 3), onPath({{1, 2, 3}, {1, 2, 3}}, 3),
                              onPath({{0, 0, 0}, {9, 0, 0}}, 0), onPath({{0, 0, 0}, {0, 0, 5}}, 1)};
    const auto poses = stagedPoses(all, 1);
    ASSERT_EQ(poses.size(), 3u);
    EXPECT_EQ(poses[0].position, glm::dvec3(1, 2, 3));
    EXPECT_EQ(poses[1].position, glm::dvec3(0));
    for (const auto& p : poses)
        EXPECT_TRUE(std::isfinite(p.heading + p.pitch + p.position.x + p.position.y + p.position.z +
                                  static_cast<double>(p.wheelAngle)));
}

}  // namespace
}  // namespace app
