#include "app/frame/ReflectionPlan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

using reflection::localMapFaceSizes;
using reflection::SeededRandom;

std::uint64_t texelsOf(int sizeClass) {
    const auto side = static_cast<std::uint64_t>(localMapFaceSizes[static_cast<std::size_t>(sizeClass)]);
    return 6 * side * side;
}

/// Vehicles that drive, come and go.
struct Street {
    explicit Street(std::uint64_t seed) : random(seed) {}

    void fill(int count) {
        while (static_cast<int>(scene.vehicles.size()) < count) {
            vehicles::VehiclePose pose;
            pose.id = nextId++;
            pose.position = {random.between(-100, 100), random.between(-5, 5), 0};
            pose.speed = static_cast<float>(random.between(0, 15));
            scene.vehicles.push_back(pose);
        }
    }
    void step(double seconds) {
        scene.time += seconds;
        for (auto& pose : scene.vehicles) pose.position.x += pose.speed * seconds;
    }
    /// About three of four are seen; sizes follow the distance from the origin.
    std::vector<SeenVehicle> see() {
        std::vector<SeenVehicle> seen;
        for (std::uint32_t i = 0; i < scene.vehicles.size(); ++i)
            if (random.below(4) != 0)
                seen.push_back({i, static_cast<float>(2500 / (5 + std::abs(scene.vehicles[i].position.x)))});
        return seen;
    }

    SeededRandom random;
    FrameScene scene;
    std::uint32_t nextId = 1;
};

const std::vector<float> heights{0.8f};

void expectSound(const ReflectionPlan& plan, const FrameScene& scene, std::span<const SeenVehicle> seen,
                 const ReflectionPlanner& planner) {
    ASSERT_EQ(plan.slots.size(), scene.vehicles.size());
    EXPECT_EQ(plan.visible, seen.size());
    EXPECT_EQ(plan.visible, plan.fresh + plan.shared + plan.postponed + plan.jobs.size());
    std::set<std::pair<int, int>> used;
    for (const SeenVehicle& v : seen) {
        const auto slot = plan.slots[v.index];
        ASSERT_TRUE(slot.valid());
        ASSERT_LT(slot.sizeClass, static_cast<int>(localMapFaceSizes.size()));
        ASSERT_GE(slot.layer, 0);
        ASSERT_LT(slot.layer, planner.layersNeeded()[static_cast<std::size_t>(slot.sizeClass)]);
        ASSERT_TRUE(used.emplace(slot.sizeClass, slot.layer).second) << "two vehicles share a map";
    }
    std::size_t valid = 0;
    for (const auto& slot : plan.slots) valid += slot.valid() ? 1 : 0;
    EXPECT_EQ(valid, seen.size());
    std::uint64_t texels = 0;
    std::set<std::uint32_t> built;
    for (const MapJob& job : plan.jobs) {
        ASSERT_TRUE(built.insert(job.vehicle).second);
        const auto slot = plan.slots[job.vehicle];
        EXPECT_EQ(slot.sizeClass, job.slot.sizeClass);
        EXPECT_EQ(slot.layer, job.slot.layer);
        texels += texelsOf(job.slot.sizeClass);
    }
    EXPECT_EQ(texels, plan.texels);
}

TEST(ReflectionPlanTest, ownMotionCountsByItsShareAndNeighboursInFull) {
    // One vehicle that drives alone, 200 pixels across: half a pixel of shift after 0.5 * pi * 8 / 200 =
    // 0.063 m.
    const auto metresUntilRebuilt = [](float share, bool neighbourDrives) {
        FrameScene scene;
        scene.vehicles.resize(2);
        scene.vehicles[1].id = 1;
        scene.vehicles[1].position = {0, 2, 0};
        const std::vector<SeenVehicle> seen{{0, 200}};
        ReflectionPlanner planner;
        PlanOptions options;
        options.ownMotion = share;
        for (int step = 0; step < 1000; ++step) {
            const ReflectionPlan plan = planner.plan(scene, seen, heights, options);
            if (step > 0 && !plan.jobs.empty()) return 0.001 * step;
            scene.time += 0.01;
            scene.vehicles[neighbourDrives ? 1 : 0].position.x += 0.001;
            scene.vehicles[neighbourDrives ? 1 : 0].speed = 0.1;
        }
        return 1.0;
    };
    EXPECT_NEAR(metresUntilRebuilt(1, false), 0.063, 0.002);
    EXPECT_NEAR(metresUntilRebuilt(0.25f, false), 0.252, 0.003);
    EXPECT_EQ(metresUntilRebuilt(0, false), 1);
    EXPECT_EQ(metresUntilRebuilt(0.25f, true), metresUntilRebuilt(1, true));
    EXPECT_LT(metresUntilRebuilt(0, true), 0.1);
}

