#include "app/frame/CameraRig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "app/frame/ShotPlan.h"

namespace app {
namespace {

const city::Aabb bounds{{-100, -100, 0}, {100, 100, 30}};
const std::vector<city::TourStop> threeStops{
    {{0, 0, 2}, {10, 0, 2}, 5}, {{20, 0, 2}, {30, 0, 2}, 9}, {{20, 20, 4}, {20, 40, 4}, 15}};

vehicles::VehiclePose car(std::uint32_t id, double x, double y, double heading = 0, float speed = 10) {
    vehicles::VehiclePose pose;
    pose.id = id;
    pose.position = {x, y, 0};
    pose.heading = heading;
    pose.speed = speed;
    return pose;
}

CameraInput input(glm::dvec3 move, glm::dvec2 look = {0, 0}, double wheel = 0, bool fast = false) {
    return {move, look, wheel, fast};
}

TEST(CameraRigTest, theTourPassesItsStopsAtTheirTimesAndBeginsAnew) {
    CameraRig rig(threeStops, bounds);
    ASSERT_TRUE(rig.hasTour());
    for (const auto& [time, stop] :
         {std::pair(0.0, 0u), std::pair(4.0, 1u), std::pair(10.0, 0u), std::pair(14.0, 1u)}) {
        const CameraPose pose = rig.tourPose(time);
        EXPECT_LT(glm::distance(pose.eye, glm::dvec3(threeStops[stop].eye)), 1e-9) << time;
        EXPECT_LT(glm::distance(pose.target, glm::dvec3(threeStops[stop].target)), 1e-9) << time;
    }
    EXPECT_LT(glm::distance(rig.tourPose(10 - 1e-9).eye, glm::dvec3(20, 20, 4)), 1e-6);
}

TEST(CameraRigTest, theTourDoesNotJumpBetweenItsEnds) {
    CameraRig rig(threeStops, bounds);
    for (double t = 0; t + 0.01 < 10; t += 0.01)
        EXPECT_LT(glm::distance(rig.tourPose(t).eye, rig.tourPose(t + 0.01).eye), 0.15)
            << t;  // 20 m in 4 s, doubled for the curve
}

TEST(CameraRigTest, stopsThatDoNotAdvanceInTimeAreLeftOut) {
    std::vector<city::TourStop> stops = threeStops;
    stops[1].time = 5;
    const CameraRig rig(stops, bounds);
    EXPECT_TRUE(rig.hasTour());
    EXPECT_TRUE(std::isfinite(rig.tourPose(0).eye.x));
    EXPECT_FALSE(CameraRig(std::vector<city::TourStop>{threeStops[0]}, bounds).hasTour());
}

TEST(CameraRigTest, withoutTourVehiclesOrCityItStillHasAView) {
    CameraRig rig({}, city::Aabb{});
    rig.update(1, {}, {});
    EXPECT_GT(glm::distance(rig.pose().eye, rig.pose().target), 1);
    EXPECT_FALSE(rig.followed());
    rig.setMode(CameraMode::follow, {});
    rig.update(1, {}, {});
    rig.followNext({}, 1);
    EXPECT_TRUE(std::isfinite(rig.pose().eye.x));
}

TEST(CameraRigTest, followingKeepsItsDistanceAndTurnsWithTheVehicleLate) {
    CameraRig rig({}, bounds);
    std::vector<vehicles::VehiclePose> cars{car(7, 0, 0)};
    rig.setMode(CameraMode::follow, cars);
    rig.update(0, cars, {});
    ASSERT_EQ(rig.followed(), 7u);
    const double distance = glm::distance(rig.pose().eye, rig.pose().target);
    const glm::dvec3 offset = rig.pose().eye - cars[0].position;
    EXPECT_LT(offset.x, 0);  // behind a car that looks east
    cars[0].position = {50, 20, 0};
    cars[0].heading = std::numbers::pi / 2;
    rig.update(0.1, cars, {});
    EXPECT_NEAR(glm::distance(rig.pose().eye, rig.pose().target), distance, 1e-9);
    const glm::dvec3 late = rig.pose().eye - cars[0].position;
    EXPECT_GT(glm::dot(glm::normalize(late), glm::normalize(offset)), 0.95);
    for (int i = 0; i < 100; ++i) rig.update(0.1, cars, {});
    const glm::dvec3 turned = rig.pose().eye - cars[0].position;
    EXPECT_NEAR(turned.x, -offset.y, 1e-3);
    EXPECT_NEAR(turned.y, offset.x, 1e-3);
}

TEST(CameraRigTest, aTurnThroughSouthTakesTheShortWay) {
    CameraRig rig({}, bounds);
    std::vector<vehicles::VehiclePose> cars{car(1, 0, 0, std::numbers::pi - 0.1)};
    rig.setMode(CameraMode::follow, cars);
    rig.update(0, cars, {});
    const glm::dvec3 before = rig.pose().eye;
    cars[0].heading = -std::numbers::pi + 0.1;
    rig.update(0.3, cars, {});
    EXPECT_LT(glm::distance(before, rig.pose().eye), 1.5);  // 0.2 rad at 7 m
}

TEST(CameraRigTest, whenTheVehicleLeavesTheNearestOneIsFollowed) {
    CameraRig rig({}, bounds);
    std::vector<vehicles::VehiclePose> cars{car(1, 0, 0), car(2, 10, 0), car(3, 90, 0)};
    rig.setMode(CameraMode::follow, cars);
    rig.follow(1);
    rig.update(0.1, cars, {});
    cars.erase(cars.begin());
    rig.update(0.1, cars, {});
    EXPECT_EQ(rig.followed(), 2u);
    rig.followNext(cars, 1);
    EXPECT_EQ(rig.followed(), 3u);
    rig.followNext(cars, 1);
    EXPECT_EQ(rig.followed(), 2u);
    rig.followNext(cars, -1);
    EXPECT_EQ(rig.followed(), 3u);
}

TEST(CameraRigTest, flyingStartsWhereTheCameraIsAndGoesWhereItLooks) {
    CameraRig rig(threeStops, bounds);
    rig.update(2, {}, {});
    const CameraPose before = rig.pose();
    rig.setMode(CameraMode::fly, {});
    rig.update(0, {}, {});
    EXPECT_LT(glm::distance(rig.pose().eye, before.eye), 1e-12);
    const glm::dvec3 forward = glm::normalize(before.target - before.eye);
    EXPECT_LT(glm::distance(rig.pose().target - rig.pose().eye, forward), 1e-9);
    rig.update(1, {}, input({0, 1, 0}));
    const glm::dvec3 went = rig.pose().eye - before.eye;
    EXPECT_GT(glm::dot(went, forward), 0.999 * glm::length(went));
    const double plain = glm::length(went);
    const glm::dvec3 from = rig.pose().eye;
    rig.update(1, {}, input({1, 0, 0}, {0, 0}, 0, true));
    const glm::dvec3 side = rig.pose().eye - from;
    EXPECT_NEAR(glm::length(side), 4 * plain, 1e-9);
    EXPECT_GT(glm::dot(side, glm::cross(forward, glm::dvec3(0, 0, 1))), 0);
    const glm::dvec3 below = rig.pose().eye;
    rig.update(1, {}, input({0, 0, 1}));
    EXPECT_GT(rig.pose().eye.z, below.z + 1);
}

TEST(CameraRigTest, flyingStaysAboveTheGround) {
    CameraRig rig(threeStops, bounds);
    rig.setMode(CameraMode::fly, {});
    rig.update(0, {}, input({0, 0, 0}, {0, -1}));
    for (int i = 0; i < 50; ++i) {
        rig.update(0.1, {}, input({0, i % 2 ? 1.0 : 0.0, -1}));
        ASSERT_GT(rig.pose().eye.z, bounds.min.z);
    }
    EXPECT_LT(rig.pose().eye.z, bounds.min.z + 1);
    EXPECT_NEAR(glm::distance(rig.pose().eye, rig.pose().target), 1, 1e-9) << "it looks where it looked";
    rig.update(1, {}, input({0, 0, 1}));
    EXPECT_GT(rig.pose().eye.z, bounds.min.z + 5);
}

TEST(CameraRigTest, lookingStopsShortOfTheZenith) {
    CameraRig rig(threeStops, bounds);
    rig.setMode(CameraMode::fly, {});
    for (int i = 0; i < 100; ++i) rig.update(0.1, {}, input({0, 0, 0}, {0.3, 0.5}));
    const glm::dvec3 forward = rig.pose().target - rig.pose().eye;
    EXPECT_GT(forward.z, 0.99);
    EXPECT_GT(std::hypot(forward.x, forward.y), 0.05);
}

TEST(CameraRigTest, theWheelZoomsWithinLimits) {
    CameraRig rig({}, bounds);
    const std::vector<vehicles::VehiclePose> cars{car(1, 0, 0)};
    rig.setMode(CameraMode::follow, cars);
    for (int i = 0; i < 100; ++i) rig.update(0.1, cars, input({0, 0, 0}, {0, 0}, 3));
    EXPECT_NEAR(glm::distance(rig.pose().eye, rig.pose().target), 2.5, 1e-9);
    for (int i = 0; i < 100; ++i) rig.update(0.1, cars, input({0, 0, 0}, {0, 0}, -3));
    EXPECT_NEAR(glm::distance(rig.pose().eye, rig.pose().target), 150, 1e-9);
}

TEST(CameraRigTest, oddTimesMoveNothing) {
    CameraRig rig(threeStops, bounds);
    rig.update(1, {}, {});
    const glm::dvec3 eye = rig.pose().eye;
    for (const double t : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()})
        rig.update(t, {}, {});
    EXPECT_EQ(rig.pose().eye, eye);
}

TEST(ShotPlanTest, alternatesBetweenAMovingCarAndTheTour) {
    std::vector<vehicles::VehicleKind> kinds(2);
    kinds[1].length = 12;
    std::vector<vehicles::VehiclePose> cars{car(0, 1, 0, 0, 0), car(1, 2, 0), car(2, 60, 0), car(3, 500, 0)};
    cars[1].model = 1;  // a bus, near and moving
    CameraRig rig(threeStops, bounds);
    ShotPlan shots(std::nullopt, kinds);
    shots.direct(0, cars, rig);
    EXPECT_EQ(rig.mode(), CameraMode::follow);
    EXPECT_EQ(rig.followed(), 2u);
    shots.direct(4.9, cars, rig);
    EXPECT_EQ(rig.mode(), CameraMode::follow);
    shots.direct(5.0, cars, rig);
    EXPECT_EQ(rig.mode(), CameraMode::tour);
    shots.direct(10.1, cars, rig);
    EXPECT_EQ(rig.mode(), CameraMode::follow);
    EXPECT_EQ(rig.followed(), 3u);
}

TEST(ShotPlanTest, aModeThatWasAskedForIsNotCut) {
    const std::vector<vehicles::VehiclePose> cars{car(1, 0, 0), car(2, 5, 0)};
    for (const CameraMode mode : {CameraMode::tour, CameraMode::follow}) {
        CameraRig rig(threeStops, bounds);
        ShotPlan shots(mode, std::vector<vehicles::VehicleKind>(1));
        shots.direct(0, cars, rig);
        const auto followed = rig.followed();
        for (double t = 0; t < 30; t += 1) {
            shots.direct(t, cars, rig);
            EXPECT_EQ(rig.mode(), mode);
            EXPECT_EQ(rig.followed(), followed);
        }
    }
}

}  // namespace
}  // namespace app
