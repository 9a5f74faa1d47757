// Close chrome drawn by searched reflection points, against rays and against environment maps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "app/display/OffscreenContext.h"
#include "app/mirrors/LitShapes.h"
#include "app/mirrors/MirrorTruth.h"
#include "app/render/MirrorStage.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/render/WritePng.h"

namespace app {
namespace {

using reflection::CurvedMaps;
using reflection::TreeSettings;

/// A chrome ball on a chequered floor, with things a hand's breadth from it.
MirrorWorld ballAmongThings() {
    MirrorWorld world;
    world.name = "a chrome ball among things";
    const auto add = [&](LitMesh mesh) {
        bakeLight(mesh);
        world.objects.push_back(std::move(mesh));
    };
    add(litPanel({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 24, 24, {.8f, .75f, .7f}, {.25f, .3f, .35f}));
    add(litBox({-.75f, -.5f, 0}, {-.5f, -.25f, .5f}, {.8f, .2f, .15f}));
    add(litBall({.55f, -.45f, .15f}, .15f, 48, 32, {.2f, .55f, .25f}));
    add(litBox({.2f, -.75f, 0}, {.3f, -.65f, .3f}, {.2f, .3f, .8f}));
    add(litPillar({-.2f, -.85f, 0}, .05f, .35f, 24, {.9f, .8f, .2f}));
    add(litPanel({-2, 2, 0}, {4, 0, 0}, {0, 0, 2}, 8, 4, {.7f, .6f, .5f}, {.5f, .4f, .35f}));
    MirrorWorld::Curved ball;
    ball.reflector.centre = {0, 0, .42};
    ball.reflector.radius = .4;
    ball.reflector.surface.reflectance = glm::vec3(.95f);
    ball.mesh = litBall(glm::vec3(ball.reflector.centre), .4f, 128, 96, glm::vec3(1));
    world.curved.push_back(ball);
    world.eye = {.4, -2.1, .9};
    world.target = {0, 0, .4};
    world.fovYDegrees = 35;
    return world;
}

struct Errors {
    double psnr = 0, flip = 0;
};

class ChromeGlTest : public ::testing::Test {
  protected:
    Errors against(const std::vector<glm::vec3>& image, const TracedPicture& truth) const {
        const reflection::ImageView ours{size.x, size.y, image}, theirs{size.x, size.y, truth.radiance};
        return {reflection::psnr(ours, theirs, truth.curved),
                reflection::meanError(reflection::flip(ours, theirs), truth.curved)};
    }
    void writeRadiance(const std::string& name, const std::vector<glm::vec3>& radiance) const {
        Image8 image{size, {}};
        for (const glm::vec3& c : radiance) {
            for (int k = 0; k < 3; ++k)
                image.rgba.push_back(
                    static_cast<std::uint8_t>(255 * std::pow(glm::clamp(c[k], 0.f, 1.f), 1 / 2.2f) + .5f));
            image.rgba.push_back(255);
        }
        test::writePng(name, image);
    }
    std::vector<glm::vec3> drawn(const MirrorWorld& world, bool chrome,
                                 const reflection::VirtualMeshOptions& options, ChromeFrame* frame = nullptr,
                                 bool onGpu = false) {
        reflection::MirrorPassOptions pass;
        pass.nearness = true;
        MirrorStage stage(world, size, CurvedMaps::cube, pass);
        if (chrome) stage.setChrome(options);
        if (onGpu) stage.searchChromeOnGpu();
        TreeSettings settings;
        settings.depth = 1;
        for (int k = 0; k < 3; ++k) stage.draw(settings);
        if (frame != nullptr) *frame = stage.chromeFrame();
        return stage.read();
    }

    OffscreenContext context;
    const glm::ivec2 size{480, 360};
};

TEST_F(ChromeGlTest, ShowsCloseThingsWhereRaysMeetThem) {
    const MirrorWorld world = ballAmongThings();
    const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 1, .samples = 1});
    reflection::VirtualMeshOptions options;
    options.vertices.share = 1;
    ChromeFrame frame;
    const auto chrome = drawn(world, true, options, &frame), map = drawn(world, false, options);
    const Errors ours = against(chrome, truth), theirs = against(map, truth);
    EXPECT_EQ(frame.jobs, 1u);
    EXPECT_GT(frame.searched, frame.vertices / 2);
    writeRadiance("chrome", chrome);
    writeRadiance("chrome_map", map);
    writeRadiance("chrome_truth", truth.radiance);
    EXPECT_LT(ours.flip, theirs.flip / 2);
    EXPECT_GT(ours.psnr, theirs.psnr + 6);
}

TEST_F(ChromeGlTest, TheGraphicsCardsSearchDrawsTheSamePicture) {
    const MirrorWorld world = ballAmongThings();
    const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 1, .samples = 1});
    reflection::VirtualMeshOptions options;
    options.vertices.share = 1;
    ChromeFrame frame;
    const auto cpu = drawn(world, true, options), gpu = drawn(world, true, options, &frame, true);
    EXPECT_EQ(frame.searched, frame.vertices);
    EXPECT_EQ(frame.lookups, 0u) << "counted by the processor's search alone";
    writeRadiance("chrome_gpu", gpu);
    const Errors ours = against(gpu, truth), theirs = against(cpu, truth);
    const double apart = reflection::psnr({size.x, size.y, gpu}, {size.x, size.y, cpu}, truth.curved);
    // Edges are cut by other rules, here more finely: pixels at the borders of colours differ.
    EXPECT_LT(ours.flip, 1.1 * theirs.flip);
    EXPECT_GT(apart, 28);
}

