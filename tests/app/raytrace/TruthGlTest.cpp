// Plain paint ray traced is plain paint drawn: what differs in a measurement is then the reflection.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/raytrace/Edges.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/ScreenLight.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/raytrace/MirrorWorld.h"

namespace app {
namespace {

constexpr glm::ivec2 size(320, 180);

class TruthGlTest : public testing::Test {
  protected:
    TruthGlTest() : target_(size) {
        // Patterns with detail, and one thing that stands in many places.
        city_.materials[0].pattern = city::Pattern::cobbles;
        city_.materials[1].pattern = city::Pattern::facadeBrick;
        city_.materials[2].pattern = city::Pattern::facadePlaster;
        city::Prototype post;
        post.levels.emplace_back();
        test::addBox(post.levels.back().mesh, {-0.3f, -0.3f, 0}, {0.3f, 0.3f, 3}, 4);
        city_.prototypes.push_back(post);
        for (int i = -4; i < 5; ++i) {
            city::Placement placement;
            placement.worldFromPrototype[3] = glm::vec4(8 * i, 13, 0, 1);
            city_.placements.push_back(placement);
        }
        city_.signalHeads.push_back({{-2, 4, 3}, {-1, 0, 0}, 0, 0});
        models_ = {test::boxCar(), test::mirrorBall(48)};
        RenderOptions options;
        options.antialiasing = Antialiasing::none;
        renderer_ = std::make_unique<SceneRenderer>(city_, models_, options);
        tracer_ = std::make_unique<RayTracer>(city_, models_);
        if (reflection::softwareRenderer()) tracer_->useTextureFilter(TextureFilter::llvmpipe);
        view_ = lookAt({-12, 3, 3.2}, {0, 8, 1}, glm::radians(60.0), size);
        frame_.vehicles = {test::poseAt(1, 0, {-3, 6, 0}, 0.3), test::poseAt(2, 1, {-1, 9, 0}),
                           test::poseAt(3, 0, {9, 5, 0}, 3)};
        frame_.vehicles[0].paint = {0.5f, 0.05f, 0.04f};
        frame_.vehicles[0].braking = true;
        frame_.signalColours = {vehicles::SignalColour::amber};
        frame_.views = {view_};
    }

    std::vector<glm::vec3> draw(const VehicleReflections& reflections = {}) {
        renderer_->prepare(frame_);
        renderer_->drawView(view_, reflections, target_.framebuffer());
        const Image8 image = readPixels(target_.framebuffer(), size);
        std::vector<glm::vec3> pixels(image.rgba.size() / 4);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
        return pixels;
    }
    void prepareTracer() {
        tracer_->prepare(frame_);
        tracer_->useSunMap(renderer_->sunMap());
    }
    double agreement(const TracedPicture& traced, const std::vector<glm::vec3>& drawn,
                     const std::vector<unsigned char>& mask) {
        return reflection::psnr({size.x, size.y, traced.display(frame_.lighting.exposure)},
                                {size.x, size.y, drawn}, mask);
    }
    static std::vector<unsigned char> of(SeenKind kind, const TracedPicture& picture,
                                         std::vector<unsigned char> mask) {
        for (std::size_t i = 0; i < mask.size(); ++i)
            if (picture.kind[i] != kind) mask[i] = 0;
        return mask;
    }
    /// How much brighter the traced picture is on average over a mask, in display values; of the three
    /// colours the one that differs most.
    double brighter(const TracedPicture& traced, const std::vector<glm::vec3>& drawn,
                    const std::vector<unsigned char>& mask) {
        const std::vector<glm::vec3> display = traced.display(frame_.lighting.exposure);
        glm::dvec3 sum{0};
        double count = 0;
        for (std::size_t i = 0; i < mask.size(); ++i)
            if (mask[i]) {
                sum += glm::dvec3(glm::clamp(display[i], 0.0f, 1.0f)) - glm::dvec3(drawn[i]);
                ++count;
            }
        const glm::dvec3 mean = sum / count;
        return std::max({std::abs(mean.x), std::abs(mean.y), std::abs(mean.z)});
    }
    static std::vector<unsigned char> outside(const std::vector<unsigned char>& edges) {
        std::vector<unsigned char> mask;
        for (const unsigned char edge : edges) mask.push_back(edge == 0 ? 1 : 0);
        return mask;
    }

