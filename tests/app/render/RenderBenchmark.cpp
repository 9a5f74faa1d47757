// Frame times and stills of a city, by hand; not run by the tests.
//   RenderBenchmark [--city paper|boulevard|boxes] [--cars N] [--frames N] [--aa none|fxaa|msaa4] [--size
//   WxH] [--at SECONDS of the tour]
//                   [--eye x,y,z --target x,y,z] [--hour H] [--no-culling] [--no-shadows] [--one-map] [--out
//                   NAME]
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "app/display/OffscreenContext.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"
#include "tests/app/render/BoxWorld.h"
#include "tests/app/render/WritePng.h"
#include "vehicles/models/Fleet.h"

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration d) {
    return std::chrono::duration<double, std::milli>(d).count();
}

/// Wall time, and the processor time of all threads: the latter hardly depends on what else runs.
template <class Work>
std::string times(int repeats, Work work) {
    std::vector<double> all;
    const std::clock_t before = std::clock();
    for (int i = 0; i < repeats; ++i) {
        const auto start = Clock::now();
        work();
        all.push_back(milliseconds(Clock::now() - start));
    }
    const double processor = 1000.0 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC / repeats;
    std::ranges::sort(all);
    char text[100];
    std::snprintf(text, sizeof text, "median %.2f min %.2f max %.2f ms, processor %.2f ms",
                  all[all.size() / 2], all.front(), all.back(), processor);
    return text;
}

struct Options {
    std::map<std::string, std::string> values;
    Options(int argc, char** argv) {
        for (int i = 1; i < argc; ++i) {
            const std::string name = argv[i];
            const bool hasValue = i + 1 < argc && std::string(argv[i + 1]).rfind("--", 0) != 0;
            values[name] = hasValue ? argv[++i] : "1";
        }
    }
    bool has(const char* name) const { return values.count(name) != 0; }
    std::string text(const char* name, const char* fallback) const {
        return has(name) ? values.at(name) : fallback;
    }
    int number(const char* name, int fallback) const {
        return has(name) ? std::stoi(values.at(name)) : fallback;
    }
    glm::dvec3 point(const char* name) const {
        glm::dvec3 p(0);
        std::sscanf(values.at(name).c_str(), "%lf,%lf,%lf", &p.x, &p.y, &p.z);
        return p;
    }
};

/// Cars along the lanes, nearest to the eye first, only where they can be seen.
std::vector<vehicles::VehiclePose> parkOnLanes(const city::CityModel& city, app::SceneRenderer& renderer,
                                               const app::View& view, app::FrameScene scene,
                                               std::size_t wanted) {
    std::vector<vehicles::VehiclePose> all;
    for (const city::Lane& lane : city.roads.lanes) {
        if (lane.kind != city::LaneKind::car) continue;
        double next = 6;
        double walked = 0;
        for (std::size_t i = 0; i + 1 < lane.centreLine.size(); ++i) {
            const glm::dvec3 a(lane.centreLine[i]);
            const glm::dvec3 b(lane.centreLine[i + 1]);
            const double length = glm::length(b - a);
            for (; next < walked + length; next += 7.5) {
                vehicles::VehiclePose pose;
                pose.position = a + (b - a) * ((next - walked) / length);
                pose.heading = std::atan2(b.y - a.y, b.x - a.x);
                all.push_back(pose);
            }
            walked += length;
        }
    }
    std::ranges::sort(all, {},
                      [&](const vehicles::VehiclePose& p) { return glm::length(p.position - view.eye); });
    std::erase_if(all,
                  [&](const vehicles::VehiclePose& p) { return glm::length(p.position - view.eye) < 4; });
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto id = static_cast<std::uint32_t>(i);
        all[i].id = id;
        all[i].model = id % 11 == 7 ? 3 : id % 7 == 3 ? 2 : (id * 7 / 3) % 2;
        all[i].wheelAngle = static_cast<float>(i);
        const glm::vec3 paints[]{{0.45f, 0.02f, 0.02f},  {0.02f, 0.06f, 0.25f}, {0.55f, 0.55f, 0.57f},
                                 {0.02f, 0.02f, 0.022f}, {0.7f, 0.7f, 0.68f},   {0.03f, 0.16f, 0.08f},
                                 {0.5f, 0.3f, 0.03f}};
        all[i].paint = paints[id * 5 % 7];
    }
    scene.vehicles = all;
    renderer.prepare(scene);
    std::vector<vehicles::VehiclePose> chosen;
    for (const auto& v : renderer.visibleVehicles(view)) {
        if (chosen.size() == wanted) break;
        chosen.push_back(all[v.index]);
    }
    return chosen;
}

}  // namespace

