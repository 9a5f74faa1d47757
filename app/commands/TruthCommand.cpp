#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

#include "app/commands/Benches.h"
#include "app/commands/Commands.h"
#include "app/commands/LoadScene.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ShotPlan.h"
#include "app/raytrace/Edges.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/SceneRenderer.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

Picture pictureOf(const std::vector<glm::vec3>& pixels, glm::ivec2 size) {
    Picture picture{size.x, size.y, {}};
    for (const glm::vec3& p : pixels) {
        for (int c = 0; c < 3; ++c)
            picture.rgba.push_back(
                static_cast<std::uint8_t>(std::lround(255 * std::clamp(p[c], 0.0f, 1.0f))));
        picture.rgba.push_back(255);
    }
    return picture;
}

/// Grey where equal; ten times the difference.
std::vector<glm::vec3> difference(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b,
                                  const std::vector<unsigned char>& edges) {
    std::vector<glm::vec3> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = (edges[i] != 0 ? 0.1f : 0.5f) + 10.0f * (a[i] - b[i]) * (edges[i] != 0 ? 0.1f : 1.0f);
    return result;
}

int run(const Options& options) {
    requireWritable(options.out / "truth_01.png");
    const OffscreenContext context;
    const Scene scene = loadScene(options);
    RenderOptions rendering;
    rendering.antialiasing = Antialiasing::none;
    SceneRenderer renderer(scene.city, scene.models, rendering);
    RayTracer tracer(scene.city, scene.models);
    if (reflection::softwareRenderer()) tracer.useTextureFilter(TextureFilter::llvmpipe);
    vehicles::Traffic traffic = startTraffic(scene, options.seed, options.cars.front());
    CameraRig camera(scene.city.tour, scene.city.bounds);
    ShotPlan shots(options.camera, scene.kinds);
    const OffscreenTarget target(options.resolution);
    const int width = options.resolution.x, height = options.resolution.y;

    ResultFile results("truth", std::string(programVersion), context.renderer());
    std::vector<std::vector<std::string>> table{
        {"picture", "none: dB", "outside edges", "edges %", "traced in s"}};
    const std::uint32_t frames = options.frameCount().value_or(300);
    const std::uint32_t stills = std::max(options.stills, 1u);
    const double frameTime = 1.0 / options.fps;
    for (std::uint32_t frame = 0, still = 0; frame < frames && !interrupted(); ++frame) {
        double lead = frame == 0 ? 0 : frameTime;
        for (double before = traffic.time(); lead > 0 && traffic.size() > 0; before = traffic.time()) {
            traffic.step();
            lead -= traffic.time() - before;
        }
        shots.direct(frame * frameTime, traffic.poses(), camera);
        camera.update(frame == 0 ? 0 : frameTime, traffic.poses(), {});
        if (frame != (2 * std::uint64_t{still} + 1) * frames / (2 * std::uint64_t{stills})) continue;
        ++still;
        const View view =
            lookAt(camera.pose().eye, camera.pose().target, glm::radians(60.0), options.resolution);
        const FrameScene picture = assembleFrame(scene.city, traffic, scene.lighting, {view});
        renderer.prepare(picture);
        renderer.drawView(view, {}, target.framebuffer());
        const std::vector<glm::vec3> drawn = toFloat(readPixels(target.framebuffer(), target.size()));
        tracer.prepare(picture);
        tracer.useSunMap(renderer.sunMap());
        TraceOptions plain;
        plain.plain = true;
        const Stopwatch watch;
        const TracedPicture traced = tracer.render(view, plain);
        const double seconds = watch.elapsed() / 1000;
        const std::vector<unsigned char> edges = edgesOf(traced, view);
        std::vector<unsigned char> inside(edges.size());
        for (std::size_t i = 0; i < edges.size(); ++i) inside[i] = edges[i] == 0 ? 1 : 0;
        const std::vector<glm::vec3> shown = traced.display(scene.lighting.exposure);
        const double all = reflection::psnr({width, height, shown}, {width, height, drawn});
        const double apart = reflection::psnr({width, height, shown}, {width, height, drawn}, inside);
        const double share = static_cast<double>(std::count(edges.begin(), edges.end(), 1)) /
                             static_cast<double>(edges.size());
        const std::string number = (still < 10 ? "0" : "") + std::to_string(still);
        writePng(pictureOf(drawn, options.resolution), options.out / ("none_drawn_" + number + ".png"));
        writePng(pictureOf(shown, options.resolution), options.out / ("none_traced_" + number + ".png"));
        writePng(pictureOf(difference(shown, drawn, edges), options.resolution),
                 options.out / ("none_difference_" + number + ".png"));
        table.push_back({number, fixed(all, 2), fixed(apart, 2), fixed(100 * share, 1), fixed(seconds, 2)});
        results.add({{"picture", number}, {"psnr_db", all}, {"psnr_outside_edges_db", apart}});
        // per kind
        for (const SeenKind kind : {SeenKind::sky, SeenKind::city, SeenKind::vehicle}) {
            std::vector<unsigned char> mask(inside);
            std::size_t count = 0;
            for (std::size_t i = 0; i < mask.size(); ++i) {
                if (traced.kind[i] != kind) mask[i] = 0;
                count += mask[i];
            }
            spdlog::info("kind {}: {} pixels {:.2f} dB", static_cast<int>(kind), count,
                         reflection::psnr({width, height, shown}, {width, height, drawn}, mask));
        }
    }
    return reportBench(options, results, table);
}

}  // namespace

Command truthCommand() {
    return {.name = "truth",
            .summary = "ray traced pictures",
            .groups = cityOptions | trafficOptions | pictureOptions | outOptions | jsonOptions |
                      durationOptions | displayOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
