// Reflections drawn by the tree against reflections drawn otherwise: stencils, rays, everything unculled.
#include "app/render/MirrorStage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "app/display/OffscreenContext.h"
#include "app/mirrors/LitShapes.h"
#include "app/mirrors/MirrorTruth.h"
#include "reflection/truth/ImageError.h"

namespace app {
namespace {

using reflection::CurvedMaps;
using reflection::Economies;
using reflection::MirrorFormat;
using reflection::TreeSettings;

MirrorWorld paperScene(char which) {
    return loadMirrorWorld(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/scenes/paper_" + which + ".json");
}

double psnrOf(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, glm::ivec2 size,
              reflection::PixelMask mask = {}) {
    return reflection::psnr({size.x, size.y, a}, {size.x, size.y, b}, mask);
}

reflection::MirrorPassOptions exact() {
    reflection::MirrorPassOptions options;
    options.format = MirrorFormat::rgba16f;
    return options;
}

class MirrorStageGlTest : public ::testing::Test {
  protected:
    OffscreenContext context;
    const glm::ivec2 size{320, 240};
};

TEST_F(MirrorStageGlTest, MapsShowWhatStencilsShow) {
    const MirrorWorld world = facingWindows(0);
    for (int depth : {1, 2, 4}) {
        MirrorStage stage(world, size, CurvedMaps::none, exact());
        TreeSettings settings;
        settings.depth = depth;
        stage.draw(settings);
        const auto maps = stage.read();
        stage.drawWithStencil(settings);
        EXPECT_GT(psnrOf(maps, stage.read(), size), 50) << depth;
    }
}

TEST_F(MirrorStageGlTest, SmoothMirrorsShowWhatRaysSee) {
    const MirrorWorld world = facingWindows(0);
    const MirrorTruth truth(world);
    for (int depth : {0, 1, 3, 8}) {
        MirrorStage stage(world, size, CurvedMaps::none, exact());
        TreeSettings settings;
        settings.depth = depth;
        stage.draw(settings);
        // Borders may fall on either side of a pixel's middle.
        EXPECT_GT(psnrOf(stage.read(), truth.picture(world.view(size), {.depth = depth}).radiance, size), 38)
            << depth;
    }
}

TEST_F(MirrorStageGlTest, CullingChangesNoPixel) {
    const glm::ivec2 full(640, 480);
    for (CurvedMaps curved : {CurvedMaps::cube, CurvedMaps::viewDependent, CurvedMaps::dualParaboloid}) {
        for (char which : {'a', 'b', 'c', 'd'}) {
            const MirrorWorld world = paperScene(which);
            std::vector<glm::vec3> all;
            std::uint64_t triangles = 0;
            for (bool culled : {false, true}) {
                reflection::MirrorPassOptions options = exact();
                options.together = options.glossPerTexel = culled;
                MirrorStage stage(world, full, curved, options);
                TreeSettings settings;
                settings.economies = culled ? Economies{} : Economies::paper();
                settings.mapSize = {256, 256};
                settings.cutOff = 0;
                settings.mostMaps = 1000;
                for (int frame = 0; frame < 3; ++frame) stage.draw(settings);
                if (!culled) {
                    all = stage.read();
                    triangles = stage.trianglesDrawn();
                } else {
                    EXPECT_GT(psnrOf(stage.read(), all, full), 50) << which;
                    EXPECT_LT(stage.trianglesDrawn(), triangles) << which;
                }
            }
        }
    }
}

// Level by level into one map each, and with too little room: always the paper's picture.
TEST_F(MirrorStageGlTest, MapsSideBySideShowWhatMapsInTurnShow) {
    for (CurvedMaps curved : {CurvedMaps::viewDependent, CurvedMaps::cube}) {
        for (char which : {'b', 'd'}) {
            const MirrorWorld world = paperScene(which);
            std::vector<glm::vec3> inTurn;
            for (int largest : {0, 4096, 256, 100}) {
                reflection::MirrorPassOptions options = exact();
                options.together = largest > 0;
                if (largest > 0) options.largestAtlas = largest;
                MirrorStage stage(world, size, curved, options);
                TreeSettings settings;
                settings.depth = 2;
                settings.mostMaps = 1000;
                for (int frame = 0; frame < 2; ++frame) stage.draw(settings);
                if (inTurn.empty())
                    inTurn = stage.read();
                else
                    EXPECT_GT(psnrOf(stage.read(), inTurn, size), 60) << which << largest;
            }
        }
    }
}

TEST_F(MirrorStageGlTest, ObliqueNearPlanesCutLikeClipDistances) {
    const MirrorWorld world = paperScene('d');
    MirrorStage stage(world, size, CurvedMaps::none, exact());
    TreeSettings settings;
    settings.depth = 3;
    stage.draw(settings);
    const auto clipped = stage.read();
    stage.setOblique(true);
    stage.draw(settings);
    EXPECT_GT(psnrOf(stage.read(), clipped, size), 45);
}

// A ball that is small beside what it mirrors: there environment maps are nearly right.
TEST_F(MirrorStageGlTest, CurvedReflectorsComeNearWhatRaysSee) {
    MirrorWorld world;
    for (int i = 0; i < 8; ++i) {
        const float a = 0.785398f * static_cast<float>(i), r = 20;
        const glm::vec3 foot(r * std::cos(a), r * std::sin(a), -8);
        world.objects.push_back(
            litBox(foot - glm::vec3(4, 4, 0), foot + glm::vec3(4, 4, 6 + 2 * (i % 4)),
                   {0.2f + 0.1f * static_cast<float>(i), 0.5f, 0.9f - 0.1f * static_cast<float>(i)}));
    }
    MirrorWorld::Curved ball;
    ball.reflector.radius = 0.4;
    ball.mesh = litBall({0, 0, 0}, 0.4f, 64, 32, glm::vec3(1));
    world.curved.push_back(ball);
    world.eye = {-1.6, -0.4, 0.2};
    world.target = {0, 0, 0};
    const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 2});
    std::map<CurvedMaps, double> got;
    for (CurvedMaps curved :
         {CurvedMaps::none, CurvedMaps::viewDependent, CurvedMaps::cube, CurvedMaps::dualParaboloid}) {
        MirrorStage stage(world, size, curved, exact());
        TreeSettings settings;
        settings.faceSize = 512;
        stage.draw(settings);
        got[curved] = psnrOf(stage.read(), truth.radiance, size, truth.curved);
    }
    EXPECT_LT(got[CurvedMaps::none], 16);
    EXPECT_GT(got[CurvedMaps::viewDependent], 18);
    EXPECT_GT(got[CurvedMaps::cube], 24);
    EXPECT_GT(got[CurvedMaps::dualParaboloid], 24);
}

// 28 dB: what waves turn away from the eye behind other things is not in the map.
TEST_F(MirrorStageGlTest, BumpedAndFadingMirrorsComeNearTheTruth) {
    MirrorWorld world = loadMirrorWorld(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/scenes/water.json");
    const double wind = world.mirrors[0].ripples.slope;
    for (double slope : {0.0, wind}) {
        world.mirrors[0].ripples.slope = slope;
        const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 2, .samples = 1});
        MirrorStage stage(world, size, CurvedMaps::none, exact());
        stage.draw({});
        EXPECT_GT(psnrOf(stage.read(), truth.radiance, size, truth.level), slope > 0 ? 28 : 45);
    }
}

