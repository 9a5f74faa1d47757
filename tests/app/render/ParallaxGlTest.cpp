// Local maps looked up where a pixel's own ray ends: a map made anywhere in a room shows each pixel of a
// mirror what a map made at that very pixel shows it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "app/display/OffscreenContext.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/LocalMapAtlas.h"
#include "reflection/gl/Texture.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/app/render/WritePng.h"

namespace app {
namespace {

namespace gl = reflection::gl;

constexpr int faceSize = 128;
/// A room around the mirror: corners, world metres.
constexpr glm::vec3 low(-9, -12, 0), high(11, 3, 8);

/// The room as its walls are seen from a point: colour tells the place.
reflection::PackedMips roomSeenFrom(const glm::vec3& centre) {
    reflection::LocalMap map;
    map.resize(faceSize);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < faceSize; ++y)
            for (int x = 0; x < faceSize; ++x) {
                const glm::vec3 d = reflection::cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize);
                float t = std::numeric_limits<float>::max();
                for (int axis = 0; axis < 3; ++axis)
                    if (d[axis] != 0)
                        t = std::min(t, ((d[axis] > 0 ? high : low)[axis] - centre[axis]) / d[axis]);
                const glm::vec3 place = (centre + t * d - low) / (high - low);
                const std::size_t i = map.faceOffset(face) + static_cast<std::size_t>(y * faceSize + x);
                map.red[i] = 0.1f + 0.8f * place.x;
                map.green[i] = 0.1f + 0.8f * place.y;
                map.blue[i] = 0.1f + 0.8f * place.z;
                map.depth[i] = t;
            }
    reflection::PackedMips mips;
    reflection::packMips(map, mips);
    return mips;
}

/// A chrome plate, 4 m wide and 1.6 m high, facing -y.
vehicles::VehicleModel plate() {
    vehicles::VehicleModel model;
    model.levels.resize(1);
    const auto corner = [](float x, float z) {
        city::Vertex v;
        v.position = {x, 0, z};
        v.normal = {0, -1, 0};
        v.material = static_cast<std::uint32_t>(vehicles::Surface::chrome);
        return v;
    };
    model.levels[0].body.addTriangle(corner(-2, 0.2f), corner(2, 0.2f), corner(2, 1.8f));
    model.levels[0].body.addTriangle(corner(-2, 0.2f), corner(2, 1.8f), corner(-2, 1.8f));
    model.length = 4;
    model.height = 1.8f;
    return model;
}

class ParallaxGlTest : public testing::Test {
  public:
    ParallaxGlTest() {
        colour_ = gl::Texture::image2D(GL_RGBA8, size_.x, size_.y);
        framebuffer_ = gl::Framebuffer::create();
        framebuffer_.attach(GL_COLOR_ATTACHMENT0, colour_.name());
        scene_.vehicles.resize(1);
        scene_.views = {lookAt({-4, -7, 2.2}, {0, 0, 0.9}, 1.0, size_)};
        options_.antialiasing = Antialiasing::none;
        atlas_.keepNearness();
        atlas_.reserve(slot_.sizeClass, slot_.layer + 1);
    }
    ~ParallaxGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    Image8 draw(SceneRenderer& renderer, const glm::vec3& mapCentre, bool parallax) {
        atlas_.upload(slot_, roomSeenFrom(mapCentre));
        atlas_.setCentre(slot_, mapCentre);
        VehicleReflections reflections;
        reflections.textures = atlas_.textures();
        if (!parallax) reflections.textures.nearnessArrays = {};
        reflections.slots = {slot_};
        renderer.prepare(scene_);
        renderer.drawView(scene_.views[0], reflections, framebuffer_.name());
        return readPixels(framebuffer_.name(), size_);
    }
    /// Where a point of the plate is seen.
    glm::ivec2 pixelOf(const glm::vec3& point) const {
        const View& view = scene_.views[0];
        const glm::vec4 clip =
            view.clipFromView * view.viewFromWorld * glm::vec4(glm::vec3(glm::dvec3(point) - view.eye), 1);
        return {static_cast<int>((clip.x / clip.w * 0.5f + 0.5f) * static_cast<float>(size_.x)),
                static_cast<int>((0.5f - clip.y / clip.w * 0.5f) * static_cast<float>(size_.y))};
    }
    static glm::ivec3 at(const Image8& image, const glm::ivec2& p) {
        const auto i = 4 * static_cast<std::size_t>(p.y * image.size.x + p.x);
        return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
    }
    static int apart(const glm::ivec3& a, const glm::ivec3& b) {
        const glm::ivec3 d = glm::abs(a - b);
        return std::max({d.x, d.y, d.z});
    }

