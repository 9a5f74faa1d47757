// A saloon's bumper with a cyclist passing at 0.3 m: what close chrome shows, against rays, the local map and
// a map drawn anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/CloseMeshes.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "city/model/CityHeightfield.h"
#include "reflection/gl/BakeReferenceMaps.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/truth/ImageError.h"
#include "tests/app/raytrace/MirrorWorld.h"
#include "tests/app/render/TracedTruth.h"
#include "tests/app/render/WritePng.h"
#include "vehicles/models/Bodies.h"

namespace app {
namespace {

constexpr glm::ivec2 size(480, 270);
using Pixels = std::vector<glm::vec3>;

class BumperGlTest : public testing::Test {
  public:
    ~BumperGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    BumperGlTest() : target_(size) {
        city_.materials[0].pattern = city::Pattern::cobbles;
        RenderOptions options;
        options.antialiasing = Antialiasing::none;
        renderer_ = std::make_unique<SceneRenderer>(city_, models_, options);
        close_ = std::make_unique<CloseScene>(city_, models_);
        renderer_->setCloseScene(close_.get());
        const std::uint32_t saloon = 0, cyclist = 1;
        const double front = 0.5 * models_[saloon].length;
        frame_.lighting = lightingAt(15, 50);
        frame_.vehicles = {test::poseAt(1, saloon, {0, 0, 0}, 0)};
        frame_.vehicles[0].paint = {0.02f, 0.05f, 0.12f};
        renderer_->prepare(frame_);
        // Half the handlebar's width and 0.3 m before the bumper, riding to the left of who looks.
        passing_ = test::poseAt(2, cyclist, {front + 0.3 + 0.3, 1.5, 0}, glm::radians(90.0));
        passing_.paint = {0.75f, 0.35f, 0.02f};
        view_ = lookAt({front + 0.7, 0.35, 0.75}, {front - 0.1, 0.75, 0.5}, glm::radians(40.0), size);
        frame_.views = {view_};
        FrameScene empty = frame_;
        empty.vehicles.clear();
        renderer_->prepare(empty);
        const std::vector<glm::dvec3> places{{2, 4, 2.5}, {-6, 4, 2.5}};
        maps_ = reflection::bakeReferenceMaps(*renderer_, places, nullptr, {128, 1},
                                              [](std::size_t, std::size_t) { return true; })
                    .maps;
        frame_.vehicles.push_back(passing_);
    }

    /// The frame, with its car's map by a method, and with close chrome or without.
    Pixels draw(const FrameScene& frame, ReflectionMethod method, bool chrome, const std::string& name) {
        ReflectionSettings settings;
        settings.method = method;
        settings.everyFrame = true;
        ReflectionEngine engine(tracer_, maps_, models_, settings);
        renderer_->prepare(frame);
        const std::vector<SeenVehicle> seen{{0, 400}};
        const ReflectionPlan& made = engine.update(frame, seen, *renderer_);
        ChromePlan plan;
        const std::vector<std::uint32_t> indices{0};
        if (chrome) plan = planChrome(frame, indices, models_, close_->parts, {});
        jobs_ = plan.jobs.size();
        renderer_->drawView(view_, {engine.textures(), made.slots, 0}, target_.framebuffer(), {},
                            {chrome ? &plan : nullptr, 0, {}});
        const Image8 image = readPixels(target_.framebuffer(), size);
        test::writePng("bumper_" + name, image);
        Pixels pixels(image.rgba.size() / 4);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = glm::vec3(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]) / 255.0f;
        return pixels;
    }

    /// What is true, and the saloon's chrome in it.
    void trace(Pixels& truth, std::vector<unsigned char>& mask) {
        const TracedPicture traced = test::tracedTruth(city_, models_, frame_, *renderer_, 2);
        truth = traced.display(frame_.lighting.exposure);
        mask.assign(traced.kind.size(), 0);
        for (std::size_t i = 0; i < mask.size(); ++i)
            mask[i] = traced.kind[i] == SeenKind::vehicle && traced.vehicle[i] == 1 &&
                              traced.surface[i] == static_cast<std::uint32_t>(vehicles::Surface::chrome)
                          ? 1
                          : 0;
        Image8 image{size, {}};
        for (const glm::vec3& c : truth) {
            for (int k = 0; k < 3; ++k)
                image.rgba.push_back(static_cast<std::uint8_t>(255 * glm::clamp(c[k], 0.f, 1.f) + 0.5f));
            image.rgba.push_back(255);
        }
        test::writePng("bumper_truth", image);
    }