TEST_F(ChromeGlTest, ChromeInChromeShowsWhatRaysOfManyBouncesMeet) {
    MirrorWorld world = ballAmongThings();
    world.curved[0].reflector.centre.x = -.5;
    MirrorWorld::Curved second = world.curved[0];
    second.reflector.centre = {.5, .1, .42};
    for (MirrorWorld::Curved* ball : {&world.curved[0], &second})
        ball->mesh = litBall(glm::vec3(ball->reflector.centre), .4f, 96, 72, glm::vec3(1));
    world.curved.push_back(second);
    const TracedPicture truth = MirrorTruth(world).picture(world.view(size), {.depth = 6, .samples = 1});
    std::vector<std::uint8_t> inside;
    for (std::size_t k = 0; k < truth.level.size(); ++k)
        inside.push_back(truth.curved[k] != 0 && truth.level[k] >= 2);
    reflection::VirtualMeshOptions options;
    options.vertices.share = 1;
    std::vector<double> flip;
    for (int depth = 1; depth <= 3; ++depth) {
        reflection::MirrorPassOptions pass;
        pass.nearness = true;
        MirrorStage stage(world, size, CurvedMaps::cube, pass);
        stage.setChrome(options, true, {.depth = depth});
        TreeSettings settings;
        settings.depth = 6;
        for (int k = 0; k < 4; ++k) stage.draw(settings);
        // Each shows the other, and itself in it, and so on.
        EXPECT_EQ(stage.chromeTree().passes(), 2u * static_cast<std::uint32_t>(depth - 1));
        EXPECT_EQ(stage.chromeFrame().pictures, stage.chromeTree().passes());
        const std::vector<glm::vec3> image = stage.read();
        flip.push_back(reflection::meanError(
            reflection::flip({size.x, size.y, image}, {size.x, size.y, truth.radiance}), inside));
        writeRadiance("chrome_bounces_" + std::to_string(depth), image);
    }
    writeRadiance("chrome_bounces_truth", truth.radiance);
    EXPECT_LT(flip[1], 0.5 * flip[0]);
    EXPECT_LT(flip[2], flip[1]);
}

}  // namespace
}  // namespace app
