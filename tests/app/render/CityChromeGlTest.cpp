// Close things in a chrome sphere of the city, against rays and against an environment map drawn anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/StandingReflectors.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "city/terrain/Heightfield.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/ScreenLight.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/raytrace/MirrorWorld.h"
#include "tests/app/render/WritePng.h"

namespace app {
namespace {

constexpr glm::ivec2 size(320, 240);

class CityChromeGlTest : public testing::Test {
  public:
    ~CityChromeGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    CityChromeGlTest() : target_(size) { city_.materials[0].pattern = city::Pattern::cobbles; }

    void stand(city::StandingReflector::Shape shape, float radius, float height) {
        city_.reflectors.push_back(
            {"mirror", shape, city::StandingReflector::Stuff::chrome, {0, 0, 0.2f}, radius, height});
        city::Prototype post;
        post.levels.emplace_back();
        test::addBox(post.levels.back().mesh, {-0.1f, -0.1f, 0}, {0.1f, 0.1f, 1.2f}, 1);
        city_.prototypes.push_back(post);
        city_.placements.emplace_back().worldFromPrototype[3] = glm::vec4(1.2f, -1.2f, 0, 1);
        models_ = {test::boxCar(), standingModels(city_).front()};
        RenderOptions options;
        options.antialiasing = Antialiasing::none;
        renderer_ = std::make_unique<SceneRenderer>(city_, models_, options);
        close_ = std::make_unique<CloseScene>(city_, models_);
        renderer_->setCloseScene(close_.get());
        view_ = lookAt({3.6, -2.2, 1.7}, {0, 0, 1.2}, glm::radians(40.0), size);
        frame_.vehicles = standingPoses(city_, 1);
        // A car of two metres' width passes half a metre from the sphere.
        frame_.vehicles.push_back(test::poseAt(1, 0, {0.5, 2.5, 0}, 0.1));
        frame_.vehicles.back().paint = {0.5f, 0.05f, 0.04f};
        frame_.lighting = lightingAt(15, 50);
        frame_.views = {view_};
        city::Heightfield field(8, 8, 50, {-200, -200});
        tracer_ = std::make_unique<reflection::GridTracer>(field);
        ReflectionSettings settings;
        settings.method = ReflectionMethod::rerender;
        engine_ = std::make_unique<ReflectionEngine>(*tracer_, maps_, models_, settings);
    }

    /// FLIP against rays on the mirror's pixels, with and without close chrome.
    void compare(const std::string& name, double& ours, double& theirs);

    ChromePlan plan() const {
        const std::vector<std::uint32_t> seen{0, 1};
        return planChrome(frame_, seen, models_, close_->parts, {});
    }
    std::vector<glm::vec3> draw(const VehicleReflections& reflections, const ChromePlan* chrome,
                                const ChromeDrawing& drawing = {}) {
        renderer_->drawView(view_, reflections, target_.framebuffer(), {}, {chrome, 0, drawing});
        return toFloat(readPixels(target_.framebuffer(), size));
    }
    VehicleReflections rerendered() {
        renderer_->prepare(frame_);
        const std::vector<SeenVehicle> seen{{0, 200}, {1, 200}};
        const ReflectionPlan& made = engine_->update(frame_, seen, *renderer_);
        return {engine_->textures(), made.slots, 0};
    }
    static std::vector<glm::vec3> toFloat(const Image8& image) {
        std::vector<glm::vec3> pixels(image.rgba.size() / 4);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
        return pixels;
    }
    void write(const std::string& name, const std::vector<glm::vec3>& pixels) const {
        Image8 image{size, {}};
        for (const glm::vec3& c : pixels) {
            for (int k = 0; k < 3; ++k)
                image.rgba.push_back(static_cast<std::uint8_t>(255 * glm::clamp(c[k], 0.f, 1.f) + 0.5f));
            image.rgba.push_back(255);
        }
        test::writePng(name, image);
    }

