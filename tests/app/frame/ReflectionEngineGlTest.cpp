// The frame's local maps, made by the processor and by the GPU.
#include "app/frame/ReflectionEngine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "app/display/OffscreenContext.h"
#include "app/frame/Lighting.h"
#include "app/frame/StandingReflectors.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/reflection/local_map/AnalyticScene.h"

namespace app {
namespace {

using reflection::LocalMapSlot;

class NoDrawer : public reflection::SceneDrawer {
  public:
    void drawCube(const glm::dvec3&, const reflection::CubeTarget&, const reflection::CubeContent&) override {
        ADD_FAILURE() << "nothing is to be drawn";
    }
};

reflection::GridTracer streetTracer() {
    city::Heightfield field(60, 240, 1, {-30.5, -120.5});
    for (int j = 0; j < 240; ++j)
        for (int i = 0; i < 60; ++i) {
            const double x = -30.5 + i + 0.5;
            field.set(i, j, x < -8 || x > 9 ? 14.0f : 0.0f);
        }
    return reflection::GridTracer(field);
}

class ReflectionEngineGlTest : public testing::Test {
  public:
    ~ReflectionEngineGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    ReflectionEngineGlTest() {
        for (const glm::dvec3& p : {glm::dvec3(0, 2, 2.5), glm::dvec3(2, -9, 2.5), glm::dvec3(-2, 14, 2.5)})
            maps_.push_back(reflection::mapOf(reflection::streetScene, p, 128));
        models_[0].length = 4.4f;
        models_[0].height = 1.45f;
        scene_.lighting = lightingAt(12, 50);
        // One car beside the other, and one so far away that its map is a small one.
        for (const glm::dvec3& p : {glm::dvec3(2, 0, 0), glm::dvec3(-2, 1, 0), glm::dvec3(2, 40, 0)}) {
            vehicles::VehiclePose pose;
            pose.id = static_cast<std::uint32_t>(scene_.vehicles.size());
            pose.position = p;
            pose.heading = 1.5707963;
            pose.paint = {0.9f, 0.02f, 0.02f};
            scene_.vehicles.push_back(pose);
            seen_.push_back({pose.id, pose.id < 2 ? 200.0f : 20.0f});
        }
    }

    std::unique_ptr<ReflectionEngine> engine(MapsOn mapsOn, bool vehiclesInMaps = true) const {
        ReflectionSettings settings;
        settings.everyFrame = true;
        settings.vehiclesInMaps = vehiclesInMaps;
        settings.mapsOn = mapsOn;
        return std::make_unique<ReflectionEngine>(tracer_, maps_, models_, settings);
    }

    /// Level 0 of a slot.
    static std::vector<glm::vec3> texels(const ReflectionEngine& engine, LocalMapSlot slot) {
        const reflection::PackedMips mips = engine.mapIn(slot);
        std::vector<glm::vec3> colours(mips.levelOffset(1));
        for (std::size_t i = 0; i < colours.size(); ++i)
            reflection::unpackTexel(mips.texels[i], colours[i].r, colours[i].g, colours[i].b);
        return colours;
    }

    static std::size_t zenithOf(const std::vector<glm::vec3>& colours) {
        const std::size_t face = colours.size() / 6;
        const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(face))));
        return 4 * face + n / 2 * n + n / 2;
    }

    static std::size_t redOnes(const std::vector<glm::vec3>& colours) {
        return static_cast<std::size_t>(std::ranges::count_if(
            colours, [](const glm::vec3& c) { return c.r > 5 * c.g && c.r > 5 * c.b; }));
    }

    OffscreenContext context_;
    reflection::gl::DebugOutput debug_;
    std::vector<reflection::PackedReferenceMap> maps_;
    reflection::GridTracer tracer_ = streetTracer();
    std::vector<vehicles::VehicleModel> models_{test::boxCar()};
    FrameScene scene_;
    std::vector<SeenVehicle> seen_;
    NoDrawer drawer_;
};

