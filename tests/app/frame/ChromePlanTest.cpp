// Which chrome shows close things itself, and by how much of it.
#include "app/frame/ChromePlan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/app/frame/ChromeWorld.h"

namespace app {
namespace {

using World = test::ChromeWorld;

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
    World world(5);
    world.models[0].levels.front().body.append(World::button({2, 0.5f, 0.7f}, true));
    world.parts = ChromeParts(world.models);
    ChromePlanOptions alone;
    alone.vehicles = false;
    const ChromePlan standing = planChrome(world.scene, world.seen, world.models, world.parts, alone);
    ASSERT_EQ(standing.jobs.size(), 1u);
    EXPECT_EQ(standing.jobs[0].vehicle, 0u);
    EXPECT_EQ(standing.parts, 1u);
    const ChromePlan all = planChrome(world.scene, world.seen, world.models, world.parts, {});
    EXPECT_EQ(all.jobs.size(), 2u);
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

TEST(ChromeFades, ALadderThatGivesChromeUpTakesItsSharesAwayInSteps) {
    World world(4, 3);
    ChromePlanOptions options;
    ChromeFades fades;
    const auto shares = [&] {
        ChromePlan plan = planChrome(world.scene, world.seen, world.models, world.parts, options, &fades);
        fades.follow(plan);
        std::map<ChromeName, float> now;
        for (const ChromeJob& job : plan.jobs) now[job.name] = job.share;
        return now;
    };
    std::map<ChromeName, float> before = shares();
    EXPECT_FALSE(before.empty());
    for (const double pixels : {ChromeDetail::none, ChromeDetail{}.leastPixels, ChromeDetail::none}) {
        options.leastPixels = pixels;
        for (int frame = 0; frame < 30; ++frame) {
            const std::map<ChromeName, float> now = shares();
            for (const auto& [name, share] : before) {
                const auto at = now.find(name);
                EXPECT_LE(std::abs((at == now.end() ? 0 : at->second) - share), ChromeFades::step + 1e-6f);
            }
            before = now;
        }
        EXPECT_EQ(before.empty(), pixels == ChromeDetail::none);
    }
}

TEST(ChromeFades, NoShareOfAPartInSightChangesByMoreThanAStep) {
    // Vehicles jump about, the eye comes and goes in great steps, and there is room for one job alone.
    World world(3, 6);
    std::uint32_t state = 7;
    const auto random = [&](double low, double high) {
        state = state * 1664525u + 1013904223u;
        return low + (high - low) * (state >> 8) / 16777216.0;
    };
    ChromePlanOptions options;
    options.mostJobs = 2;
    ChromeFades fades;
    std::map<ChromeName, float> before;
    float unlimited = 0;
    int jobs = 0, ended = 0;
    for (int frame = 0; frame < 3000; ++frame) {
        if (frame % 7 == 0) world.lookFrom(random(2, 60));
        if (frame % 5 == 0) world.scene.vehicles[1 + frame / 5 % 6].position.y = random(1.6, 40);
        ChromePlan plan = planChrome(world.scene, world.seen, world.models, world.parts, options, &fades);
        std::map<ChromeName, float> now;
        for (const ChromeJob& job : plan.jobs) {
            if (before.contains(job.name))
                unlimited = std::max(unlimited, std::abs(job.share - before[job.name]));
        }
        for (const ChromeName& name : plan.without) now[name] = 0;
        for (const ChromeJob& job : plan.jobs) now[job.name] = 0;
        fades.follow(plan);
        for (const ChromeJob& job : plan.jobs) now[job.name] = job.share;
        for (const auto& [name, share] : before) {
            // Out of the picture a part may have any share.
            if (now.contains(name)) {
                EXPECT_LE(std::abs(now[name] - share), ChromeFades::step + 1e-6f);
            }
            ended += share > 0 && now.contains(name) && now[name] == 0;
        }
        jobs += static_cast<int>(plan.jobs.size());
        before = now;
    }
    EXPECT_GT(unlimited, 0.5f);
    EXPECT_GT(jobs, 2000);
    EXPECT_GT(ended, 10);
}

TEST(ChromeFades, AReflectorThatIsMadeInTheBackgroundFadesInToWhatWaitingShows) {
    World world(5);
    const ChromePlan waited = world.plan();
    ASSERT_EQ(waited.jobs.size(), 2u);
    World other(5);
    ChromePlanOptions options;
    options.wait = false;
    ChromeFades fades;
    const auto plan = [&] {
        ChromePlan p = planChrome(other.scene, other.seen, other.models, other.parts, options, &fades);
        fades.follow(p);
        return p;
    };
    // Far away nothing is asked for.
    other.lookFrom(300);
    EXPECT_TRUE(plan().empty());
    EXPECT_EQ(other.parts.reflectorsMade(), 0u);
    EXPECT_EQ(other.parts.bytes(), 0u);
    other.lookFrom(5);
    EXPECT_EQ(plan().making, 2u);
    for (const ChromeJob& job : waited.jobs)
        other.parts.reflectorOf(other.parts.of(other.scene.vehicles[job.vehicle].model)[job.part]);
    float share = 0;
    ChromePlan now;
    for (int frame = 0; frame < 20; ++frame) {
        now = plan();
        ASSERT_EQ(now.jobs.size(), 2u);
        EXPECT_EQ(now.making, 0u);
        EXPECT_LE(now.jobs[0].share, share + ChromeFades::step + 1e-6f);
        share = now.jobs[0].share;
    }
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(now.jobs[i].name, waited.jobs[i].name);
        EXPECT_EQ(now.jobs[i].share, waited.jobs[i].share);
        const auto mapOf = [&](const World& w) {
            return w.parts
                .reflectorOf(w.parts.of(w.scene.vehicles[now.jobs[i].vehicle].model)[now.jobs[i].part])
                .pieces[0]
                .built.map.corners();
        };
        EXPECT_TRUE(std::ranges::equal(mapOf(world), mapOf(other)));
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

}  // namespace
}  // namespace app