// What a mirror seen in one that fades shows by itself fades by the way to it, not by the way of what it
// mirrors; what it mirrors fades by both ways, and by both mirrors' measure where both fade.
TEST_F(MirrorStageGlTest, MirrorsSeenInFadingOnesFadeByTheWayToThem) {
    MirrorWorld world = facingWindows(0);
    for (MirrorWorld::Flat& f : world.mirrors) {
        f.mirror.plane = reflection::MirrorPlane::make(f.mirror.plane.corners(), {glm::vec3(0.5f), 0}).mirror;
        f.tint = {0.9f, 0.6f, 0.8f};
    }
    for (const auto& [first, second] : {std::pair{4.0, 0.0}, std::pair{0.0, 4.0}, std::pair{5.0, 9.0}}) {
        world.mirrors[0].fade = first;
        world.mirrors[1].fade = second;
        const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 4, .samples = 1});
        for (MirrorFormat format : {MirrorFormat::rgba16f, MirrorFormat::rgba8}) {
            reflection::MirrorPassOptions options;
            options.format = format;
            MirrorStage stage(world, size, CurvedMaps::none, options);
            TreeSettings settings;
            settings.depth = 4;
            stage.draw(settings);
            EXPECT_GT(psnrOf(stage.read(), truth.radiance, size, truth.level), 42) << first << ' ' << second;
        }
    }
}