TEST(ReflectionPlanTest, nothingSeenNothingPlanned) {
    Street street(1);
    street.fill(10);
    ReflectionPlanner planner;
    const ReflectionPlan plan = planner.plan(street.scene, {}, heights, {});
    EXPECT_TRUE(plan.jobs.empty());
    EXPECT_EQ(plan.visible + plan.fresh + plan.postponed, 0u);
    EXPECT_EQ(plan.texels, 0u);
    expectSound(plan, street.scene, {}, planner);
    for (const int layers : planner.layersNeeded()) EXPECT_EQ(layers, 0);
}

TEST(ReflectionPlanTest, everyVehicleHasItsOwnMapWhateverHappensIfNoneIsShared) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Street street(seed);
        ReflectionPlanner planner;
        PlanOptions options;
        options.texelBudget = 20'000 * seed;
        options.share = false;
        for (int frame = 0; frame < 300; ++frame) {
            if (frame % 20 == 0) {
                auto& all = street.scene.vehicles;
                std::erase_if(all, [&](const auto&) { return street.random.below(5) == 0; });
                street.fill(40);
            }
            street.step(1.0 / 60);
            const auto seen = street.see();
            const ReflectionPlan plan = planner.plan(street.scene, seen, heights, options);
            expectSound(plan, street.scene, seen, planner);
            if (HasFatalFailure()) return;
        }
    }
}

TEST(ReflectionPlanTest, budgetIsKeptButForNewVehiclesCoarseMaps) {
    Street street(7);
    street.fill(60);
    ReflectionPlanner planner;
    PlanOptions options;
    options.texelBudget = 120'000;
    std::set<std::uint32_t> known;
    for (int frame = 0; frame < 200; ++frame) {
        street.step(1.0 / 30);
        const auto seen = street.see();
        const ReflectionPlan plan = planner.plan(street.scene, seen, heights, options);
        std::uint64_t coarse = 0;
        for (const MapJob& job : plan.jobs) {
            const std::uint32_t id = street.scene.vehicles[job.vehicle].id;
            if (known.insert(id).second && job.slot.sizeClass >= 3) coarse += texelsOf(job.slot.sizeClass);
        }
        EXPECT_LE(plan.texels, options.texelBudget + coarse) << frame;
    }
    // Not even one map fits: one is built all the same, so that every map's turn comes.
    options.texelBudget = 1;
    street.step(1);
    const ReflectionPlan plan = planner.plan(street.scene, street.see(), heights, options);
    EXPECT_GE(plan.jobs.size(), 1u);
}

TEST(ReflectionPlanTest, largeVehiclesAreServedFirstAmongNewOnes) {
    FrameScene scene;
    std::vector<SeenVehicle> seen;
    for (std::uint32_t i = 0; i < 20; ++i) {
        vehicles::VehiclePose pose;
        pose.id = i;
        pose.position.x = 100.0 * i;
        scene.vehicles.push_back(pose);
        seen.push_back({i, i == 19 ? 250.0f : 60.0f});
    }
    PlanOptions options;
    options.texelBudget = texelsOf(0);
    ReflectionPlanner planner;
    const ReflectionPlan plan = planner.plan(scene, seen, heights, options);
    ASSERT_EQ(plan.jobs.size(), 20u);
    EXPECT_EQ(plan.jobs.front().vehicle, 19u);
    EXPECT_EQ(plan.slots[19].sizeClass, 0);
}

