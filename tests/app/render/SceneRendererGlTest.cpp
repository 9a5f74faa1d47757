#include "app/render/SceneRenderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/display/OffscreenContext.h"
#include "app/frame/StandingReflectors.h"
#include "app/render/Readback.h"
#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/app/render/WritePng.h"

namespace app {
namespace {

namespace gl = reflection::gl;

class SceneRendererGlTest : public testing::Test {
  public:
    SceneRendererGlTest() {
        colour_ = gl::Texture::image2D(GL_RGBA8, size_.x, size_.y);
        framebuffer_ = gl::Framebuffer::create();
        framebuffer_.attach(GL_COLOR_ATTACHMENT0, colour_.name());
        scene_.vehicles.resize(3);
        for (std::uint32_t i = 0; i < 3; ++i) {
            scene_.vehicles[i].id = i;
            scene_.vehicles[i].position = {8.0 * i, -3.0, 0};
            scene_.vehicles[i].paint = {0.5f, 0.05f * static_cast<float>(i), 0.05f};
        }
    }
    ~SceneRendererGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    Image8 draw(SceneRenderer& renderer, const View& view, const VehicleReflections& reflections = {}) {
        scene_.views = {view};
        renderer.prepare(scene_);
        renderer.drawView(view, reflections, framebuffer_.name());
        return readPixels(framebuffer_.name(), size_);
    }
    static glm::ivec3 pixel(const Image8& image, int x, int y) {
        const std::size_t i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.x) +
                                   static_cast<std::size_t>(x));
        return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
    }

    OffscreenContext context_;
    gl::DebugOutput debug_;
    glm::ivec2 size_{640, 360};
    gl::Texture colour_;
    gl::Framebuffer framebuffer_;
    FrameScene scene_;
    std::vector<vehicles::VehicleModel> models_{test::boxCar()};
};

TEST_F(SceneRendererGlTest, drawsStreetCarsAndSky) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, {});
    const View view = lookAt({-14, -5, 3}, {10, -2, 1}, 1.0, size_);
    const Image8 image = draw(renderer, view);
    test::writePng("box-street", image);

    const glm::ivec3 sky = pixel(image, 320, 5);
    EXPECT_GT(sky.b, sky.r);
    EXPECT_GT(sky.b, 100);
    EXPECT_EQ(renderer.counters().vehiclesDrawn, 3u);
    EXPECT_GT(renderer.counters().chunksCulled, 0u);
    EXPECT_GT(renderer.counters().chunksDrawn, 0u);
}

TEST_F(SceneRendererGlTest, everyAntialiasingShowsTheSamePicture) {
    const city::CityModel city = test::boxCity();
    const View view = lookAt({-14, -5, 3}, {10, -2, 1}, 1.0, size_);
    std::vector<Image8> images;
    for (Antialiasing antialiasing : {Antialiasing::none, Antialiasing::fxaa, Antialiasing::msaa4}) {
        RenderOptions options;
        options.antialiasing = antialiasing;
        SceneRenderer renderer(city, models_, options);
        images.push_back(draw(renderer, view));
    }
    for (std::size_t k = 1; k < images.size(); ++k) {
        double sum = 0;
        std::size_t different = 0;
        for (std::size_t i = 0; i < images[0].rgba.size(); ++i) {
            const int d = std::abs(int(images[k].rgba[i]) - int(images[0].rgba[i]));
            sum += d;
            different += d > 4 ? 1 : 0;
        }
        EXPECT_GT(different, 100u) << "edges are not smoothed";
        EXPECT_LT(sum / static_cast<double>(images[0].rgba.size()), 1.5) << "more than edges changed";
    }
}

TEST_F(SceneRendererGlTest, aSmallerPictureIsStretchedOverTheWholeView) {
    const city::CityModel city = test::boxCity();
    const View view = lookAt({-14, -5, 3}, {10, -2, 1}, 1.0, size_);
    for (Antialiasing antialiasing : {Antialiasing::none, Antialiasing::fxaa, Antialiasing::msaa4}) {
        RenderOptions options;
        options.antialiasing = antialiasing;
        SceneRenderer renderer(city, models_, options);
        const Image8 full = draw(renderer, view);
        const auto difference = [&](const DrawingDetail& detail) {
            renderer.setDetail(detail);
            const Image8 image = draw(renderer, view);
            double sum = 0;
            for (std::size_t i = 0; i < full.rgba.size(); ++i)
                sum += std::abs(int(image.rgba[i]) - int(full.rgba[i]));
            return sum / static_cast<double>(full.rgba.size());
        };
        const double three = difference({0.75, 1, 2.5}), one = difference({0.25, 1, 2.5});
        EXPECT_GT(three, 0);
        // A picture that is off by a pixel or by its border would differ everywhere.
        EXPECT_LT(three, 1.5);
        EXPECT_LT(one, 3.5);
        EXPECT_LT(three, one);
        EXPECT_EQ(difference({}), 0) << "the full picture does not come back";
        EXPECT_GT(difference({1e-9, 1, 2.5}), 3.5);  // one pixel: one colour
        if (antialiasing == Antialiasing::fxaa) {
            const double none = difference({1, 0, 2.5}), half = difference({1, 0.5, 2.5});
            EXPECT_GT(half, 0);
            EXPECT_GT(none, half);
        }
    }
}