    OffscreenContext context_;
    OffscreenTarget target_;
    city::CityModel city_ = test::boxCity();
    std::vector<vehicles::VehicleModel> models_;
    std::unique_ptr<SceneRenderer> renderer_;
    std::unique_ptr<RayTracer> tracer_;
    View view_;
    FrameScene frame_;
};

constexpr TraceOptions plain{1, 1, true, 1};
/// A quarter of an 8-bit step. Rounding to steps is off by 0.29 of one in a pixel (uniform: 1/sqrt(12)), by
/// 0.02 in the mean of 200; weights of filtered textures, of 8 bits too, shift whole surfaces: by 0.15 at
/// most where measured.
constexpr double mostBias = 0.25 / 255;

TEST_F(TruthGlTest, plainPaintTracedIsPlainPaintDrawn) {
    for (const bool night : {false, true}) {
        frame_.lighting = night ? lightingAt(23) : Lighting{};
        const std::vector<glm::vec3> drawn = draw();
        prepareTracer();
        const TracedPicture traced = tracer_->render(view_, plain);
        const std::vector<unsigned char> edges = edgesOf(traced, view_);
        EXPECT_LT(std::count(edges.begin(), edges.end(), 1), size.x * size.y / 4);
        EXPECT_GE(agreement(traced, drawn, outside(edges)), 45) << (night ? "night" : "day");
        for (const SeenKind kind : {SeenKind::sky, SeenKind::city, SeenKind::vehicle}) {
            const std::vector<unsigned char> mask = of(kind, traced, outside(edges));
            ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 200) << static_cast<int>(kind);
            EXPECT_GE(agreement(traced, drawn, mask), 45) << static_cast<int>(kind);
            EXPECT_LE(brighter(traced, drawn, mask), mostBias) << static_cast<int>(kind);
        }
        // What the comparison is worth: 5% more of one light fails it for each kind of thing that it falls
        // on.
        struct Light {
            glm::vec3 Lighting::*irradiance;
            std::vector<SeenKind> seenOn;
        };
        for (const Light& light :
             {Light{&Lighting::skyIrradiance, {SeenKind::sky, SeenKind::city, SeenKind::vehicle}},
              Light{&Lighting::sunIrradiance, {SeenKind::city}},
              Light{&Lighting::groundIrradiance, {SeenKind::vehicle}}}) {
            FrameScene other = frame_;
            other.lighting.*light.irradiance *= 1.05f;
            tracer_->prepare(other);
            tracer_->useSunMap(renderer_->sunMap());
            const TracedPicture brightened = tracer_->render(view_, plain);
            for (const SeenKind kind : light.seenOn)
                EXPECT_GT(brighter(brightened, drawn, of(kind, traced, outside(edges))), mostBias)
                    << static_cast<int>(kind);
        }
    }
}

TEST_F(TruthGlTest, raysToTheSunCastTheShadowsOfTheMap) {
    const std::vector<glm::vec3> drawn = draw();
    prepareTracer();
    const TracedPicture traced = tracer_->render(view_, plain);
    const std::vector<unsigned char> mask = outside(edgesOf(traced, view_));
    tracer_->useSunMap(nullptr);
    const double byRays = agreement(tracer_->render(view_, plain), drawn, mask);
    tracer_->useSunMap(std::make_shared<SunMap>());
    const double withoutShadows = agreement(tracer_->render(view_, plain), drawn, mask);
    // Shadows end within a texel of the map of each other.
    EXPECT_GT(byRays, 25);
    EXPECT_LT(withoutShadows, byRays - 5);
}

TEST_F(TruthGlTest, tracedLightDrawnIsTheTracedPicture) {
    draw();
    prepareTracer();
    const TracedPicture traced = tracer_->render(view_, {4, 2, false, 1});
    const MirroredLight light = traced.mirroredLight();
    reflection::ScreenLight screen;
    screen.upload(light.radiance, light.size, light.low, light.high);
    VehicleReflections reflections;
    reflections.mirrored = screen.name();
    const std::vector<glm::vec3> composed = draw(reflections);
    std::vector<unsigned char> mask = outside(edgesOf(traced, view_));
    for (std::size_t i = 0; i < mask.size(); ++i)
        if (traced.kind[i] != SeenKind::vehicle) mask[i] = 0;
    ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 200);
    EXPECT_GE(agreement(traced, composed, mask), 45);
    EXPECT_LT(agreement(traced, draw(), mask), 35);  // plain paint is another picture
}

