// Which chrome shows close things itself, and the reflectors that it is made of.
#include "app/frame/ChromePlan.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "app/frame/CloseImages.h"
#include "app/frame/CloseScene.h"
#include "app/frame/StandingReflectors.h"
#include "city/model/CityModel.h"
#include "reflection/chrome/ReflectionSearch.h"
#include "vehicles/models/Bodies.h"

namespace app {
namespace {

/// A chrome sphere of a metre in radius that rests on the origin, and a box of paint with a chrome button.
struct World {
    city::CityModel city;
    std::vector<vehicles::VehicleModel> models;
    ChromeParts parts;
    FrameScene scene;
    std::vector<std::uint32_t> seen;

    explicit World(double eyeDistance, int cars = 1) {
        city.reflectors.push_back({"sphere", city::StandingReflector::Shape::sphere,
                                   city::StandingReflector::Stuff::chrome, glm::vec3(0), 1, 2});
        vehicles::VehicleModel car;
        car.length = 4;
        car.width = 2;
        car.height = 1.5f;
        car.levels.emplace_back().body = button({2, 0, 0.7f});
        models = {car, standingModels(city).front()};
        parts = ChromeParts(models);
        scene.vehicles = standingPoses(city, 1);
        for (int i = 0; i < cars; ++i) {
            vehicles::VehiclePose& pose = scene.vehicles.emplace_back();
            pose.id = static_cast<std::uint32_t>(i);
            pose.position = {0, 2.5 + 3 * i, 0};
        }
        for (std::uint32_t i = 0; i < scene.vehicles.size(); ++i) seen.push_back(i);
        lookFrom(eyeDistance);
    }

    void lookFrom(double distance) { scene.views = {lookAt({distance, 0, 1}, {0, 0, 1}, 1, {1280, 720})}; }
    ChromePlan plan(ChromePlanOptions options = {}) const {
        options.vehicles = options.openParts = true;
        return planChrome(scene, seen, models, parts, options);
    }

    /// Half a ball of 10 cm, its back open, towards +x.
    static city::Mesh button(const glm::vec3& centre) {
        city::Mesh mesh;
        constexpr int n = 12;
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                const double a = 1.4 * i / n, b = M_PI * j / n;
                const glm::vec3 d(std::cos(a), std::sin(a) * std::cos(b), std::sin(a) * std::sin(b));
                mesh.vertices.push_back(
                    {centre + 0.1f * d, d, {}, static_cast<std::uint32_t>(vehicles::Surface::chrome)});
            }
        const auto at = [](int i, int j) { return static_cast<std::uint32_t>(i * 2 * n + j % (2 * n)); };
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j)
                mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j),
                                                         at(i + 1, j + 1), at(i, j + 1)});
        return mesh;
    }
};

TEST(ChromePlan, NoChromeOrNoneSeenMeansNoJobs) {
    World world(5);
    EXPECT_EQ(world.plan().jobs.size(), 2u);
    ChromePlanOptions off;
    off.on = false;
    EXPECT_TRUE(world.plan(off).empty());
    world.seen.clear();
    const ChromePlan unseen = world.plan();
    EXPECT_TRUE(unseen.empty());
    EXPECT_EQ(unseen.parts, 0u);
    World plain(4);
    for (vehicles::VehicleModel& model : plain.models)
        for (vehicles::VehicleModel::Level& level : model.levels)
            for (city::Vertex& v : level.body.vertices) v.material = 0;
    plain.parts = ChromeParts(plain.models);
    EXPECT_TRUE(plain.parts.empty());
    EXPECT_TRUE(plain.plan().empty());
    EXPECT_EQ(plain.parts.reflectorsMade(), 0u);
}