int main(int argc, char** argv) {
    const Options o(argc, argv);
    const std::string cityName = o.text("--city", "paper");
    const int frames = o.number("--frames", 20);
    const std::string aa = o.text("--aa", "fxaa");
    glm::ivec2 size(1280, 720);
    std::sscanf(o.text("--size", "1280x720").c_str(), "%dx%d", &size.x, &size.y);

    const app::OffscreenContext context;
    const auto start = Clock::now();
    const city::CityModel city = cityName == "boxes"       ? app::test::boxCity()
                                 : cityName == "boulevard" ? city::generateBoulevard()
                                                           : city::generatePaperCity();
    const std::vector<vehicles::VehicleModel> models = vehicles::builtInFleet();
    const auto generated = Clock::now();
    app::RenderOptions options;
    options.antialiasing = aa == "msaa4"  ? app::Antialiasing::msaa4
                           : aa == "fxaa" ? app::Antialiasing::fxaa
                                          : app::Antialiasing::none;
    options.occlusionCulling = !o.has("--no-culling");
    options.shadows = !o.has("--no-shadows");
    app::SceneRenderer renderer(city, models, options);
    const auto uploaded = Clock::now();

    const auto colour = reflection::gl::Texture::image2D(GL_RGBA8, size.x, size.y);
    auto framebuffer = reflection::gl::Framebuffer::create();
    framebuffer.attach(GL_COLOR_ATTACHMENT0, colour.name());

    glm::dvec3 eye(-14, -5, 3);
    glm::dvec3 target(10, -2, 1);
    const double at = std::stod(o.text("--at", "20"));
    for (const city::TourStop& stop : city.tour) {
        if (stop.time > at) break;
        eye = stop.eye;
        target = stop.target;
    }
    if (o.has("--eye")) eye = o.point("--eye");
    if (o.has("--target")) target = o.point("--target");
    const app::View view = app::lookAt(eye, target, 1.05, size);

    app::FrameScene scene;
    scene.views = {view};
    scene.lighting = app::lightingAt(std::stod(o.text("--hour", "14.5")));
    scene.vehicles =
        parkOnLanes(city, renderer, view, scene, static_cast<std::size_t>(o.number("--cars", 30)));
    scene.signalColours.resize(city.signalHeads.size(), vehicles::SignalColour::red);

    app::VehicleReflections reflections;
    const auto cube = reflection::gl::Texture::cubeArray(GL_R11F_G11F_B10F, 128, 1, 8);
    if (o.has("--one-map")) {
        renderer.prepare(scene);
        renderer.drawCube(glm::dvec3(glm::vec3(target)), {cube.name(), 0, 0, 128}, {});
        glGenerateTextureMipmap(cube.name());
        reflections.textures.cubeArrays[0] = cube.name();
        reflections.slots.assign(scene.vehicles.size(), {0, 0});
    }
    renderer.prepare(scene);
    const auto frame = [&] {
        renderer.drawView(view, reflections, framebuffer.name());
        glFinish();
    };
    const auto beforeFirst = Clock::now();
    frame();
    const auto afterFirst = Clock::now();
    std::printf("%s: %zu triangles, generated in %.0f ms, uploaded in %.0f ms, first frame %.0f ms\n",
                cityName.c_str(), city.triangleCount(), milliseconds(generated - start),
                milliseconds(uploaded - generated), milliseconds(afterFirst - beforeFirst));
    const std::string result = times(frames, frame);
    const app::RenderCounters& c = renderer.counters();
    std::printf("%dx%d, %zu cars, %s: %s; %u draws, %llu triangles, %u chunks, %u culled, %u vehicles\n",
                size.x, size.y, scene.vehicles.size(), aa.c_str(), result.c_str(), c.drawCalls,
                static_cast<unsigned long long>(c.triangles), c.chunksDrawn, c.chunksCulled, c.vehiclesDrawn);
    app::test::writePng(o.text("--out", ("bench-" + cityName).c_str()),
                        app::readPixels(framebuffer.name(), size));

    if (o.has("--cube")) {
        const int faceSize = 128;
        const auto maps = reflection::gl::Texture::cubeArray(GL_R11F_G11F_B10F, faceSize, 1);
        const glm::dvec3 centre =
            scene.vehicles.empty() ? eye : scene.vehicles.front().position + glm::dvec3(0, 0, 0.8);
        std::printf("cube %d: %s\n", faceSize,
                    times(frames, [&] {
                        renderer.drawCube(centre, {maps.name(), 0, 0, faceSize}, {true, true, 0});
                        glFinish();
                    }).c_str());
    }
    return 0;
}