TEST_F(SceneRendererGlTest, aChangeOfDetailGoesUnseenInAViewThatStands) {
    const city::CityModel city = test::boxCity();
    const View view = lookAt({-14, -5, 3}, {10, -2, 1}, 1.0, size_);
    const auto differing = [](const Image8& a, const Image8& b) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.rgba.size(); ++i)
            count += std::abs(int(a.rgba[i]) - int(b.rgba[i])) > 1 ? 1 : 0;
        return count;
    };
    constexpr int frames = 20;
    const DrawingDetail coarse{0.5, 0, 2.5};
    for (Antialiasing antialiasing : {Antialiasing::none, Antialiasing::fxaa, Antialiasing::msaa4}) {
        RenderOptions options;
        options.antialiasing = antialiasing;
        SceneRenderer renderer(city, models_, options), plain(city, models_, options);
        renderer.prepareForChanges(size_);
        const Image8 full = draw(renderer, view);
        EXPECT_EQ(full.rgba, draw(plain, view).rgba);
        plain.setDetail(coarse);
        const Image8 end = draw(plain, view);
        const std::size_t all = differing(full, end);
        ASSERT_GT(all, 1000u);
        renderer.setDetail(coarse, frames);
        Image8 before = full;
        std::size_t most = 0;
        for (int frame = 0; frame < frames; ++frame) {
            const Image8 now = draw(renderer, view);
            most = std::max(most, differing(before, now));
            before = now;
        }
        EXPECT_LT(most, all / 5) << "seen";
        EXPECT_LT(differing(before, end), all / 100) << "not there in the end";
        EXPECT_EQ(draw(renderer, view).rgba, end.rgba);

        // What moves is where it is, within two frames.
        renderer.setDetail({}, frames);
        draw(renderer, view);
        scene_.vehicles[0].position.x -= 4;
        draw(renderer, view);
        const Image8 moved = draw(renderer, view);
        plain.setDetail({});
        const Image8 truth = draw(plain, view);
        std::size_t wrong = 0, right = 0;
        const Image8 stood = full;
        for (std::size_t i = 0; i < truth.rgba.size(); ++i) {
            if (std::abs(int(truth.rgba[i]) - int(stood.rgba[i])) < 40) continue;  // the car, here or there
            ++(std::abs(int(truth.rgba[i]) - int(moved.rgba[i])) <= 1 ? right : wrong);
        }
        EXPECT_GT(right, 2000u);
        EXPECT_LT(wrong, right / 20);
        scene_.vehicles[0].position.x += 4;

        // From elsewhere it is new at once.
        renderer.setDetail(coarse, frames);
        const View other = lookAt({-14, -5, 3.5}, {10, -2, 1}, 1.0, size_);
        plain.setDetail(coarse);
        EXPECT_EQ(draw(renderer, other).rgba, draw(plain, other).rgba);
    }
}

TEST_F(SceneRendererGlTest, vehiclesMirrorTheirMapsAndPlainOnesDoNot) {
    // A map of pure green light: it must show on the car that has it, and only there.
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, {});
    const auto maps = gl::Texture::cubeArray(GL_RGBA16F, 64, 2, 7);
    const std::array<float, 4> green{0, 6, 0, 1};
    for (int level = 0; level < 7; ++level)
        glClearTexImage(maps.name(), level, GL_RGBA, GL_FLOAT, green.data());
    VehicleReflections reflections;
    reflections.textures.cubeArrays[1] = maps.name();
    reflections.slots = {{1, 1}, {}, {3, 0}};  // the third asks for a class that is empty: plain
    for (auto& vehicle : scene_.vehicles) vehicle.paint = glm::vec3(0.02f);
    const View view = lookAt({-4, -9, 2.2}, {6, -3, 0.6}, 1.3, size_);
    const Image8 with = draw(renderer, view, reflections);
    const Image8 without = draw(renderer, view);
    test::writePng("green-map", with);
    const auto greenness = [&](const Image8& image, double x) {
        // The middle of a car's right-hand side, which faces the eye.
        const glm::vec4 clip = view.clipFromView * view.viewFromWorld *
                               glm::vec4(glm::vec3(glm::dvec3(x, -3.9, 0.75) - view.eye), 1);
        const glm::ivec3 p = pixel(image, static_cast<int>((clip.x / clip.w * 0.5f + 0.5f) * 640.f),
                                   static_cast<int>((0.5f - clip.y / clip.w * 0.5f) * 360.f));
        return p.g - p.r;
    };
    EXPECT_GT(greenness(with, 0), greenness(without, 0) + 40);
    EXPECT_EQ(greenness(with, 8), greenness(without, 8));
    EXPECT_EQ(greenness(with, 16), greenness(without, 16));
}