TEST_F(ReflectionEngineGlTest, bothWaysShowTheSameStreetAndTheSameNeighbours) {
    const auto cpu = engine(MapsOn::cpu), gpu = engine(MapsOn::gpu), alone = engine(MapsOn::gpu, false);
    const ReflectionPlan expected = cpu->update(scene_, seen_, drawer_);
    const ReflectionPlan actual = gpu->update(scene_, seen_, drawer_);
    const ReflectionPlan bare = alone->update(scene_, seen_, drawer_);
    EXPECT_EQ(cpu->counters().rays, gpu->counters().rays);
    ASSERT_EQ(expected.jobs.size(), 3u);
    ASSERT_EQ(actual.jobs.size(), 3u);
    EXPECT_NE(actual.slots[0].sizeClass, actual.slots[2].sizeClass);
    for (std::size_t v = 0; v < 3; ++v) {
        const std::vector<glm::vec3> a = texels(*gpu, actual.slots[v]), b = texels(*cpu, expected.slots[v]);
        ASSERT_EQ(a.size(), b.size());
        // As in LocalMapPassGlTest: rounding may decide for a texel in 500.
        std::size_t differ = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            differ +=
                glm::distance(a[i], b[i]) > 0.1f * std::max(glm::length(a[i]), glm::length(b[i])) ? 1 : 0;
        EXPECT_LE(differ, 2 + a.size() / 500) << v;
        if (v == 2) continue;
        // The red neighbour at four metres is there, with just the texels that the processor draws.
        EXPECT_GT(redOnes(a), a.size() / 100) << v;
        EXPECT_EQ(redOnes(a), redOnes(b)) << v;
        EXPECT_EQ(redOnes(texels(*alone, bare.slots[v])), 0u);
    }
}

TEST_F(ReflectionEngineGlTest, mapsComeWithTheirCentresAndDistancesWhereParallaxIsWanted) {
    for (const MapsOn where : {MapsOn::cpu, MapsOn::gpu}) {
        const auto made = engine(where);
        const ReflectionPlan plan = made->update(scene_, seen_, drawer_);
        const reflection::LocalMapTextures with = made->textures();
        for (const MapJob& job : plan.jobs) {
            const auto c = static_cast<std::size_t>(job.slot.sizeClass);
            ASSERT_NE(with.nearnessArrays[c], 0u);
            EXPECT_EQ(with.centres[c][static_cast<std::size_t>(job.slot.layer)], job.centre);
            // Below, the road is as far as the map's centre is high.
            const reflection::PackedMips mips = made->mapIn(job.slot);
            const auto n = static_cast<std::size_t>(mips.faceSize);
            const float below = reflection::unpackNearness(mips.nearness[5 * n * n + n / 2 * n + n / 2]);
            EXPECT_NEAR(static_cast<double>(below) * job.centre.z, 1, 0.05);
        }
        ReflectionSettings settings = made->settings();
        settings.parallax = false;
        made->configure(settings);
        for (const std::uint32_t name : made->textures().nearnessArrays) EXPECT_EQ(name, 0u);
        settings.parallax = true;
        settings.method = ReflectionMethod::blend;
        made->configure(settings);
        for (const std::uint32_t name : made->textures().nearnessArrays) EXPECT_EQ(name, 0u);
    }
}

TEST_F(ReflectionEngineGlTest, whereMapsAreIsAsAskedAndIsTold) {
    const auto cpu = engine(MapsOn::cpu), gpu = engine(MapsOn::gpu), automatic = engine(MapsOn::automatic);
    for (const auto* e : {&cpu, &gpu, &automatic}) (*e)->update(scene_, seen_, drawer_);
    std::size_t bytes = 0;
    for (const auto& map : maps_) bytes += map.bytes();
    EXPECT_EQ(cpu->counters().referenceMapGpuBytes, 0u);
    EXPECT_EQ(cpu->counters().referenceMapBytes, bytes);
    // Words are rounded up to four bytes, level by level.
    EXPECT_NEAR(static_cast<double>(gpu->counters().referenceMapGpuBytes), static_cast<double>(bytes), 100);
    EXPECT_LE(gpu->counters().referenceBytesPerTexel, 3);
    EXPECT_EQ(automatic->counters().referenceMapGpuBytes > 0, !reflection::softwareRenderer());

    ReflectionSettings paper = gpu->settings();
    paper.variant = MemVariant::paper;
    gpu->configure(paper);
    gpu->update(scene_, seen_, drawer_);
    EXPECT_EQ(gpu->counters().referenceMapGpuBytes, 0u) << "the paper's form is made on the processor";

    ReflectionSettings small = gpu->settings();
    small.variant = MemVariant::ours;
    small.gpuMapBytes = 1;
    gpu->configure(small);
    const LocalMapSlot slot = gpu->update(scene_, seen_, drawer_).slots[0];
    EXPECT_LE(gpu->counters().referenceMapGpuBytes, bytes / 3 + 100) << "one map, the least there can be";
    EXPECT_GT(texels(*gpu, slot)[0].r, 0);
}