TEST_F(TruthGlTest, windowsDrawnAreWindowsTraced) {
    // Curtain walls along the street; one repeat of their picture is 4 m.
    for (const std::size_t material : {1u, 2u, 3u, 4u})
        city_.materials[material].pattern = city::Pattern::facadeGlass;
    for (city::Chunk& chunk : city_.chunks)
        if (chunk.kind == city::ChunkKind::building)
            for (city::Vertex& v : chunk.mesh.vertices) v.texcoord *= 0.25f;
    const city::GlassFronts glass = city::glassFronts(city_);
    ASSERT_GT(glass.fronts.size(), 20u);
    RenderOptions options;
    options.antialiasing = Antialiasing::none;
    renderer_ = std::make_unique<SceneRenderer>(city_, models_, options);
    renderer_->setGlass(glass.fronts);
    tracer_ = std::make_unique<RayTracer>(city_, models_);
    if (reflection::softwareRenderer()) tracer_->useTextureFilter(TextureFilter::llvmpipe);
    view_ = lookAt({-12, 2, 2.5}, {0, 14, 3.5}, glm::radians(60.0), size);
    frame_.views = {view_};
    renderer_->prepare(frame_);
    const MirrorPlanner planner(glass.fronts);
    const OffscreenTarget target(size);
    double before = 0;
    // Without fading by one mirror more each time; then both fading: each mirror by the way behind it.
    for (const auto& [depth, fade] : {std::pair(0, 0.0), {1, 0.0}, {2, 0.0}, {2, 8.0}}) {
        MirrorSettings settings;
        settings.depth = depth;
        settings.fade = fade;
        settings.maps = settings.mostFronts = 200;
        settings.leastPixels = 1;
        settings.reach = 1000;
        settings.levelScale = 1;
        settings.economies.cutOff = settings.economies.detail = false;
        const MirrorPlan plan = planner.plan(frame_.views, settings);
        renderer_->prepare(frame_);
        renderer_->drawView(view_, {}, target.framebuffer(), {&plan, 0});
        const Image8 image = readPixels(target.framebuffer(), size);
        std::vector<glm::vec3> drawn(image.rgba.size() / 4);
        for (std::size_t i = 0; i < drawn.size(); ++i)
            drawn[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
        prepareTracer();
        TraceOptions trace = plain;
        trace.windows = 2;
        trace.mirrorFade = static_cast<float>(fade);
        const TracedPicture traced = tracer_->render(view_, trace);
        std::vector<unsigned char> mask = outside(edgesOf(traced, view_));
        for (std::size_t i = 0; i < mask.size(); ++i)
            if (traced.kind[i] != SeenKind::glass) mask[i] = 0;
        ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 2000);
        const double decibels = agreement(traced, drawn, mask);
        RecordProperty("depth" + std::to_string(depth) + (fade > 0 ? "fading" : ""),
                       std::to_string(decibels));
        // Outlines within what is mirrored are not told apart, and fall on either side of a pixel.
        if (depth == 1) {
            EXPECT_GT(decibels, before + 3);
        }
        if (depth == 2) {
            EXPECT_GE(decibels, 30);
        }
        if (fade > 0) {
            for (const float other : {0.0f, 16.0f, 4.0f}) {
                trace.mirrorFade = other;
                EXPECT_LT(agreement(tracer_->render(view_, trace), drawn, mask),
                          decibels - (other > 0 ? 0.5 : 6))
                    << other;
            }
        }
        before = decibels;
    }
}

TEST_F(TruthGlTest, wetStreetsDrawnAreWetStreetsTraced) {
    const city::GlassFronts none;
    renderer_->setGlass(none.fronts);
    renderer_->prepare(frame_);
    const MirrorPlanner planner(none.fronts);
    MirrorSettings settings;
    settings.wetRoad = 0;
    const MirrorPlan plan = planner.plan(frame_.views, settings);
    ASSERT_TRUE(plan.counters.road);
    const auto wetDrawn = [&](const PlanarReflections& planar) {
        renderer_->drawView(view_, {}, target_.framebuffer(), planar);
        const Image8 image = readPixels(target_.framebuffer(), size);
        std::vector<glm::vec3> drawn(image.rgba.size() / 4);
        for (std::size_t i = 0; i < drawn.size(); ++i)
            drawn[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
        return drawn;
    };
    const std::vector<glm::vec3> dull = wetDrawn({nullptr, 0, true}), shining = wetDrawn({&plan, 0, true}),
                                 dry = wetDrawn({});
    prepareTracer();
    TraceOptions trace = plain;
    trace.wet = true;
    const TracedPicture withoutImage = tracer_->render(view_, trace);
    trace.windows = 2;
    const TracedPicture withImage = tracer_->render(view_, trace);
    const std::vector<unsigned char> mask =
        of(SeenKind::water, withImage, outside(edgesOf(withImage, view_)));
    ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 2000);
    // With none mirrored both are the same; rounding of places, from which puddles follow, moves their shores
    // by parts of a pixel.
    EXPECT_GE(agreement(withoutImage, dull, mask), 45);
    EXPECT_LT(agreement(withoutImage, dry, mask), 30);
    // Mirrored, outlines within the image are not told apart.
    EXPECT_GE(agreement(withImage, shining, mask), 30);
    EXPECT_GT(agreement(withImage, shining, mask), agreement(withImage, dull, mask) + 6);
}

TEST(ScreenLightTest, sharedExponentKeepsNineBitsOfTheBrightest) {
    for (const glm::vec3 v :
         {glm::vec3(0), glm::vec3(1, 0.5f, 0.25f), glm::vec3(200, 3, 0.01f), glm::vec3(0.9999f, 0.2f, 0.1f),
          glm::vec3(1e-4f, 3e-5f, 0), glm::vec3(1e9f, 0, 0), glm::vec3(-1, NAN, 2)}) {
        const std::uint32_t word = reflection::packSharedExponent(v);
        const float scale = std::ldexp(1.0f, static_cast<int>(word >> 27) - 24);
        const glm::vec3 kept = glm::vec3(word & 511, word >> 9 & 511, word >> 18 & 511) * scale;
        float brightest = 0;
        for (int c = 0; c < 3; ++c) brightest = std::max(brightest, v[c] > 0 ? std::min(v[c], 65408.0f) : 0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(kept[c], v[c] > 0 ? std::min(v[c], 65408.0f) : 0, brightest / 511 + 1e-7f) << v[c];
    }
}

}  // namespace
}  // namespace app