// Balls near a floor, walls and mirrors, seen in each other: where a ray ends matters.
TEST_F(MirrorStageGlTest, CurvedReflectorsAreTruerWithDistances) {
    for (const auto& [which, gain] : {std::pair{'b', 1.5}, std::pair{'c', 4.0}}) {
        const MirrorWorld world = paperScene(which);
        const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 8, .samples = 16});
        for (CurvedMaps curved : {CurvedMaps::cube, CurvedMaps::dualParaboloid}) {
            double got[2] = {};
            for (bool nearness : {false, true}) {
                reflection::MirrorPassOptions options;
                options.nearness = nearness;
                MirrorStage stage(world, size, curved, options);
                TreeSettings settings;
                settings.depth = 3;
                settings.mostMaps = 1000;
                for (int frame = 0; frame < 3; ++frame) stage.draw(settings);
                got[nearness ? 1 : 0] = psnrOf(stage.read(), truth.radiance, size, truth.curved);
            }
            EXPECT_GT(got[1], got[0] + gain) << which;
        }
    }
}

// What rays meet from other places than the map's centre stays, all of it where maps know no distances, and
// what lies behind a reflector where they look to the eye alone.
TEST_F(MirrorStageGlTest, RoughCurvedReflectorsComeNearTheTruthAndSmoothOnesDoNot) {
    MirrorWorld world = paperScene('c');
    for (float roughness : {0.3f, 0.5f}) {
        for (MirrorWorld::Curved& c : world.curved) c.reflector.surface.roughness = roughness;
        const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 4, .samples = 64});
        for (CurvedMaps curved : {CurvedMaps::cube, CurvedMaps::dualParaboloid, CurvedMaps::viewDependent}) {
            const bool dependent = curved == CurvedMaps::viewDependent;
            double got[2] = {};
            for (bool rough : {false, true}) {
                MirrorWorld drawn = world;
                if (!rough)
                    for (MirrorWorld::Curved& c : drawn.curved) c.reflector.surface.roughness = 0;
                reflection::MirrorPassOptions options;
                options.nearness = !dependent;
                MirrorStage stage(drawn, size, curved, options);
                TreeSettings settings;
                settings.depth = 3;
                settings.mostMaps = 1000;
                for (int frame = 0; frame < 3; ++frame) stage.draw(settings);
                got[rough ? 1 : 0] = psnrOf(stage.read(), truth.radiance, size, truth.curved);
            }
            EXPECT_GT(got[1], dependent ? 18 : 25) << roughness;
            EXPECT_GT(got[1], got[0] + (dependent ? 3 : 5)) << roughness;
        }
    }
}

TEST_F(MirrorStageGlTest, RoughMirrorsComeNearTheTruthAtEveryDepth) {
    const MirrorWorld world = facingWindows(0.15f);
    const MirrorTruth truth(world);
    MirrorStage stage(world, size, CurvedMaps::none, exact());
    for (int depth : {1, 3}) {
        TreeSettings settings;
        settings.depth = depth;
        stage.draw(settings);
        const TracedPicture t = truth.picture(world.view(size), {.depth = depth, .samples = 128});
        EXPECT_GT(psnrOf(stage.read(), t.radiance, size, t.level), depth == 1 ? 35 : 30) << depth;
    }
}

TEST_F(MirrorStageGlTest, MemoryGrowsWithDepthAloneAndGoesWhenNothingMirrors) {
    MirrorWorld world = facingWindows(0);
    MirrorStage stage(world, size, CurvedMaps::none);
    std::uint64_t before = 0;
    TreeSettings settings;
    settings.economies.resolution = false;
    for (int depth = 1; depth <= 8; ++depth) {
        settings.depth = depth;
        const auto& tree = stage.draw(settings);
        const std::uint64_t bytes = stage.pass().counters().mapBytes;
        EXPECT_EQ(bytes, static_cast<std::uint64_t>(depth) * 320 * 256 * 4);
        EXPECT_GT(bytes, before);
        EXPECT_EQ(tree.levelSize.size(), static_cast<std::size_t>(depth));
        before = bytes;
    }
    settings.depth = 0;
    const auto& none = stage.draw(settings);
    EXPECT_TRUE(none.empty());
    stage.pass().resetCounters();
    stage.draw(settings);
    stage.pass().trim(none);
    EXPECT_EQ(stage.pass().counters().images, 0u);
    EXPECT_EQ(stage.pass().counters().mapBytes, 0u);
}

}  // namespace
}  // namespace app