TEST(ChromePlan, PartsThatAreSmallOrOutOfSightHaveNone) {
    World world(4);
    world.lookFrom(300);
    ChromePlan plan = world.plan();
    EXPECT_TRUE(plan.empty());
    EXPECT_EQ(plan.tooSmall, 2u);
    // From behind, the button is on the car's far side, and the sphere's job alone is left.
    world.lookFrom(-4);
    plan = world.plan();
    ASSERT_EQ(plan.jobs.size(), 1u);
    EXPECT_EQ(plan.jobs[0].vehicle, 0u);
    EXPECT_EQ(plan.outOfSight, 1u);
    // Away from both.
    world.scene.views = {lookAt({4, 0, 1}, {8, 0, 1}, 1, {1280, 720})};
    EXPECT_TRUE(world.plan().empty());
}

TEST(ChromePlan, NothingWithinReachMeansNoJob) {
    // A ball that hovers: the ground is as far as its foot, and it has no other neighbour.
    for (const double height : {0.0, 30.0}) {
        World world(4, 0);
        for (city::Vertex& v : world.models[1].levels.front().body.vertices)
            v.position.z += static_cast<float>(height);
        world.models[1].reflectionCentre += 0.5f * static_cast<float>(height);
        world.parts = ChromeParts(world.models);
        world.scene.views = {lookAt({4, 0, 1 + height}, {0, 0, 1 + height}, 1, {1280, 720})};
        const ChromePlan plan = world.plan();
        EXPECT_EQ(plan.jobs.size(), height > 0 ? 0u : 1u);
        EXPECT_EQ(plan.nothingClose, height > 0 ? 1u : 0u);
    }
}

TEST(ChromePlan, PartsOfVehiclesAndOnesWithARimAreAskedForApart) {
    const World world(5);
    ChromePlanOptions alone;
    alone.vehicles = false;
    const ChromePlan standing = planChrome(world.scene, world.seen, world.models, world.parts, alone);
    ASSERT_EQ(standing.jobs.size(), 1u);
    EXPECT_EQ(standing.jobs[0].vehicle, 0u);
    EXPECT_EQ(standing.parts, 1u);
    const ChromePlan all = planChrome(world.scene, world.seen, world.models, world.parts, {});
    EXPECT_EQ(all.jobs.size(), 1u);
    EXPECT_EQ(all.open, 1u);
}

TEST(ChromePlan, NamesTheCloseVehiclesAndNotItself) {
    const World world(4, 8);
    const ChromePlan plan = world.plan();
    for (const ChromeJob& job : plan.jobs) {
        for (const std::uint32_t index : job.close) {
            EXPECT_NE(index, job.vehicle);
            EXPECT_LT(glm::length(world.scene.vehicles[index].position - glm::dvec3(job.worldFromPart[3])),
                      job.reach + 3);
        }
        if (job.vehicle == 0) {
            EXPECT_GE(job.close.size(), 3u);
        }
    }
}

TEST(ChromePlan, TheLeastVisibleAreLeftOut) {
    const World world(5, 1);
    const ChromePlan all = world.plan();
    ASSERT_EQ(all.jobs.size(), 2u);
    ChromePlanOptions one;
    one.mostJobs = 1;
    const ChromePlan capped = world.plan(one);
    ASSERT_EQ(capped.jobs.size(), 1u);
    EXPECT_EQ(capped.jobs.size() + capped.leftOut, all.jobs.size());
    EXPECT_EQ(capped.jobs[0].vehicle, all.jobs[0].vehicle);
    for (std::size_t i = 1; i < all.jobs.size(); ++i) EXPECT_GE(all.jobs[i - 1].pixels, all.jobs[i].pixels);
}

