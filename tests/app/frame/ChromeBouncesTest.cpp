// Which chrome seen in chrome has a picture of what it mirrors.
#include "app/frame/ChromeBounces.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <memory>

#include "app/frame/StandingReflectors.h"

namespace app {
namespace {

/// Spheres of a metre in radius beside each other along y, seen from +x.
struct Balls {
    city::CityModel city;
    std::vector<vehicles::VehicleModel> models;
    std::unique_ptr<CloseScene> scene;
    FrameScene frame;
    ChromeBounceOptions options;

    explicit Balls(std::initializer_list<float> places, double eyeDistance = 5) {
        for (const float y : places)
            city.reflectors.push_back({"ball",
                                       city::StandingReflector::Shape::sphere,
                                       city::StandingReflector::Stuff::chrome,
                                       {0, y, 0},
                                       1,
                                       2});
        models = standingModels(city);
        scene = std::make_unique<CloseScene>(city, models);
        frame.vehicles = standingPoses(city, 0);
        frame.views = {lookAt({eyeDistance, 0, 1}, {0, 0, 1}, 1, {1280, 720})};
    }
    ChromePlan jobs() const {
        std::vector<std::uint32_t> seen;
        for (std::uint32_t i = 0; i < frame.vehicles.size(); ++i) seen.push_back(i);
        return planChrome(frame, seen, models, scene->parts, {});
    }
    ChromeBounces plan() const {
        const View& view = frame.views.front();
        reflection::EyeView eye;
        eye.eye = view.eye;
        eye.viewFromWorld = glm::dmat3(view.viewFromWorld);
        eye.clipFromView = glm::dmat4(view.clipFromView);
        return ChromeBouncePlanner(*scene).plan(jobs(), 0, eye, view.size, frame.vehicles, options);
    }
};

TEST(ChromeBounces, OneAloneOrTooFarFromOthersHasNoPictureAndAsksForNoReflector) {
    for (const Balls& balls : {Balls({0}), Balls({0, 80})}) {
        const ChromeBounces plan = balls.plan();
        EXPECT_TRUE(plan.pictures.empty());
        EXPECT_EQ(plan.tooSmall, plan.parts);
        EXPECT_EQ(balls.scene->parts.reflectorsMade(), 0u);
    }
    // Large enough in a plane mirror, and so asked for; too small in a ball.
    const ChromeBounces small = Balls({-0.5f, 11}).plan();
    EXPECT_TRUE(small.pictures.empty());
    EXPECT_GT(small.tooSmall, 0u);
}

TEST(ChromeBounces, TwoThatSeeEachOtherHaveAPictureEach) {
    const Balls balls({-1.5f, 1.5f});
    ASSERT_EQ(balls.jobs().jobs.size(), 2u);
    const ChromeBounces plan = balls.plan();
    ASSERT_EQ(plan.pictures.size(), 2u);
    EXPECT_EQ(plan.parts, 2u);
    EXPECT_EQ(plan.overCap + plan.tooBent + plan.tooNear + plan.tooSmall, 0u);
    const ChromePlan jobs = balls.jobs();
    for (const ChromeBounce& b : plan.pictures) {
        const glm::dvec3 in(jobs.jobs[b.in].worldFromPart[3]), of(b.of.worldFromPart[3]);
        EXPECT_NE(jobs.jobs[b.in].vehicle, b.of.vehicle);
        ASSERT_EQ(b.of.close.size(), 1u);
        EXPECT_EQ(b.of.close[0], jobs.jobs[b.in].vehicle);
        // The eye stands in the ball that shows the other, which looks at it.
        EXPECT_LT(glm::distance(b.view.eye, in), 1);
        EXPECT_GT(glm::distance(b.view.eye, of), 2);
        EXPECT_GT(b.view.clip(of).w, 0);
        EXPECT_GT(b.of.share, 0);
        EXPECT_GT(b.size.x, b.pixels * 0.9);
    }
    EXPECT_NE(plan.pictures[0].in, plan.pictures[1].in);
}

TEST(ChromeBounces, WhatStandsBehindTheOtherIsNotSeenInIt) {
    // The far one of two in a row shows the near one; that one has its back to it.
    Balls balls({0, 0});
    balls.frame.vehicles[1].position.x -= 4;
    const ChromeBounces plan = balls.plan();
    const ChromePlan jobs = balls.jobs();
    for (const ChromeBounce& b : plan.pictures) EXPECT_EQ(jobs.jobs[b.in].vehicle, 1u);
    EXPECT_GE(plan.unseen, 1u);
}

TEST(ChromeBounces, TheSmallestAreLeftOut) {
    Balls balls({-2.4f, 0, 2.4f});
    const ChromeBounces all = balls.plan();
    ASSERT_GE(all.pictures.size(), 4u);
    for (std::size_t i = 1; i < all.pictures.size(); ++i)
        EXPECT_GE(all.pictures[i - 1].pixels, all.pictures[i].pixels);
    balls.options.mostPictures = 1;
    const ChromeBounces one = balls.plan();
    ASSERT_EQ(one.pictures.size(), 1u);
    EXPECT_EQ(one.overCap + 1, all.pictures.size() + all.overCap);
    EXPECT_EQ(one.pictures[0].pixels, all.pictures[0].pixels);
}

TEST(ChromeBounces, SharesGrowFromNothingAsTheEyeComesNear) {
    Balls balls({-1.5f, 1.5f});
    float before = 0;
    for (double distance = 80; distance > 5; distance *= 0.98) {
        balls.frame.views = {lookAt({distance, 0, 1}, {0, 0, 1}, 1, {1280, 720})};
        float most = 0;
        for (const ChromeBounce& b : balls.plan().pictures) most = std::max(most, b.of.share);
        EXPECT_LT(std::abs(most - before), 0.1f) << distance;
        before = most;
    }
    EXPECT_EQ(before, 1);
}

TEST(ChromeBounces, PicturesComeAndGoByStepsInWhatWasThereBefore) {
    Balls balls({-1.5f, 1.5f});
    ChromeBounceFades fades;
    const auto shares = [&](bool planned) {
        const ChromePlan jobs = balls.jobs();
        ChromeBounces plan = planned ? balls.plan() : ChromeBounces{};
        fades.follow(plan, jobs, 0, balls.frame.vehicles, *balls.scene);
        float most = 0;
        for (const ChromeBounce& b : plan.pictures) {
            most = std::max(most, b.of.share);
            EXPECT_LT(b.in, jobs.jobs.size());
            EXPECT_LT(b.of.vehicle, balls.frame.vehicles.size());
        }
        return most;
    };
    // In what comes into sight all is there.
    float before = shares(true);
    EXPECT_EQ(before, 1);
    int frames = 0;
    for (; before > 1e-5f && frames < 100; ++frames) {
        // What is shown goes with its part.
        for (vehicles::VehiclePose& pose : balls.frame.vehicles) pose.position.x += 0.01;
        const float now = shares(false);
        EXPECT_NEAR(now, before - ChromeFades::step, 1e-5) << frames;
        before = now;
    }
    EXPECT_EQ(frames, 12);
    for (int k = 0; k < 12; ++k) {
        const float now = shares(true);
        EXPECT_NEAR(now, before + ChromeFades::step, 1e-5) << k;
        before = now;
    }
    EXPECT_EQ(shares(true), 1);
    // Nothing is left of a part that is gone.
    balls.frame.vehicles.pop_back();
    EXPECT_EQ(shares(false), 0);
}

}  // namespace
}  // namespace app