    OffscreenContext context_;
    reflection::gl::DebugOutput debug_;
    OffscreenTarget target_;
    city::CityModel city_ = test::boxCity();
    std::vector<vehicles::VehicleModel> models_;
    std::unique_ptr<SceneRenderer> renderer_;
    std::unique_ptr<CloseScene> close_;
    View view_;
    FrameScene frame_;
    std::vector<reflection::PackedReferenceMap> maps_;
    std::unique_ptr<reflection::GridTracer> tracer_;
    std::unique_ptr<ReflectionEngine> engine_;
};

void CityChromeGlTest::compare(const std::string& name, double& ours, double& theirs) {
    const ChromePlan chrome = plan();
    ASSERT_EQ(chrome.jobs.size(), 1u);
    ASSERT_EQ(chrome.jobs[0].close.size(), 1u);
    ASSERT_EQ(chrome.jobs[0].share, 1);
    RayTracer rays(city_, models_);
    rays.prepare(frame_);
    renderer_->prepare(frame_);
    rays.useSunMap(renderer_->sunMap());
    if (reflection::softwareRenderer()) rays.useTextureFilter(TextureFilter::llvmpipe);
    TraceOptions many;
    many.samples = 16;
    many.bounces = 2;
    const TracedPicture traced = rays.render(view_, many);
    std::vector<unsigned char> mask(traced.kind.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = traced.kind[i] == SeenKind::vehicle && traced.vehicle[i] >= firstStandingId ? 1 : 0;
    const std::vector<glm::vec3> truth = traced.display(frame_.lighting.exposure);

    const VehicleReflections maps = rerendered();
    const std::vector<glm::vec3> plain = draw(maps, nullptr), close = draw(maps, &chrome);
    const ChromeCounts counts = renderer_->counters().chrome;
    EXPECT_EQ(counts.jobs, 1u);
    EXPECT_GT(counts.meshes, 2u);
    EXPECT_GT(counts.searched, 100u);
    EXPECT_GT(renderer_->counters().chromeTextureBytes, 0u);
    write("city_" + name, close);
    write("city_" + name + "_rerender", plain);
    write("city_" + name + "_truth", truth);
    const auto flipOf = [&](const std::vector<glm::vec3>& image) {
        return reflection::meanError(reflection::flip({size.x, size.y, image}, {size.x, size.y, truth}),
                                     mask);
    };
    ours = flipOf(close);
    theirs = flipOf(plain);
    RecordProperty("flip_chrome", std::to_string(ours));
    RecordProperty("flip_rerender", std::to_string(theirs));
    // What does not mirror is as it was, but for pixels of the outline on which rays and triangles disagree.
    std::size_t changed = 0;
    for (std::size_t i = 0; i < mask.size(); ++i)
        changed += traced.kind[i] != SeenKind::vehicle && plain[i] != close[i];
    EXPECT_LT(changed, 8u);
}

TEST_F(CityChromeGlTest, aSphereBesideACarShowsItWhereRaysMeetIt) {
    stand(city::StandingReflector::Shape::sphere, 1, 2);
    double ours = 1, theirs = 0;
    compare("sphere", ours, theirs);
    EXPECT_LT(ours, 0.5 * theirs) << ours << " against " << theirs;
}

TEST_F(CityChromeGlTest, aPillarBesideACarShowsItWhereRaysMeetIt) {
    stand(city::StandingReflector::Shape::pillar, 0.5f, 4);
    double ours = 1, theirs = 0;
    compare("pillar", ours, theirs);
    // Over its whole height it mirrors what is too far to be drawn close, stretched as the map has it.
    EXPECT_LT(ours, 0.65 * theirs) << ours << " against " << theirs;
}

TEST_F(CityChromeGlTest, withoutJobsThePictureIsTheSameAndNothingIsMade) {
    stand(city::StandingReflector::Shape::sphere, 1, 2);
    const VehicleReflections maps = rerendered();
    const std::vector<glm::vec3> plain = draw(maps, nullptr);
    ChromePlanOptions off;
    off.on = false;
    const std::vector<std::uint32_t> seen{0, 1};
    const ChromePlan none = planChrome(frame_, seen, models_, close_->parts, off);
    EXPECT_EQ(draw(maps, &none), plain);
    EXPECT_EQ(renderer_->counters().chrome.jobs, 0u);
    EXPECT_EQ(renderer_->counters().chromeTextureBytes, 0u);
    EXPECT_EQ(close_->parts.reflectorsMade(), 0u);
    // A share of nothing shows nothing, and small shares little.
    ChromePlan faint = plan();
    for (ChromeJob& job : faint.jobs) job.share = 0;
    EXPECT_EQ(draw(maps, &faint), plain);
    for (ChromeJob& job : faint.jobs) job.share = 0.02f;
    const std::vector<glm::vec3> barely = draw(maps, &faint);
    float most = 0;
    for (std::size_t i = 0; i < plain.size(); ++i)
        for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(plain[i][k] - barely[i][k]));
    EXPECT_GT(most, 0);
    EXPECT_LT(most, 0.1f);
}

TEST_F(CityChromeGlTest, whatStandsIsNeitherSearchedForNorDrawnAnew) {
    stand(city::StandingReflector::Shape::sphere, 1, 2);
    VehicleReflections maps = rerendered();
    maps.renewed.emplace();
    const auto counts = [&] { return renderer_->counters().chrome; };
    const ChromePlan first = plan();
    const std::vector<glm::vec3> before = draw(maps, &first);
    EXPECT_EQ(counts().drawn, 1u);
    EXPECT_GT(counts().searched, 100u);
    EXPECT_EQ(draw(maps, &first), before);
    EXPECT_EQ(counts().drawn, 0u);
    EXPECT_EQ(counts().searched, 0u);
    // Frames without it change nothing in what is kept.
    draw(maps, nullptr);
    EXPECT_EQ(draw(maps, &first), before);
    EXPECT_EQ(counts().drawn, 0u);
    // A map that is another one does, and so do a share and a car that moved; each as if all were drawn.
    maps.renewed->push_back(maps.slots[1]);
    EXPECT_EQ(draw(maps, &first), before);
    EXPECT_EQ(counts().drawn, 1u);
    maps.renewed->clear();
    ChromePlan half = first;
    half.jobs[0].share = 0.5f;
    EXPECT_NE(draw(maps, &half), before);
    EXPECT_EQ(counts().drawn, 1u);
    frame_.vehicles.back().position.y += 0.3;
    renderer_->prepare(frame_);
    const ChromePlan moved = plan();
    const std::vector<glm::vec3> after = draw(maps, &moved);
    EXPECT_EQ(counts().drawn, 1u);
    EXPECT_GT(counts().searched, 100u);
    EXPECT_NE(after, before);
    maps.renewed.reset();
    EXPECT_EQ(draw(maps, &moved), after);
    EXPECT_EQ(counts().drawn, 1u);
    // The same view after another one.
    view_ = lookAt({3.2, -2.6, 1.7}, {0, 0, 1.2}, glm::radians(40.0), size);
    frame_.views = {view_};
    const ChromePlan other = plan();
    draw(maps, &other);
    EXPECT_EQ(counts().drawn, 1u);
}

}  // namespace
}  // namespace app