/// The same view with and without occlusion culling: the pixels equal, and something was left out somewhere.
void expectSamePixels(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                      const FrameScene& scene, const std::vector<View>& views, std::uint32_t framebuffer) {
    RenderOptions options;
    options.antialiasing = Antialiasing::none;
    SceneRenderer culling(city, models, options);
    options.occlusionCulling = false;
    SceneRenderer all(city, models, options);
    std::uint32_t saved = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        culling.prepare(scene);
        culling.drawView(views[i], {}, framebuffer);
        const Image8 withCulling = readPixels(framebuffer, views[i].size);
        all.prepare(scene);
        all.drawView(views[i], {}, framebuffer);
        const Image8 without = readPixels(framebuffer, views[i].size);
        std::size_t different = 0;
        for (std::size_t k = 0; k < without.rgba.size(); ++k)
            different += withCulling.rgba[k] != without.rgba[k] ? 1 : 0;
        // Edges that meet without sharing vertices let a far pixel shine through here and there: two at most.
        EXPECT_LE(different, 2u * 3) << "view " << i;
        saved += all.counters().chunksDrawn - culling.counters().chunksDrawn;
    }
    EXPECT_GT(saved, 0u);
}

TEST_F(SceneRendererGlTest, occlusionCullingChangesNoPixelOfTheBenchmarkCity) {
    const city::CityModel city = city::generatePaperCity();
    std::vector<View> views;
    for (std::size_t i = 0; i < city.tour.size(); i += 9)
        views.push_back(lookAt(city.tour[i].eye, city.tour[i].target, 1.05, size_));
    views.push_back(lookAt({-450, -450, 120}, {0, 0, 0}, 1.0, size_));  // from the air
    views.push_back(lookAt({20, 5, 1.6}, {20, 5, 9}, 1.2, size_));      // straight up
    for (std::size_t i = 0; i < 40; ++i) {
        vehicles::VehiclePose pose;
        pose.id = static_cast<std::uint32_t>(i);
        pose.position = {-400.0 + 20.0 * static_cast<double>(i), 11.0 * static_cast<double>(i % 7), 0};
        scene_.vehicles.push_back(pose);
    }
    expectSamePixels(city, models_, scene_, views, framebuffer_.name());
}

TEST_F(SceneRendererGlTest, occlusionCullingChangesNoPixelOfTheBoulevard) {
    const city::CityModel city = city::generateBoulevard();
    std::vector<View> views;
    for (std::size_t i = 0; i < city.tour.size(); i += 4)
        views.push_back(lookAt(city.tour[i].eye, city.tour[i].target, 1.05, size_));
    expectSamePixels(city, models_, scene_, views, framebuffer_.name());
}

TEST_F(SceneRendererGlTest, cullingHidesWhatStandsBehindBuildings) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, {});
    scene_.vehicles.resize(2);
    scene_.vehicles[0].position = {20, -3, 0};
    scene_.vehicles[1].position = {20, 47, 0};  // in the next street
    const View view = lookAt({-14, -5, 1.7}, {30, 20, 1.7}, 1.4, size_);
    renderer.prepare(scene_);
    const auto visible = renderer.visibleVehicles(view);
    ASSERT_EQ(visible.size(), 1u);
    EXPECT_EQ(visible[0].index, 0u);
    // A car of 4.8 m seen from 34 m, some 400 pixels a radian.
    EXPECT_GT(visible[0].diameterPixels, 25);
    EXPECT_LT(visible[0].diameterPixels, 80);
}

TEST_F(SceneRendererGlTest, farFromTheOriginNothingMoves) {
    // The same scene at the origin and 4 km away: float positions there are good to 0.25 mm.
    const city::CityModel near = test::boxCity();
    city::CityModel far = near;
    const glm::vec3 offset(4096, -2048, 0);
    for (city::Chunk& chunk : far.chunks) {
        for (city::Vertex& v : chunk.mesh.vertices) v.position += offset;
        chunk.bounds = chunk.mesh.bounds();
    }
    RenderOptions options;
    options.shadows = false;
    SceneRenderer nearRenderer(near, models_, options);
    const Image8 a = draw(nearRenderer, lookAt({-14, -5, 3}, {10, -2, 1}, 1.0, size_));
    for (auto& v : scene_.vehicles) v.position += glm::dvec3(offset);
    SceneRenderer farRenderer(far, models_, options);
    const Image8 b = draw(farRenderer, lookAt(glm::dvec3(-14, -5, 3) + glm::dvec3(offset),
                                              glm::dvec3(10, -2, 1) + glm::dvec3(offset), 1.0, size_));
    std::size_t different = 0;
    for (std::size_t k = 0; k < a.rgba.size(); ++k)
        different += std::abs(int(a.rgba[k]) - int(b.rgba[k])) > 8 ? 1 : 0;
    EXPECT_LT(different, a.rgba.size() / 500);
}