TEST(ChromePlan, SharesGrowFromNothingWithoutAJumpAsTheEyeComesNear) {
    for (const std::uint32_t most : {8u, 1u}) {
        World world(1, 5);
        ChromePlanOptions options;
        options.mostJobs = most;
        std::vector<float> before(world.scene.vehicles.size(), 0);
        float largest = 0, step = 0;
        for (double distance = 200; distance > 2.5; distance *= 0.998) {
            world.lookFrom(distance);
            std::vector<float> now(before.size(), 0);
            for (const ChromeJob& job : world.plan(options).jobs) now[job.vehicle] = job.share;
            for (std::size_t i = 0; i < now.size(); ++i) {
                // Out of the picture a part may have any share.
                const glm::dvec3 towards = world.scene.vehicles[i].position - world.scene.views[0].eye;
                if (std::abs(towards.y) < 0.3 * std::abs(towards.x))
                    step = std::max(step, std::abs(now[i] - before[i]));
                largest = std::max(largest, now[i]);
            }
            before = now;
        }
        EXPECT_EQ(largest, 1);
        EXPECT_LT(step, 0.05f);
    }
}

TEST(ChromePlan, EveryViewHasItsOwnJobs) {
    World world(5);
    world.scene.views.push_back(lookAt({-4, 0, 1}, {0, 0, 1}, 1, {1280, 720}));
    const ChromePlan plan = world.plan();
    EXPECT_EQ(plan.parts, 4u);
    std::size_t ofView[2] = {0, 0};
    for (const ChromeJob& job : plan.jobs) ++ofView[job.view];
    EXPECT_EQ(ofView[0], 2u);
    EXPECT_EQ(ofView[1], 1u);
}

TEST(ChromePlan, BallsLieWithinTheirPixels) {
    const View view = lookAt({0, 0, 0}, {1, 0, 0}, 1, {640, 480});
    const glm::mat4 clip = view.clipFromView * view.viewFromWorld;
    const reflection::PixelRect all{glm::ivec2(0), view.size};
    EXPECT_EQ(pixelsOfBall(clip, view.size, glm::vec3(0.5f, 0, 0), 1), all);
    EXPECT_TRUE(pixelsOfBall(clip, view.size, glm::vec3(-5, 0, 0), 1).empty());
    EXPECT_TRUE(pixelsOfBall(clip, view.size, glm::vec3(5, 30, 0), 1).empty());
    const reflection::PixelRect pixels = pixelsOfBall(clip, view.size, glm::vec3(5, 0.5f, -0.3f), 0.5f);
    for (int i = 0; i < 200; ++i) {
        const float a = 0.1f * static_cast<float>(i), b = 0.037f * static_cast<float>(i);
        const glm::vec3 on =
            glm::vec3(5, 0.5f, -0.3f) +
            0.5f * glm::vec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
        const glm::vec4 c = clip * glm::vec4(on, 1);
        const glm::vec2 p = (glm::vec2(c) / c.w * 0.5f + 0.5f) * glm::vec2(view.size);
        EXPECT_TRUE(p.x >= static_cast<float>(pixels.low.x) && p.x <= static_cast<float>(pixels.high.x));
        EXPECT_TRUE(p.y >= static_cast<float>(pixels.low.y) && p.y <= static_cast<float>(pixels.high.y));
    }
    EXPECT_LT(pixels.area(), all.area() / 8);
}

