#include "app/render/SceneRenderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "app/display/OffscreenContext.h"
#include "app/render/Readback.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/app/render/WritePng.h"

namespace app {
namespace {

namespace gl = reflection::gl;

class SceneRendererGlTest : public testing::Test {
  protected:
    SceneRendererGlTest() : debug_() {
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

}  // namespace
}  // namespace app