    OffscreenContext context_;
    reflection::gl::DebugOutput debug_;
    OffscreenTarget target_;
    city::CityModel city_ = test::boxCity();
    std::vector<vehicles::VehicleModel> models_{vehicles::saloon(), vehicles::cyclist()};
    std::unique_ptr<SceneRenderer> renderer_;
    std::unique_ptr<CloseScene> close_;
    View view_;
    FrameScene frame_;
    vehicles::VehiclePose passing_;
    std::vector<reflection::PackedReferenceMap> maps_;
    reflection::GridTracer tracer_{city::cityHeightfield(city_)};
    std::size_t jobs_ = 0;
};

TEST_F(BumperGlTest, aCyclistIsWhereRaysMeetHim) {
    Pixels truth;
    std::vector<unsigned char> mask;
    trace(truth, mask);
    ASSERT_GT(std::count(mask.begin(), mask.end(), 1), 4000);
    const auto flipOf = [&](const Pixels& image) {
        return reflection::meanError(reflection::flip({size.x, size.y, image}, {size.x, size.y, truth}),
                                     mask);
    };
    const double mem = flipOf(draw(frame_, ReflectionMethod::mem, false, "mem"));
    const double drawnAnew = flipOf(draw(frame_, ReflectionMethod::rerender, false, "rerender"));
    const double ours = flipOf(draw(frame_, ReflectionMethod::mem, true, "chrome"));
    EXPECT_GE(jobs_, 1u);
    RecordProperty("flip_chrome", std::to_string(ours));
    RecordProperty("flip_mem", std::to_string(mem));
    RecordProperty("flip_rerender", std::to_string(drawnAnew));
    EXPECT_LT(ours, mem);
    EXPECT_LT(ours, 0.55 * drawnAnew);

    // The same pixels, were he missing, elsewhere, or turned round: each must be told from where he is.
    FrameScene other = frame_;
    other.vehicles.pop_back();
    EXPECT_LT(ours, 0.95 * flipOf(draw(other, ReflectionMethod::mem, true, "missing"))) << "missing";
    for (const double along : {-0.3, 0.3}) {
        other = frame_;
        other.vehicles[1].position.y += along;
        EXPECT_LT(ours, 0.97 * flipOf(draw(other, ReflectionMethod::mem, true, "displaced")))
            << "displaced by " << along;
    }
    other = frame_;
    other.vehicles[1].heading += glm::radians(180.0);
    EXPECT_LT(ours, 0.97 * flipOf(draw(other, ReflectionMethod::mem, true, "turned"))) << "turned round";
}

// The bumper shows the body above it, at every level of detail, and never itself: its own triangles lie where
// images are torn.
TEST(CloseMeshesTest, aPartIsNotBesidesItself) {
    const std::vector<vehicles::VehicleModel> models{vehicles::saloon()};
    const ChromeParts parts(models);
    std::uint32_t checked = 0;
    for (std::uint32_t number = 0; number < parts.of(0).size(); ++number) {
        const ChromePart& part = parts.of(0)[number];
        if (part.onWheel || !part.closed || !part.convex || part.width < 0.08f) continue;
        ++checked;
        const city::Mesh& own = parts.meshOf(part);
        CloseVehicles vehicles(models);
        for (const float allowed : {0.f, 0.01f, 0.05f}) {
            const CloseMesh* mesh = vehicles.besides(0, part, number, parts.reflectorOf(part), allowed);
            ASSERT_NE(mesh, nullptr) << "off by " << allowed;
            float nearest = 1e9f;
            for (const glm::vec3& p : mesh->positions) {
                const glm::vec3 off = glm::abs(p - part.centre) - part.half;
                nearest = std::min(nearest, glm::length(glm::max(off, glm::vec3(0))));
            }
            EXPECT_LT(nearest, 0.05f) << "the body that it is fixed to is missing";
            std::size_t itself = 0;
            for (std::size_t k = 0; k + 2 < mesh->indices.size(); k += 3) {
                bool all = true;
                for (std::size_t c = 0; c < 3; ++c) {
                    const glm::vec3 p = mesh->positions[mesh->indices[k + c]] - part.centre;
                    all = all && std::ranges::any_of(own.vertices, [&](const city::Vertex& v) {
                              return glm::distance(v.position, p) < 1e-4f;
                          });
                }
                itself += all;
            }
            EXPECT_EQ(itself, 0u) << "off by " << allowed;
        }
    }
    EXPECT_GE(checked, 1u);
}

}  // namespace
}  // namespace app
