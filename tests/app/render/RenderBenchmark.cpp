// Frame times and stills of a city: RenderBenchmark [CITY] [CARS] [FRAMES] [none|fxaa|msaa4] [WIDTH HEIGHT].
// Not run by the tests.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "app/display/OffscreenContext.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/app/render/WritePng.h"

namespace {

using Clock = std::chrono::steady_clock;

template <class Work>
double medianMilliseconds(int repeats, Work work) {
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) {
        const auto start = Clock::now();
        work();
        times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    }
    std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
    return times[times.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    const auto argument = [&](int i, const char* fallback) {
        return std::string(argc > i ? argv[i] : fallback);
    };
    const std::string cityName = argument(1, "boxes");
    const int cars = std::stoi(argument(2, "30"));
    const int frames = std::stoi(argument(3, "20"));
    const std::string aa = argument(4, "fxaa");
    const glm::ivec2 size(std::stoi(argument(5, "1280")), std::stoi(argument(6, "720")));

    app::OffscreenContext context;
    std::printf("%s\n", context.renderer().c_str());
    const city::CityModel city = app::test::boxCity();
    const std::vector<vehicles::VehicleModel> models{app::test::boxCar()};
    app::RenderOptions options;
    options.antialiasing = aa == "msaa4"  ? app::Antialiasing::msaa4
                           : aa == "fxaa" ? app::Antialiasing::fxaa
                                          : app::Antialiasing::none;
    app::SceneRenderer renderer(city, models, options);

    const auto colour = reflection::gl::Texture::image2D(GL_RGBA8, size.x, size.y);
    auto framebuffer = reflection::gl::Framebuffer::create();
    framebuffer.attach(GL_COLOR_ATTACHMENT0, colour.name());

    app::FrameScene scene;
    for (int i = 0; i < cars; ++i) {
        vehicles::VehiclePose pose;
        pose.id = static_cast<std::uint32_t>(i);
        pose.position = {7.0 * (i / 2) - 5, i % 2 == 0 ? -3.0 : 1.0, 0};
        pose.paint = {0.1f + 0.05f * static_cast<float>(i % 9), 0.1f,
                      0.5f - 0.04f * static_cast<float>(i % 9)};
        scene.vehicles.push_back(pose);
    }
    const app::View view = app::lookAt({-14, -5, 3}, {10, -2, 1}, 1.05, size);
    scene.views = {view};
    renderer.prepare(scene);
    const auto frame = [&] {
        renderer.drawView(view, {}, framebuffer.name());
        glFinish();
    };
    frame();
    std::printf(
        "%s %dx%d %d cars, %s: %.2f ms; %u draws, %llu triangles, %u chunks, %u culled, %u vehicles\n",
        cityName.c_str(), size.x, size.y, cars, aa.c_str(), medianMilliseconds(frames, frame),
        renderer.counters().drawCalls, static_cast<unsigned long long>(renderer.counters().triangles),
        renderer.counters().chunksDrawn, renderer.counters().chunksCulled, renderer.counters().vehiclesDrawn);
    app::test::writePng("bench-" + cityName, app::readPixels(framebuffer.name(), size));

    const int faceSize = 128;
    const auto cube = reflection::gl::Texture::cubeArray(GL_R11F_G11F_B10F, faceSize, 1);
    std::printf("cube %d: %.2f ms\n", faceSize, medianMilliseconds(frames, [&] {
                    renderer.drawCube({0, -3, 0.8}, {cube.name(), 0, 0, faceSize},
                                      {true, std::getenv("NOCARS") == nullptr, 0});
                    glFinish();
                }));
    return 0;
}
