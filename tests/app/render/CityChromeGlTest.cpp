// Close things in a chrome sphere of the city, against rays and against an environment map drawn anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <optional>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/StandingReflectors.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "city/terrain/Heightfield.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/ScreenLight.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/raytrace/MirrorWorld.h"
#include "tests/app/render/TracedTruth.h"
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
        // A car of two metres' width passes half a metre from the sphere.
        build(lookAt({3.6, -2.2, 1.7}, {0, 0, 1.2}, glm::radians(40.0), size),
              test::poseAt(1, 0, {0.5, 2.5, 0}, 0.1));
    }
    /// What draws the city as it stands, a car in it, seen so.
    void build(const View& view, const vehicles::VehiclePose& car) {
        models_ = {test::boxCar()};
        for (const vehicles::VehicleModel& model : standingModels(city_)) models_.push_back(model);
        RenderOptions options;
        options.antialiasing = Antialiasing::none;
        renderer_ = std::make_unique<SceneRenderer>(city_, models_, options);
        close_ = std::make_unique<CloseScene>(city_, models_);
        renderer_->setCloseScene(close_.get());
        view_ = view;
        frame_.vehicles = standingPoses(city_, 1);
        frame_.vehicles.push_back(car);
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
    const TracedPicture traced = test::tracedTruth(city_, models_, frame_, *renderer_, 2);
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

// Two spheres beside each other, with posts about them: what the right one mirrors is seen in the left one.
class CityChromeBouncesGlTest : public CityChromeGlTest {
  protected:
    static constexpr float radius = 1;
    static inline const glm::vec3 left{0, 0, 1.2f}, right{0.2f, 2.6f, 1.2f};

    CityChromeBouncesGlTest() {
        for (const glm::vec3& centre : {left, right})
            city_.reflectors.push_back({"ball", city::StandingReflector::Shape::sphere,
                                        city::StandingReflector::Stuff::chrome,
                                        centre - glm::vec3(0, 0, radius), radius, 2 * radius});
        const auto post = [&](const glm::vec3& at, float height, float wide, std::uint32_t material) {
            city::Prototype box;
            box.levels.emplace_back();
            test::addBox(box.levels.back().mesh, {-wide, -wide, 0}, {wide, wide, height}, material);
            city_.prototypes.push_back(box);
            city::Placement& placed = city_.placements.emplace_back();
            placed.prototype = static_cast<std::uint32_t>(city_.prototypes.size() - 1);
            placed.worldFromPrototype[3] = glm::vec4(at, 1);
        };
        post({1.4f, 1.3f, 0}, 0.7f, 0.15f, 1);
        post({-1.5f, 2.2f, 0}, 2.2f, 0.2f, 1);
        post({1.8f, 3.4f, 0}, 1.6f, 0.2f, 1);
        build(lookAt({3.2, -0.6, 1.7}, {0, 0.3, 1.2}, glm::radians(40.0), size),
              test::poseAt(1, 0, {1.2, 5.2, 0}, 0.1));
    }

    ChromePlan planned() const {
        const std::vector<std::uint32_t> seen{0, 1, 2};
        return planChrome(frame_, seen, models_, close_->parts, {});
    }
    static std::optional<double> meets(const glm::dvec3& from, const glm::dvec3& towards,
                                       const glm::dvec3& centre) {
        const glm::dvec3 c = centre - from;
        const double along = glm::dot(c, towards),
                     left2 = double{radius} * radius - glm::dot(c, c) + along * along;
        if (along <= 0 || left2 <= 0) return {};
        return along - std::sqrt(left2);
    }
    /// Pixels that show one ball within the other.
    std::vector<unsigned char> metTwice() const {
        std::vector<unsigned char> mask(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
        const glm::dmat4 relativeFromClip =
            glm::inverse(glm::dmat4(view_.clipFromView * view_.viewFromWorld));
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                // Pictures' rows run downwards.
                const glm::dvec4 p = relativeFromClip * glm::dvec4((x + 0.5) / size.x * 2 - 1,
                                                                   1 - (y + 0.5) / size.y * 2, 0.5, 1);
                const glm::dvec3 d = glm::normalize(glm::dvec3(p) / p.w);
                for (const bool first : {true, false}) {
                    const glm::dvec3 a(first ? left : right), b(first ? right : left);
                    const std::optional<double> t = meets(view_.eye, d, a);
                    if (!t) continue;
                    const glm::dvec3 at = view_.eye + *t * d, n = glm::normalize(at - a);
                    if (meets(at, d - 2.0 * glm::dot(d, n) * n, b))
                        mask[static_cast<std::size_t>(y * size.x + x)] = 1;
                }
            }
        return mask;
    }
};

TEST_F(CityChromeBouncesGlTest, aBallSeenInAnotherMirrorsWhatIsCloseToIt) {
    const ChromePlan chrome = planned();
    ASSERT_EQ(chrome.jobs.size(), 2u);
    const std::vector<glm::vec3> truth =
        test::tracedTruth(city_, models_, frame_, *renderer_, 3).display(frame_.lighting.exposure);
    const std::vector<unsigned char> mask = metTwice();
    ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 500);
    renderer_->prepare(frame_);
    const std::vector<SeenVehicle> seen{{0, 200}, {1, 200}, {2, 200}};
    const ReflectionPlan& made = engine_->update(frame_, seen, *renderer_);
    const VehicleReflections maps{engine_->textures(), made.slots, 0};
    std::array<double, 4> errors{};
    for (const int bounces : {1, 2, 3}) {
        ChromeDrawing drawing;
        drawing.bounces = bounces;
        const std::vector<glm::vec3> image = draw(maps, &chrome, drawing);
        const ChromeCounts& counts = renderer_->counters().chrome;
        EXPECT_EQ(counts.bounces.pictures, bounces == 1 ? 0u : bounces == 2 ? 2u : counts.bounces.pictures);
        EXPECT_EQ(counts.bounces.drawn, counts.bounces.pictures);
        const reflection::ImageView a{size.x, size.y, image}, b{size.x, size.y, truth};
        errors[static_cast<std::size_t>(bounces)] = reflection::meanError(reflection::flip(a, b), mask);
        RecordProperty("flip_" + std::to_string(bounces),
                       std::to_string(errors[static_cast<std::size_t>(bounces)]));
        write("city_bounces_" + std::to_string(bounces), image);
    }
    write("city_bounces_truth", truth);
    EXPECT_LT(errors[2], 0.6 * errors[1]) << errors[2] << " against " << errors[1];
    EXPECT_LE(errors[3], 1.02 * errors[2]) << errors[3] << " against " << errors[2];
}

