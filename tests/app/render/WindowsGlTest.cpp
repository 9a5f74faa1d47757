// What a window shows is what a picture of the mirrored city shows: the city with everything carried to the
// other side of the glass, lit by a sun carried there too, drawn as any city is.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/DebugOutput.h"
#include "tests/app/render/BoxWorld.h"

namespace app {
namespace {

namespace gl = reflection::gl;

constexpr glm::ivec2 size(480, 270);
constexpr double glassY = 9;     ///< the plane of the northern glass; it looks south
constexpr double facingY = -11;  ///< of the southern one, which looks north

/// An upright rectangle of glass along x that mirrors everything, at y, looking north or south.
city::GlassFront pane(double x0, double x1, double y, double z0, double z1, bool north) {
    city::GlassFront front;
    front.normal = {0, north ? 1 : -1, 0};
    const double left = north ? x1 : x0, right = north ? x0 : x1;
    front.outline = {glm::dvec3(left, y, z0), {right, y, z0}, {right, y, z1}, {left, y, z1}};
    front.glass = {1, 0};
    front.paneCount = 1;
    front.area = (x1 - x0) * (z1 - z0);
    const auto corner = [&](std::size_t i) {
        return city::Vertex{glm::vec3(front.outline[i]), glm::vec3(front.normal), {0.5f, 0.5f}, 0};
    };
    front.panes.addQuad(corner(0), corner(1), corner(2), corner(3));
    front.bounds = front.panes.bounds();
    return front;
}

city::GlassFront blackened(city::GlassFront front) {
    front.glass = {0, 0};
    return front;
}

/// Boxes of all colours south of the glass, and one, if asked for, north of it, which nobody may see in it.
city::CityModel street(bool behind) {
    city::CityModel city = test::boxCity();
    city.chunks.resize(1);  // the ground
    const auto add = [&](const glm::vec3& lo, const glm::vec3& hi, std::uint32_t material) {
        city::Mesh mesh;
        test::addBox(mesh, lo, hi, material);
        city.chunks.push_back(test::chunkOf(city::ChunkKind::building, std::move(mesh)));
    };
    add({-14, -20, 0}, {-6, -12, 11}, 1);
    add({-5, -26, 0}, {3, -12, 6}, 2);
    add({4, -20, 0}, {15, -12, 14}, 3);
    add({-2, 2, 0}, {0, 5, 1.5f}, 4);
    add({6, 6, 0.5f}, {7.5f, 8.5f, 2.5f}, 1);
    add({-40, -60, 0}, {40, -40, 25}, 4);
    if (behind) add({-9, 10, 0}, {9, 14, 9}, 2);
    for (const city::Chunk& chunk : city.chunks) city.bounds.extend(chunk.bounds);
    return city;
}

city::CityModel mirrored(city::CityModel city) {
    for (city::Chunk& chunk : city.chunks) {
        for (city::Vertex& v : chunk.mesh.vertices) {
            v.position.y = static_cast<float>(2 * glassY - v.position.y);
            v.normal.y = -v.normal.y;
        }
        for (std::size_t i = 0; i + 2 < chunk.mesh.indices.size(); i += 3)
            std::swap(chunk.mesh.indices[i + 1], chunk.mesh.indices[i + 2]);
        chunk.bounds = chunk.mesh.bounds();
    }
    return city;
}

class WindowsGlTest : public testing::Test {
  public:
    ~WindowsGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    Image8 picture(const city::CityModel& city, const std::vector<city::GlassFront>& fronts, const View& view,
                   int depth, bool mirroredSun, bool occlusion = true) {
        RenderOptions options;
        options.antialiasing = Antialiasing::none;
        options.shadows = false;
        options.occlusionCulling = occlusion;
        SceneRenderer renderer(city, models_, options);
        renderer.setGlass(fronts);
        FrameScene scene;
        scene.lighting = lightingAt(15);
        if (mirroredSun) scene.lighting.sunDirection.y = -scene.lighting.sunDirection.y;
        renderer.prepare(scene);
        MirrorSettings settings;
        settings.depth = depth;
        settings.levelScale = 1;
        settings.economies.detail = false;
        const MirrorPlan plan = MirrorPlanner(fronts).plan(
            std::span(&view, 1), settings, [&](const auto& from, const auto* glass, const auto& box) {
                return renderer.hides(from, glass, box);
            });
        passes_ = plan.counters.passes;
        const OffscreenTarget target(size);
        renderer.drawView(view, {}, target.framebuffer(), {&plan, 0});
        counters_ = renderer.counters();
        EXPECT_EQ(counters_.mirrorPasses, passes_);
        return readPixels(target.framebuffer(), size);
    }