TEST(CloseImages, AreNoSmallerThanWhatIsSeenAndHiddenOnlyBehind) {
    const World world(5);
    const ChromePart& part = world.parts.of(1)[0];
    const reflection::ReflectorMap& map = world.parts.reflectorOf(part).pieces[0].built.map;
    const glm::dvec3 eye(5, 0, 0);
    std::uint32_t state = 1;
    const auto random = [&](double low, double high) {
        state = state * 1664525u + 1013904223u;
        return low + (high - low) * (state >> 8) / 16777216.0;
    };
    std::vector<CloseBox> boxes;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 low(random(-6, 4), random(-5, 5), random(-3, 3));
        city::Aabb box;
        box.extend(low);
        box.extend(low + glm::vec3(random(0.1, 2), random(0.1, 2), random(0.1, 2)));
        boxes.push_back({box, glm::dmat4(1)});
    }
    boxes.push_back({{}, glm::dmat4(1)});
    const std::vector<CloseImage> images = closeImages(map, 1, eye, boxes);
    int hidden = 0, known = 0;
    for (std::size_t i = 0; i + 1 < boxes.size(); ++i) {
        const glm::dvec3 low(boxes[i].box.min), high(boxes[i].box.max);
        for (int k = 0; k < 40; ++k) {
            const glm::dvec3 p(random(low.x, high.x), random(low.y, high.y), random(low.z, high.z));
            const std::array<glm::dvec3, 2> both{p,
                                                 p + 1e-3 * glm::dvec3(0, 0, p.z > high.z - 2e-3 ? -1 : 1)};
            std::array<reflection::ReflectionPoint, 2> points;
            reflection::findReflectionPoints(map, eye, both, points);
            if (images[i].hidden) {
                EXPECT_EQ(points[0].status, reflection::ReflectionStatus::hidden);
                continue;
            }
            if (points[0].status != reflection::ReflectionStatus::found ||
                points[1].status != reflection::ReflectionStatus::found)
                continue;
            const double angle =
                glm::length(glm::normalize(reflection::virtualVertex(points[0], both[0]) - eye) -
                            glm::normalize(reflection::virtualVertex(points[1], both[1]) - eye));
            // The nearest place is not quite where an image is largest: near the outline others are.
            EXPECT_LT(angle * images[i].metresPerRadian, 2 * 1e-3) << i;
            ++known;
        }
        hidden += images[i].hidden;
        EXPECT_GT(images[i].angle, 0);
    }
    EXPECT_GT(hidden, 2);
    EXPECT_GT(known, 2000);
    EXPECT_TRUE(images.back().hidden);
}

TEST(ChromeParts, BumpersCoversMirrorCapsAndHandlesAreWholeConvexBodies) {
    const vehicles::VehicleModel saloon = vehicles::saloon();
    const ChromeParts parts(std::span(&saloon, 1));
    int bodies = 0, wheels = 0, others = 0;
    for (const ChromePart& part : parts.of(0)) {
        if (!part.convex) {
            ++others;
            continue;
        }
        EXPECT_TRUE(part.closed);
        ++(part.onWheel ? wheels : bodies);
        const reflection::Reflector& reflector = parts.reflectorOf(part);
        ASSERT_EQ(reflector.pieces.size(), 1u);
        EXPECT_EQ(reflector.pieces[0].bend, reflection::Bend::convex);
        EXPECT_EQ(reflector.pieces[0].built.report.coveredShare, 1);
    }
    // Two bumpers, two caps with a glass each, four handles; a cover; rims of windows, grilles.
    EXPECT_EQ(bodies, 10);
    EXPECT_EQ(wheels, 1);
    EXPECT_GT(others, 2);
}

TEST(ChromeParts, WhatDiffersInItsPlaceAloneIsMadeOnce) {
    vehicles::VehicleModel one, two;
    one.levels.emplace_back().body = World::button({2, 0.3f, 0.7f});
    one.levels.front().body.append(World::button({2, -0.3f, 0.7f}));
    two.levels.emplace_back().body = World::button({-1, 0, 12.345f});
    two.wheel = World::button({0, 0, 0});
    two.wheels.resize(4);
    const std::vector<vehicles::VehicleModel> models{one, two};
    const ChromeParts parts(models);
    ASSERT_EQ(parts.of(0).size(), 2u);
    ASSERT_EQ(parts.of(1).size(), 2u);
    EXPECT_EQ(parts.shapes(), 1u);
    EXPECT_EQ(parts.reflectorsMade(), 0u);
    EXPECT_EQ(&parts.reflectorOf(parts.of(0)[0]), &parts.reflectorOf(parts.of(1)[1]));
    EXPECT_EQ(parts.reflectorsMade(), 1u);
    EXPECT_GT(parts.bytes(), 0u);
    EXPECT_TRUE(parts.of(2).empty());
    EXPECT_NE(parts.of(1)[0].onWheel, parts.of(1)[1].onWheel);
    // A part that is bent otherwise is another.
    std::vector<vehicles::VehicleModel> bent = models;
    bent[0].levels[0].body.vertices[5].position.x += 0.01f;
    EXPECT_EQ(ChromeParts(bent).shapes(), 2u);
}