TEST(ReflectionPlanTest, stoppedTrafficNeedsNoFurtherMaps) {
    Street street(8);
    street.fill(40);
    for (auto& pose : street.scene.vehicles) pose.speed = 0;
    std::vector<SeenVehicle> seen;
    for (std::uint32_t i = 0; i < 40; ++i) seen.push_back({i, 20.0f + 5 * static_cast<float>(i)});
    ReflectionPlanner planner;
    PlanOptions options;
    options.texelBudget = 100'000'000;
    EXPECT_EQ(planner.plan(street.scene, seen, heights, options).jobs.size(), 40u);
    for (int frame = 0; frame < 50; ++frame) {
        street.step(1.0 / 60);
        const ReflectionPlan plan = planner.plan(street.scene, seen, heights, options);
        EXPECT_TRUE(plan.jobs.empty());
        EXPECT_EQ(plan.fresh, 40u);
    }
    // With a small budget it settles after as many frames as it takes, every vehicle at its own size.
    planner.reset();
    options.texelBudget = 150'000;
    ReflectionPlan plan;
    for (int frame = 0; frame < 60; ++frame) plan = planner.plan(street.scene, seen, heights, options);
    EXPECT_TRUE(plan.jobs.empty());
    EXPECT_EQ(plan.postponed, 0u);
    // A stand-in's class counts as held, so the size may stay within the hysteresis of a fifth.
    for (const SeenVehicle& v : seen) {
        EXPECT_GE(plan.slots[v.index].sizeClass, sizeClassFor(v.diameterPixels, options.texelsPerPixel))
            << v.diameterPixels;
        EXPECT_LE(plan.slots[v.index].sizeClass,
                  sizeClassFor(v.diameterPixels / 1.2f, options.texelsPerPixel))
            << v.diameterPixels;
    }

    options.everyFrame = true;
    EXPECT_EQ(planner.plan(street.scene, seen, heights, options).jobs.size(), 40u);
}

TEST(ReflectionPlanTest, whatIsOutOfSightCostsNothingHoweverMuchItMoves) {
    Street street(21);
    street.fill(60);
    ReflectionPlanner planner;
    for (int frame = 0; frame < 40; ++frame) {
        street.step(1.0 / 30);
        const ReflectionPlan plan = planner.plan(street.scene, {}, heights, {});
        EXPECT_EQ(plan.jobs.size() + plan.visible + plan.fresh + plan.shared + plan.postponed, 0u);
        EXPECT_EQ(plan.texels, 0u);
        for (const auto& slot : plan.slots) EXPECT_FALSE(slot.valid());
    }
    for (const int layers : planner.layersNeeded()) EXPECT_EQ(layers, 0);
}

TEST(ReflectionPlanTest, mapsThatChangedOutOfSightAreRebuilt) {
    // A car stands; another passes it while the camera looks elsewhere for half a second.
    FrameScene scene;
    scene.vehicles.resize(2);
    scene.vehicles[0].id = 1;
    scene.vehicles[1].id = 2;
    scene.vehicles[1].position = {-3, 2, 0};
    scene.vehicles[1].speed = 12;
    const std::vector<SeenVehicle> seen{{0, 200}};
    ReflectionPlanner planner;
    PlanOptions options;
    options.texelBudget = 10'000'000;
    (void)planner.plan(scene, seen, heights, options);
    for (int frame = 0; frame < 30; ++frame) {
        scene.time += 1.0 / 60;
        scene.vehicles[1].position.x += 0.2;
        (void)planner.plan(scene, {}, heights, options);
    }
    scene.vehicles[1].speed = 0;
    scene.time += 1.0 / 60;
    EXPECT_EQ(planner.plan(scene, seen, heights, options).jobs.size(), 1u);
}

TEST(ReflectionPlanTest, aVehicleOfFewPixelsShowsItsNeighboursMap) {
    FrameScene scene;
    for (std::uint32_t i = 0; i < 3; ++i) {
        vehicles::VehiclePose pose;
        pose.id = i;
        pose.position.x = 6.0 * i;
        scene.vehicles.push_back(pose);
    }
    PlanOptions options;
    // Off by 6 m at 8 m from the facades: 6 / (8 pi) of the diameter, half a pixel for 2.09 pixels.
    ReflectionPlanner planner;
    const std::vector<SeenVehicle> small{{0, 2.0f}, {1, 2.0f}, {2, 2.0f}};
    const ReflectionPlan plan = planner.plan(scene, small, heights, options);
    EXPECT_EQ(plan.jobs.size(), 2u) << "the two at the ends are 12 m apart";
    EXPECT_EQ(plan.shared, 1u);
    EXPECT_EQ(plan.visible, 3u);
    for (const auto& slot : plan.slots) EXPECT_TRUE(slot.valid());
    const ReflectionPlan next = planner.plan(scene, small, heights, options);
    EXPECT_EQ(next.jobs.size(), 0u);
    EXPECT_EQ(next.shared, 1u);

    // Larger on screen it gets its own; a coarser map than it wants is not borrowed.
    planner.reset();
    EXPECT_EQ(planner.plan(scene, std::vector<SeenVehicle>{{0, 2.2f}, {1, 2.2f}}, heights, options).shared,
              0u);
    planner.reset();
    EXPECT_EQ(planner.plan(scene, std::vector<SeenVehicle>{{0, 300}, {1, 2}}, heights, options).shared, 1u);
    options.share = false;
    planner.reset();
    EXPECT_EQ(planner.plan(scene, small, heights, options).jobs.size(), 3u);
}