    OffscreenContext context_;
    gl::DebugOutput debug_;
    glm::ivec2 size_{320, 180};
    gl::Texture colour_;
    gl::Framebuffer framebuffer_;
    FrameScene scene_;
    RenderOptions options_;
    reflection::LocalMapAtlas atlas_;
    reflection::LocalMapSlot slot_{0, 2};
    std::vector<vehicles::VehicleModel> models_{plate()};
};

TEST_F(ParallaxGlTest, aMapFromElsewhereShowsWhatAMapFromThePixelShows) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, options_);
    // A texel is 1.2 degrees at most, 0.35 m on a wall 15 m away: 4 levels of 256 in the steepest colour
    // after encoding; and rounding.
    constexpr int tolerance = 6;
    const glm::vec3 centre(0.4f, 0.3f, 0.8f);
    const Image8 with = draw(renderer, centre, true), without = draw(renderer, centre, false);
    test::writePng("parallax-plate", with);
    int worstWith = 0, worstWithout = 0;
    for (const float x : {-1.8f, -0.9f, 0.f, 0.9f, 1.8f})
        for (const float z : {0.4f, 1.0f, 1.6f}) {
            const glm::vec3 point(x, 0, z);
            const glm::ivec2 p = pixelOf(point);
            // There the reflected direction alone is right.
            const glm::ivec3 expected = at(draw(renderer, point, false), p);
            worstWith = std::max(worstWith, apart(at(with, p), expected));
            worstWithout = std::max(worstWithout, apart(at(without, p), expected));
        }
    EXPECT_LE(worstWith, tolerance);
    EXPECT_GT(worstWithout, 3 * tolerance) << "the scene does not ask for parallax";
}

TEST_F(ParallaxGlTest, aMapStaysRightWhileItsVehicleLeavesItsCentre) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, options_);
    const auto meanApart = [&](const glm::vec3& a, const glm::vec3& b, bool parallax) {
        const Image8 x = draw(renderer, a, parallax), y = draw(renderer, b, parallax);
        double sum = 0;
        for (std::size_t i = 0; i < x.rgba.size(); ++i) sum += std::abs(int(x.rgba[i]) - int(y.rgba[i]));
        return sum / static_cast<double>(x.rgba.size());
    };
    const glm::vec3 here(0, 0.2f, 0.9f), there(-1.5f, 0.2f, 0.9f);
    EXPECT_LT(meanApart(here, there, true), 0.15 * meanApart(here, there, false));
}

TEST_F(ParallaxGlTest, theSkyIsSeenInTheReflectedDirection) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, options_);
    reflection::PackedMips sky = roomSeenFrom({0, 0, 1});
    std::ranges::fill(sky.nearness, std::uint16_t{0});
    const auto drawSky = [&](const glm::vec3& mapCentre, bool parallax) {
        atlas_.upload(slot_, sky);
        atlas_.setCentre(slot_, mapCentre);
        VehicleReflections reflections;
        reflections.textures = atlas_.textures();
        if (!parallax) reflections.textures.nearnessArrays = {};
        reflections.slots = {slot_};
        renderer.prepare(scene_);
        renderer.drawView(scene_.views[0], reflections, framebuffer_.name());
        return readPixels(framebuffer_.name(), size_).rgba;
    };
    EXPECT_EQ(drawSky({1, 0, 1}, true), drawSky({1, 0, 1}, false));
}

}  // namespace
}  // namespace app