    /// Mean and share of outliers of the differences inside the outline's projection, shrunk by two pixels.
    struct Difference {
        double mean = 0, outliers = 0;
        int pixels = 0;
    };
    /// `black`: the picture with black glass, which tells where something stands before it.
    static Difference within(const Image8& a, const Image8& b, const Image8& black,
                             const city::GlassFront& front, const View& view) {
        glm::dvec2 low(1e9), high(-1e9);
        const reflection::EyeView eye = eyeViewOf(view);
        for (const glm::dvec3& p : front.outline) {
            const glm::dvec4 clip = eye.clip(p);
            const glm::dvec2 at = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(size);
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
        Difference d;
        // Rows of an image read back start at the top.
        for (int y = std::max(0, int(low.y) + 3); y < std::min(size.y, int(high.y) - 2); ++y) {
            for (int x = std::max(0, int(low.x) + 3); x < std::min(size.x, int(high.x) - 2); ++x) {
                const std::size_t at = static_cast<std::size_t>(((size.y - 1 - y) * size.x + x) * 4);
                if (black.rgba[at] > 1 || black.rgba[at + 1] > 1 || black.rgba[at + 2] > 1) continue;
                int most = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const int e = std::abs(int(a.rgba[at + c]) - int(b.rgba[at + c]));
                    d.mean += e / 3.0;
                    most = std::max(most, e);
                }
                d.outliers += most > 12 ? 1 : 0;
                ++d.pixels;
            }
        }
        d.mean /= std::max(d.pixels, 1);
        d.outliers /= std::max(d.pixels, 1);
        return d;
    }