TEST(ReflectionPlanTest, sharingKeepsEveryVehicleMirroringWithinTheThreshold) {
    // A jam far away, seen by a camera that comes nearer.
    FrameScene scene;
    for (std::uint32_t i = 0; i < 300; ++i) {
        vehicles::VehiclePose pose;
        pose.id = i;
        pose.position = {5.0 * (i / 3), 3.2 * (i % 3), 0};
        scene.vehicles.push_back(pose);
    }
    ReflectionPlanner planner;
    PlanOptions options;
    options.texelBudget = 100'000'000;
    std::uint32_t most = 0;
    for (int frame = 0; frame < 50; ++frame) {
        scene.time += 0.1;
        std::vector<SeenVehicle> seen;
        for (std::uint32_t i = 0; i < 300; ++i)
            seen.push_back(
                {i, static_cast<float>(3000 / (1500.0 - 25 * frame - scene.vehicles[i].position.x))});
        const ReflectionPlan plan = planner.plan(scene, seen, heights, options);
        EXPECT_EQ(plan.visible, plan.fresh + plan.shared + plan.postponed + plan.jobs.size());
        for (const SeenVehicle& v : seen) ASSERT_TRUE(plan.slots[v.index].valid());
        most = std::max(most, plan.shared);
    }
    EXPECT_GT(most, 100u);
}

TEST(ReflectionPlanTest, slotsAreReusedAfterVehiclesLeave) {
    ReflectionPlanner planner;
    PlanOptions options;
    options.texelBudget = 100'000'000;
    int most = 0;
    for (std::uint32_t wave = 0; wave < 8; ++wave) {
        FrameScene scene;
        std::vector<SeenVehicle> seen;
        for (std::uint32_t i = 0; i < 10; ++i) {
            vehicles::VehiclePose pose;
            pose.id = 100 * wave + i;
            scene.vehicles.push_back(pose);
            seen.push_back({i, 100});
        }
        // Maps outlive their vehicle's last sight by a second, 60 frames.
        for (int frame = 0; frame < 70; ++frame) {
            scene.time = wave * 10 + frame / 60.0;
            const ReflectionPlan plan = planner.plan(scene, seen, heights, options);
            expectSound(plan, scene, seen, planner);
        }
        int layers = 0;
        for (const int n : planner.layersNeeded()) layers += n;
        most = std::max(most, layers);
    }
    EXPECT_LE(most, 20) << "two waves at most are held at one time";
    planner.reset();
    for (const int n : planner.layersNeeded()) EXPECT_EQ(n, 0);
}

TEST(ReflectionPlanTest, noMoreMapsThanPlacesHoweverManyVehicles) {
    Street street(9);
    street.fill(400);
    ReflectionPlanner planner;
    PlanOptions options;
    options.layersAtMost = 7;
    options.texelBudget = 100'000'000;
    options.share = false;
    for (int frame = 0; frame < 200; ++frame) {
        std::vector<SeenVehicle> seen;
        for (std::uint32_t i = 0; i < street.scene.vehicles.size(); ++i) seen.push_back({i, 100});
        const ReflectionPlan plan = planner.plan(street.scene, seen, heights, options);
        std::set<std::pair<int, int>> used;
        for (const reflection::LocalMapSlot& slot : plan.slots) {
            if (!slot.valid()) continue;
            EXPECT_LT(slot.layer, 7);
            EXPECT_TRUE(used.emplace(slot.sizeClass, slot.layer).second);
        }
        EXPECT_EQ(used.size(), 7 * localMapFaceSizes.size()) << "every place is used, coarse ones and fine";
        EXPECT_EQ(plan.crowdedOut, 400 - used.size());
        EXPECT_EQ(plan.visible,
                  plan.fresh + plan.shared + plan.postponed + plan.crowdedOut + plan.jobs.size());
        for (const int layers : planner.layersNeeded()) EXPECT_LE(layers, 7);
        street.step(1.0 / 30);
    }
}