TEST_F(SceneRendererGlTest, sunCastsShadowsWhereOneTracesThem) {
    // A tower; the sun due south at 45 degrees: its shadow reaches as far north as it is high.
    city::CityModel city;
    city.materials.resize(1);
    city::Mesh ground;
    const auto at = [](float x, float y) { return city::Vertex{{x, y, 0}, {0, 0, 1}, {x, y}, 0}; };
    ground.addQuad(at(-60, -60), at(60, -60), at(60, 60), at(-60, 60));
    city.chunks.push_back(test::chunkOf(city::ChunkKind::ground, std::move(ground)));
    city::Mesh tower;
    test::addBox(tower, {-5, -5, 0}, {5, 5, 20}, 0);
    city.chunks.push_back(test::chunkOf(city::ChunkKind::building, std::move(tower)));
    RenderOptions options;
    options.antialiasing = Antialiasing::none;
    SceneRenderer renderer(city, models_, options);
    scene_.vehicles.clear();
    scene_.lighting.sunDirection = glm::normalize(glm::vec3(0, -1, 1));
    const View view = lookAt({0, 10, 90}, {0, 10, 0}, 1.0, size_);  // from above, north up
    const Image8 image = draw(renderer, view);
    test::writePng("shadow", image);
    const auto levelAt = [&](double x, double y) {
        const glm::vec4 clip =
            view.clipFromView * view.viewFromWorld * glm::vec4(glm::vec3(glm::dvec3(x, y, 0) - view.eye), 1);
        return pixel(image, static_cast<int>((clip.x / clip.w * 0.5f + 0.5f) * 640.f),
                     static_cast<int>((0.5f - clip.y / clip.w * 0.5f) * 360.f))
            .g;
    };
    const int lit = levelAt(20, 10);
    EXPECT_LT(levelAt(0, 15), lit - 40);
    EXPECT_LT(levelAt(3.5, 22), lit - 40);
    EXPECT_NEAR(levelAt(0, 28), lit, 12);  // beyond the shadow's end at y = 25
    EXPECT_NEAR(levelAt(8, 15), lit, 12);
    EXPECT_NEAR(levelAt(0, -12), lit, 12);
}

TEST_F(SceneRendererGlTest, whatStandsAndMirrorsCastsItsShadowAndIsDrawnByItsPose) {
    city::CityModel city = test::boxCity();
    city.reflectors.push_back({"ball",
                               city::StandingReflector::Shape::sphere,
                               city::StandingReflector::Stuff::chrome,
                               {0, 7, 0.5f},
                               2,
                               4});
    std::vector<vehicles::VehicleModel> models = models_;
    for (vehicles::VehicleModel& model : standingModels(city)) models.push_back(model);
    scene_.vehicles.clear();
    scene_.lighting.sunDirection = glm::normalize(glm::vec3(-1, 0, 1.2f));
    const View view = lookAt({4, -9, 9}, {2, 7, 0}, 1.0, size_);
    const auto pixelOf = [&](const glm::dvec3& p) {
        const glm::vec4 clip = view.clipFromView * view.viewFromWorld * glm::vec4(glm::vec3(p - view.eye), 1);
        return glm::ivec2((0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(size_.x),
                          (0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(size_.y));
    };
    SceneRenderer renderer(city, models, {});
    const Image8 without = draw(renderer, view);
    scene_.vehicles = standingPoses(city, 1);
    const Image8 with = draw(renderer, view);
    test::writePng("standing-ball", with);
    // The middle of the ball is 2.5 m up; its shadow falls 2.5 / 1.2 m further on.
    const glm::ivec2 shade = pixelOf({0 + 2.5 / 1.2, 7, 0}), ball = pixelOf({0, 7, 2.5});
    const glm::ivec2 lit = pixelOf({-6, 7, 0});
    EXPECT_LT(pixel(without, shade.x, shade.y).g, 0.75 * pixel(without, lit.x, lit.y).g)
        << "a shadow before the ball is drawn";
    EXPECT_EQ(pixel(with, lit.x, lit.y), pixel(without, lit.x, lit.y));
    EXPECT_NE(pixel(with, ball.x, ball.y), pixel(without, ball.x, ball.y));
    EXPECT_EQ(renderer.counters().vehiclesDrawn, 1u);
}

}  // namespace
}  // namespace app