    OffscreenContext context_;
    gl::DebugOutput debug_;
    std::vector<vehicles::VehicleModel> models_{test::boxCar()};
    std::uint32_t passes_ = 0;
    RenderCounters counters_;
};

TEST_F(WindowsGlTest, aWindowShowsTheMirroredCity) {
    const city::GlassFront front = pane(-8, 9, glassY, 0.4, 5, false);
    for (const glm::dvec3 eye : {glm::dvec3(0, -4, 1.7), glm::dvec3(-11, 3, 2.5), glm::dvec3(10, 7, 1.2)}) {
        // Seen head on, from the side, along the glass: the view holds all of its height.
        const View view = lookAt(eye, {0.5, glassY, 2.4}, 1.2, size);
        const Image8 seen = picture(street(true), {front}, view, 1, false);
        ASSERT_EQ(passes_, 1u);
        EXPECT_GT(counters_.mirrorTriangles, 0u);
        const Image8 truth = picture(mirrored(street(false)), {}, view, 0, true);
        const Image8 black = picture(street(true), {blackened(front)}, view, 0, false);
        const Difference d = within(seen, truth, black, front, view);
        ASSERT_GT(d.pixels, 2000);
        // 11 bit floats: 1.6% of radiance, 2 of 255 in display values; boxes' edges move by a pixel at most.
        EXPECT_LT(d.mean, 1.5);
        EXPECT_LT(d.outliers, 0.02);
        if (eye.x < 0 || eye.x > 5) continue;  // the rest once
        // The same with everything that no building hides drawn anyway.
        const Image8 all = picture(street(true), {front}, view, 1, false, false);
        EXPECT_EQ(all.rgba, seen.rgba);
        // And it is no accident: without the mirror the picture is another.
        const Image8 plain = picture(street(true), {front}, view, 0, false);
        EXPECT_GT(within(plain, truth, black, front, view).mean, 15);
    }
}

TEST_F(WindowsGlTest, aRoughFrontShowsTheMirroredCitySpread) {
    const View view = lookAt({0, -4, 1.7}, {0.5, glassY, 2.4}, 1.2, size);
    const auto rough = [](float roughness) {
        city::GlassFront front = pane(-8, 9, glassY, 0.4, 5, false);
        front.glass = {1, 0, roughness, true};
        return front;
    };
    const city::CityModel city = street(true);
    const Image8 sharp = picture(city, {rough(0)}, view, 1, false);
    const Image8 seen = picture(city, {rough(0.3f)}, view, 1, false);
    ASSERT_EQ(passes_, 1u);
    const Image8 black = picture(city, {blackened(pane(-8, 9, glassY, 0.4, 5, false))}, view, 0, false);
    const auto onGlass = [&](std::size_t at) {
        return black.rgba[at] <= 1 && black.rgba[at + 1] <= 1 && black.rgba[at + 2] <= 1;
    };
    const auto texel = [&](int x, int y) { return static_cast<std::size_t>((y * size.x + x) * 4); };
    double steps = 0, sharpSteps = 0, sum = 0, sharpSum = 0;
    int pixels = 0;
    for (int y = 1; y < size.y; ++y) {
        for (int x = 1; x < size.x; ++x) {
            const std::size_t at = texel(x, y), left = texel(x - 1, y);
            if (!onGlass(at) || !onGlass(left)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                steps += std::abs(int(seen.rgba[at + c]) - int(seen.rgba[left + c]));
                sharpSteps += std::abs(int(sharp.rgba[at + c]) - int(sharp.rgba[left + c]));
                sum += seen.rgba[at + c];
                sharpSum += sharp.rgba[at + c];
            }
            ++pixels;
        }
    }
    ASSERT_GT(pixels, 5000);
    // Soft: its pixels differ from their neighbours' by less than the sharp ones' do, but for what stands
    // close to the glass and the large shapes. As bright on the whole: display values bend downwards, so that
    // a mixture of sky and walls is brighter than the mean of both, and never darker.
    EXPECT_LT(steps, 0.6 * sharpSteps);
    EXPECT_GT(steps, 0.02 * sharpSteps);
    EXPECT_GT(sum / sharpSum, 0.98);
    EXPECT_LT(sum / sharpSum, 1.25);
    // All but smooth: the smooth picture, but for its texels' size.
    const Image8 nearly = picture(city, {rough(0.01f)}, view, 1, false);
    const city::GlassFront front = rough(0);
    EXPECT_LT(within(nearly, sharp, black, front, view).mean, within(seen, sharp, black, front, view).mean);
    // Too small to be worth a map: mean light, and no pass.
    MirrorSettings settings;
    settings.leastRoughPixels = 1e9;
    const std::vector<city::GlassFront> one{rough(0.3f)};
    EXPECT_TRUE(MirrorPlanner(one).plan(std::span(&view, 1), settings).empty());
}

TEST_F(WindowsGlTest, aWindowInAWindowShowsTheCityMirroredTwice) {
    const city::GlassFront north = pane(-8, 9, glassY, 0.4, 5, false);
    const city::GlassFront south = pane(-4, 4, facingY, 0.4, 5.5, true);
    const View view = lookAt({1, -3, 1.8}, {0.5, glassY, 2.4}, 1.2, size);
    const Image8 seen = picture(street(false), {north, south}, view, 2, false);
    EXPECT_EQ(passes_, 2u);
    // The southern glass carried behind the northern one, where it is met first; what it shows is the
    // mirrored city mirrored again, and in it the northern glass as every glass is at the last depth.
    const city::GlassFront carried = pane(-4, 4, 2 * glassY - facingY, 0.4, 5.5, false);
    const city::GlassFront back = pane(-8, 9, glassY, 0.4, 5, true);
    const Image8 truth = picture(mirrored(street(false)), {carried, back}, view, 1, true);
    EXPECT_EQ(passes_, 1u);
    const Image8 black = picture(street(false), {blackened(north)}, view, 0, false);
    const Difference d = within(seen, truth, black, north, view);
    ASSERT_GT(d.pixels, 1000);
    EXPECT_LT(d.mean, 1.5);
    EXPECT_LT(d.outliers, 0.02);
    // One mirror in a row is not enough.
    const Image8 once = picture(street(false), {north, south}, view, 1, false);
    EXPECT_GT(within(once, truth, black, carried, view).mean, 5);
    EXPECT_LT(within(seen, truth, black, carried, view).mean, 1.5);
}

TEST_F(WindowsGlTest, wetGroundMirrorsWhatStandsOnItAndNothingElseChanges) {
    // A lit box ahead, dark ground: what is light below the horizon is its image.
    city::CityModel city = street(false);
    city.chunks.resize(1);
    city.materials[4].emission = {3, 1, 0.2f};
    city.materials[0].tint = glm::vec3(0.02f);
    city::Mesh mesh;
    test::addBox(mesh, {-3, 20, 0}, {3, 22, 6}, 4);
    city.chunks.push_back(test::chunkOf(city::ChunkKind::building, std::move(mesh)));
    const View view = lookAt({0, 0, 1.5}, {0, 20, 0.5}, 1.0, size);
    RenderOptions options;
    options.antialiasing = Antialiasing::none;
    options.shadows = false;
    SceneRenderer renderer(city, models_, options);
    FrameScene scene;
    scene.lighting = lightingAt(23);
    const OffscreenTarget target(size);
    const auto draw = [&](bool wet) {
        renderer.prepare(scene);
        MirrorSettings settings;
        if (wet) settings.wetRoad = 0;
        const MirrorPlan plan = MirrorPlanner({}).plan(std::span(&view, 1), settings);
        renderer.drawView(view, {}, target.framebuffer(), {&plan, 0, wet});
        return readPixels(target.framebuffer(), size);
    };
    const Image8 dry = draw(false), wet = draw(true);
    EXPECT_EQ(renderer.counters().mirrorPasses, 1u);
    // Without mirrors the ground is wet as well: another colour than when it is dry, and nothing else.
    renderer.prepare(scene);
    renderer.drawView(view, {}, target.framebuffer(), {nullptr, 0, true});
    EXPECT_EQ(renderer.counters().mirrorPasses, 0u);
    const Image8 plain = readPixels(target.framebuffer(), size);
    const auto half = static_cast<std::size_t>(size.x * 4 * (size.y / 3));
    std::size_t others = 0;
    for (std::size_t i = half * 2; i < plain.rgba.size(); ++i) others += plain.rgba[i] != dry.rgba[i] ? 1 : 0;
    EXPECT_GT(others, plain.rgba.size() / 12);
    EXPECT_TRUE(std::equal(plain.rgba.begin(), plain.rgba.begin() + static_cast<std::ptrdiff_t>(half),
                           dry.rgba.begin()));
    const reflection::EyeView eye = eyeViewOf(view);
    const auto red = [&](const Image8& image, const glm::dvec3& p, int dx = 0) {
        const glm::dvec4 clip = eye.clip(p);
        const glm::dvec2 at = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(size);
        return int(
            image.rgba[static_cast<std::size_t>(((size.y - 1 - int(at.y)) * size.x + int(at.x) + dx) * 4)]);
    };
    // The mirror image of the lit wall, carried 3 m under the ground, over a few metres of street.
    double on = 0, beside = 0, before = 0;
    for (int k = 0; k < 20; ++k) {
        const glm::dvec3 image(-1.9 + 0.2 * k, 20, -3), aside(-14 + 0.2 * k, 20, -3);
        on += red(wet, image) / 20.0;
        beside += red(wet, aside) / 20.0;
        before += red(dry, image) / 20.0;
    }
    EXPECT_GT(on, before + 15);
    EXPECT_GT(on, beside + 10);
    // Above the horizon nothing is wet.
    const auto sky = wet.rgba.begin();
    const auto rows = static_cast<std::ptrdiff_t>(size.x * 4 * (size.y / 3));
    EXPECT_TRUE(std::equal(sky, sky + rows, dry.rgba.begin()));
}

TEST_F(WindowsGlTest, noWindowInViewKeepsNoTexture) {
    const city::GlassFront front = pane(-8, 9, glassY, 0.4, 5, false);
    const city::CityModel city = street(true);
    SceneRenderer renderer(city, models_, {});
    const std::vector<city::GlassFront> fronts{front};
    renderer.setGlass(fronts);
    FrameScene scene;
    scene.lighting = lightingAt(15);
    const OffscreenTarget target(size);
    const MirrorPlanner planner(fronts);
    const auto draw = [&](const glm::dvec3& at) {
        renderer.prepare(scene);
        const View view = lookAt({0, -4, 1.7}, at, 1.2, size);
        const MirrorPlan plan = planner.plan(std::span(&view, 1), {});
        renderer.drawView(view, {}, target.framebuffer(), {&plan, 0});
        return renderer.counters();
    };
    EXPECT_GT(draw({0, 9, 2}).mirrorTextureBytes, 0u);
    const RenderCounters away = draw({0, -20, 2});
    EXPECT_EQ(away.mirrorPasses, 0u);
    EXPECT_EQ(away.mirrorTextureBytes, 0u);
    EXPECT_GT(draw({0, 9, 2}).mirrorPasses, 0u);
}

}  // namespace
}  // namespace app