TEST(ReflectionPlanTest, sameFramesGiveTheSamePlans) {
    const auto run = [] {
        Street street(9);
        street.fill(50);
        ReflectionPlanner planner;
        std::vector<std::uint64_t> trace;
        for (int frame = 0; frame < 100; ++frame) {
            street.step(1.0 / 60);
            const auto seen = street.see();
            const ReflectionPlan plan = planner.plan(street.scene, seen, heights, {});
            for (const MapJob& job : plan.jobs)
                trace.push_back((static_cast<std::uint64_t>(job.vehicle) << 32) |
                                (static_cast<std::uint64_t>(job.slot.sizeClass) << 16) |
                                static_cast<std::uint64_t>(job.slot.layer));
            trace.push_back(plan.fresh * 1000u + plan.postponed);
        }
        return trace;
    };
    EXPECT_EQ(run(), run());
}

TEST(ReflectionPlanTest, inTurnNobodyWaitsLongerThanARound) {
    Street street(9);
    street.fill(20);
    ReflectionPlanner planner;
    PlanOptions options;
    options.mapsInTurn = 3;
    options.sizeClass = 2;
    std::vector<SeenVehicle> seen;
    for (std::uint32_t i = 0; i < 20; ++i) seen.push_back({i, 50});
    std::map<std::uint32_t, int> age;
    for (int frame = 0; frame < 40; ++frame) {
        street.step(0.05);
        const ReflectionPlan plan = planner.plan(street.scene, seen, heights, options);
        expectSound(plan, street.scene, seen, planner);
        // All at first, for nobody is without a map; then three a frame.
        EXPECT_EQ(plan.jobs.size(), frame == 0 ? 20u : 3u);
        for (auto& [id, frames] : age) ++frames;
        for (const MapJob& job : plan.jobs) {
            EXPECT_EQ(job.slot.sizeClass, 2);
            age[street.scene.vehicles[job.vehicle].id] = 0;
        }
        for (const auto& [id, frames] : age) EXPECT_LE(frames, 7) << "a round of twenty, three a frame";
    }
}

TEST(ReflectionPlanTest, mostUrgentComesFirst) {
    Street street(10);
    street.fill(50);
    ReflectionPlanner planner;
    for (int frame = 0; frame < 40; ++frame) {
        street.step(1.0 / 20);
        const ReflectionPlan plan = planner.plan(street.scene, street.see(), heights, {});
        for (std::size_t i = 1; i < plan.jobs.size(); ++i)
            EXPECT_GE(plan.jobs[i - 1].error, plan.jobs[i].error);
    }
}

TEST(SizeClassTest, isTheCoarsestWithEnoughTexels) {
    for (float pixels = 0; pixels < 600; pixels += 0.37f) {
        int expected = 0;
        for (int c = 0; c < 5; ++c)
            if (static_cast<float>(localMapFaceSizes[static_cast<std::size_t>(c)]) >= 0.5f * pixels)
                expected = c;
        ASSERT_EQ(sizeClassFor(pixels, 0.5f), expected) << pixels;
    }
}

TEST(SizeClassTest, aVehicleOnTheBorderDoesNotFlip) {
    // 64 texels serve up to 128 pixels.
    int held = sizeClassFor(127, 0.5f);
    EXPECT_EQ(held, 1);
    for (int k = 0; k < 20; ++k) {
        held = sizeClassFor(k % 2 ? 126.0f : 130.0f, 0.5f, held);
        EXPECT_EQ(held, 1);
    }
    EXPECT_EQ(sizeClassFor(128 * 1.21f, 0.5f, 1), 0);
    EXPECT_EQ(sizeClassFor(128 * 1.19f, 0.5f, 1), 1);
    EXPECT_EQ(sizeClassFor(128 / 1.19f, 0.5f, 0), 0);
    EXPECT_EQ(sizeClassFor(128 / 1.21f, 0.5f, 0), 1);
    // Far off, it jumps, and never beyond what is wanted.
    SeededRandom random(11);
    for (int k = 0; k < 5000; ++k) {
        const auto pixels = static_cast<float>(random.between(0, 500));
        const int before = random.below(5), now = sizeClassFor(pixels, 0.5f),
                  kept = sizeClassFor(pixels, 0.5f, before);
        EXPECT_GE(kept, std::min(before, now));
        EXPECT_LE(kept, std::max(before, now));
        EXPECT_LE(std::abs(kept - now), 1);
    }
}

}  // namespace
}  // namespace app