TEST(ChromeParts, APillarIsSearchedOnABodyThatIsClosed) {
    city::CityModel city;
    city.reflectors.push_back({"pillar", city::StandingReflector::Shape::pillar,
                               city::StandingReflector::Stuff::chrome, glm::vec3(3, 4, 0), 0.5f, 4});
    const std::vector<vehicles::VehicleModel> models = standingModels(city);
    const ChromeParts alone(models);
    EXPECT_FALSE(alone.of(0)[0].closed);
    const CloseScene close(city, models);
    const ChromePart& part = close.parts.of(0)[0];
    EXPECT_TRUE(part.closed);
    const reflection::Reflector& reflector = close.parts.reflectorOf(part);
    ASSERT_EQ(reflector.pieces.size(), 1u);
    // What is seen is the pillar's side, what is searched goes on past it, and is smooth.
    const city::Aabb seen = reflector.pieces[0].mesh.bounds();
    EXPECT_NEAR(seen.size().z, 4, 1e-4f);
    const reflection::ReflectorMap& map = reflector.pieces[0].built.map;
    EXPECT_EQ(reflector.pieces[0].built.report.coveredShare, 1);
    for (const double z : {0.0, 1.9, 2.4}) {
        const glm::dvec3 eye(5, 0, z), vertex(2, 3, z);
        reflection::ReflectionPoint point;
        reflection::findReflectionPoints(map, eye, {&vertex, 1}, {&point, 1});
        EXPECT_EQ(point.status, reflection::ReflectionStatus::found);
        EXPECT_NEAR(glm::length(glm::dvec2(point.point)), 0.5, 1e-3);
        EXPECT_NEAR(point.point.z, z, 2e-3);
    }
    EXPECT_TRUE(roundedPillar({"none", {}, {}, {}, 0, 1}).empty());
}

TEST(ChromeParts, CreasesAndPaintPartAndBrokenTrianglesAreLeftOut) {
    constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);
    city::Mesh mesh;
    const auto quad = [&](glm::vec3 o, glm::vec3 u, glm::vec3 v, std::uint32_t material) {
        const glm::vec3 n = glm::normalize(glm::cross(u, v));
        mesh.addQuad({o, n, {}, material}, {o + u, n, {}, material}, {o + u + v, n, {}, material},
                     {o + v, n, {}, material});
    };
    quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, chrome);
    quad({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, chrome);   // goes on flat
    quad({2, 0, 0}, {0, 0, -1}, {0, 1, 0}, chrome);  // round a sharp edge
    quad({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0);
    EXPECT_EQ(chromeComponents(mesh).size(), 2u);
    EXPECT_EQ(chromeComponents(mesh)[0].triangleCount(), 4u);
    // Three triangles at an edge, one with a corner that is nowhere, one with an index that is.
    quad({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, chrome);
    const float nowhere = std::numeric_limits<float>::quiet_NaN();
    mesh.addTriangle({{nowhere, 0, 0}, {0, 0, 1}, {}, chrome}, {{0, 0, 0}, {0, 0, 1}, {}, chrome},
                     {{1, 0, 0}, {0, 0, 1}, {}, chrome});
    mesh.indices.insert(mesh.indices.end(), {0, 1, 1000});
    vehicles::VehicleModel model;
    model.levels.emplace_back().body = mesh;
    const ChromeParts parts(std::span(&model, 1));
    std::size_t pieces = 0;
    for (const ChromePart& part : parts.of(0)) {
        EXPECT_TRUE(std::isfinite(part.radius) && std::isfinite(part.width));
        pieces += parts.reflectorOf(part).pieces.size();
    }
    EXPECT_GE(pieces, 3u);
}

}  // namespace
}  // namespace app