TEST_F(ReflectionEngineGlTest, whatASceneDoesNotNeedIsNotDone) {
    NoDrawer drawer;
    ReflectionSettings settings;
    settings.detail = detailOf(Quality::high);
    settings.detail->texelBudget = 1e9;
    settings.mapsOn = MapsOn::cpu;
    ReflectionEngine engine(tracer_, maps_, models_, settings);
    const auto expectNothingDone = [&](std::uint32_t visible) {
        EXPECT_EQ(engine.counters().visible, visible);
        EXPECT_EQ(engine.counters().rebuilt, 0u);
        EXPECT_EQ(engine.counters().postponed, 0u);
        EXPECT_EQ(engine.counters().rays, 0u);
        EXPECT_EQ(engine.counters().texels, 0u);
    };
    // Nothing in view: no map, not even memory for one.
    engine.update(scene_, {}, drawer);
    expectNothingDone(0);
    EXPECT_EQ(engine.counters().localMapBytes, 0u);
    // In view, each is built once ...
    engine.update(scene_, seen_, drawer);
    EXPECT_EQ(engine.counters().rebuilt, 3u);
    EXPECT_GT(engine.counters().rays, 0u);
    // ... and while traffic and camera stand, nothing more.
    for (int frame = 0; frame < 5; ++frame) {
        scene_.time += 1.0 / 30;
        engine.update(scene_, seen_, drawer);
        expectNothingDone(3);
    }
    // Gone from view, though it moves.
    scene_.vehicles[0].position.y += 5;
    engine.update(scene_, {}, drawer);
    expectNothingDone(0);
    // Plain paint asks for nothing whatever is in view.
    settings.method = ReflectionMethod::none;
    engine.configure(settings);
    engine.update(scene_, seen_, drawer);
    expectNothingDone(0);
}

TEST_F(ReflectionEngineGlTest, anotherHourHasAnotherSky) {
    const auto cpu = engine(MapsOn::cpu, false), gpu = engine(MapsOn::gpu, false);
    std::vector<std::vector<glm::vec3>> skies;
    for (const double hour : {12.0, 20.0}) {
        scene_.lighting = lightingAt(hour, 50);
        const std::vector<glm::vec3> expected = texels(*cpu, cpu->update(scene_, seen_, drawer_).slots[0]);
        const std::vector<glm::vec3> actual = texels(*gpu, gpu->update(scene_, seen_, drawer_).slots[0]);
        // The middle of the face that looks up; equal but for rounding.
        const std::size_t zenith = zenithOf(actual);
        EXPECT_LE(glm::distance(actual[zenith], expected[zenith]), glm::length(expected[zenith]) / 32);
        skies.push_back(actual);
    }
    EXPECT_LT(glm::length(skies[1][zenithOf(skies[1])]), 0.8f * glm::length(skies[0][zenithOf(skies[0])]));
}

TEST_F(ReflectionEngineGlTest, aMapOfWhatStandsIsTracedOnceAndShowsWhoeverPasses) {
    scene_.vehicles[0].id = firstStandingId;
    const std::vector<SeenVehicle> one{{0, 200.0f}};
    const auto kept = engine(MapsOn::cpu);
    LocalMapSlot slot = kept->update(scene_, one, drawer_).slots[0];
    EXPECT_GT(kept->counters().rays, 0u);
    const std::vector<glm::vec3> before = texels(*kept, slot);
    scene_.vehicles[1].position.y += 4;
    slot = kept->update(scene_, one, drawer_).slots[0];
    EXPECT_EQ(kept->counters().rays, 0u) << "the street is where it was";
    const auto anew = engine(MapsOn::cpu);
    const LocalMapSlot fresh = anew->update(scene_, one, drawer_).slots[0];
    EXPECT_GT(anew->counters().rays, 0u);
    EXPECT_EQ(texels(*kept, slot), texels(*anew, fresh));
    EXPECT_NE(texels(*kept, slot), before) << "the car beside it has moved";
    EXPECT_GT(redOnes(before), 0u);
    // Another light, another map.
    scene_.lighting = lightingAt(8, 50);
    kept->update(scene_, one, drawer_);
    EXPECT_GT(kept->counters().rays, 0u);
}

}  // namespace
}  // namespace app