TEST_F(CityChromeBouncesGlTest, picturesStayWhileNothingMovesAndGoOnWhenItDoes) {
    renderer_->prepare(frame_);
    const std::vector<SeenVehicle> seen{{0, 200}, {1, 200}, {2, 200}};
    const ReflectionPlan& made = engine_->update(frame_, seen, *renderer_);
    VehicleReflections maps{engine_->textures(), made.slots, 0};
    maps.renewed.emplace();
    const auto counts = [&] { return renderer_->counters().chrome; };
    const ChromePlan first = planned();
    ChromeDrawing two, one;
    two.bounces = 2;
    const std::vector<glm::vec3> before = draw(maps, &first, two);
    EXPECT_EQ(counts().bounces.pictures, 2u);
    EXPECT_EQ(draw(maps, &first, two), before);
    EXPECT_EQ(counts().bounces.pictures, 2u);
    EXPECT_EQ(counts().bounces.drawn, 0u);
    EXPECT_EQ(counts().drawn, 0u);
    EXPECT_EQ(counts().searched, 0u);
    // With one bounce, and back.
    const std::vector<glm::vec3> plain = draw(maps, &first, one);
    EXPECT_EQ(counts().bounces.pictures, 0u);
    EXPECT_NE(plain, before);
    EXPECT_EQ(draw(maps, &first, two), before);
    // The car in the right ball moves: as if all were drawn anew.
    frame_.vehicles.back().position.y += 0.3;
    renderer_->prepare(frame_);
    const ChromePlan moved = planned();
    const std::vector<glm::vec3> after = draw(maps, &moved, two);
    EXPECT_GT(counts().bounces.drawn, 0u);
    EXPECT_NE(after, before);
    maps.renewed.reset();
    EXPECT_EQ(draw(maps, &moved, two), after);
}

}  // namespace
}  // namespace app
