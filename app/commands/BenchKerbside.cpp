#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/KerbsideShots.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/ReflectionSource.h"
#include "app/commands/SquareChrome.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/Table.h"
#include "reflection/gl/ShaderSource.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr double lookedAhead = 16;  // seconds: the cyclist of kerbside.json drives as long

using Table = std::vector<std::vector<std::string>>;

std::string fileName(std::string shot, const std::string& method) {
    std::erase(shot, ',');
    std::ranges::replace(shot, ' ', '_');
    return "kerbside_" + shot + "_" + method + ".png";
}

/// Pictures side by side, four grey pixels between them.
Picture beside(const std::vector<Image8>& images) {
    constexpr int gap = 4;
    const glm::ivec2 size = images.front().size;
    const int n = static_cast<int>(images.size());
    Picture all{n * size.x + (n - 1) * gap, size.y, {}};
    all.rgba.assign(static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height) * 4, 128);
    for (int i = 0; i < n; ++i)
        for (int y = 0; y < size.y; ++y) {
            const auto row =
                images[static_cast<std::size_t>(i)].rgba.begin() + std::ptrdiff_t{4} * y * size.x;
            std::copy_n(row, 4 * size.x,
                        all.rgba.begin() + std::ptrdiff_t{4} * (y * all.width + i * (size.x + gap)));
        }
    return all;
}

/// Every method on the chrome of one vehicle, against many rays through each pixel.
void measureShot(const Options& options, PreparedScene& stage, const CloseScene& close, RayTracer& rays,
                 const KerbsideShot& shot, ResultFile& results, Table& table) {
    SceneRenderer& renderer = stage.renderer;
    const OffscreenTarget target(options.resolution);
    const FrameScene& frame = shot.frame;
    const View& view = frame.views.front();
    renderer.prepare(frame);
    const std::vector<SeenVehicle> seen = seenIn(renderer, frame.views);
    std::vector<std::uint32_t> indices;
    for (const SeenVehicle& s : seen) indices.push_back(s.index);
    rays.prepare(frame);
    TraceOptions plain;
    plain.plain = true;
    const TracedPicture picture = rays.render(view, plain);
    std::vector<unsigned char> mask(picture.kind.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = picture.kind[i] == SeenKind::vehicle &&
                          picture.vehicle[i] == frame.vehicles[shot.vehicle].id &&
                          picture.surface[i] == static_cast<std::uint32_t>(vehicles::Surface::chrome)
                      ? 1
                      : 0;
    const auto pixels = std::count(mask.begin(), mask.end(), 1);
    if (pixels == 0) return;
    const ChromePlan plan = planChrome(frame, indices, stage.scene.models, close.parts, {});
    std::vector<glm::vec3> truth;
    std::vector<Image8> strip(3);
    const std::vector<std::pair<std::string, std::optional<ReflectionMethod>>> methods{
        {"truth", std::nullopt},
        {"none", ReflectionMethod::none},
        {"mem", ReflectionMethod::mem},
        {"chrome", ReflectionMethod::mem},
        {"rerender", ReflectionMethod::rerender},
        {"raytrace", ReflectionMethod::raytrace}};
    for (const auto& [name, method] : methods) {
        if (interrupted()) return;
        ReflectionSettings settings;
        settings.method = method.value_or(ReflectionMethod::none);
        settings.quality = options.quality;
        settings.everyFrame = true;
        const std::unique_ptr<ReflectionSource> source =
            method ? engineSource(stage.scene, stage.reflections, settings, rays) : tracedTruth(rays);
        renderer.prepare(frame);
        source->beginFrame(frame, seen, renderer);
        const bool chrome = name == "chrome";
        renderer.drawView(view, source->forView(view, renderer), target.framebuffer(), {},
                          {chrome ? &plan : nullptr, 0, {}});
        if (chrome) {
            const ChromeCounts& c = renderer.counters().chrome;
            spdlog::info(
                "{}: at {:.2f} s, {:.2f} m apart; {} jobs ({} open, {} too small, {} left out), {} meshes, "
                "{} "
                "vertices, {} searched, {} triangles, {:.1f} ms ({:.1f} searching)",
                shot.name, shot.seconds, shot.apart, c.jobs, plan.open, plan.tooSmall, plan.leftOut, c.meshes,
                c.vertices, c.searched, c.triangles, c.milliseconds, c.searchMilliseconds);
        }
        const Image8 image = readPixels(target.framebuffer(), target.size());
        const std::string file = fileName(shot.name, name);
        writePng({image.size.x, image.size.y, image.rgba}, options.out / file);
        if (!method) strip[2] = image;
        if (name == "mem") strip[0] = image;
        if (chrome) strip[1] = image;
        const std::vector<glm::vec3> shown = toFloat(image);
        if (!method) truth = shown;
        const int w = image.size.x, h = image.size.y;
        const double psnr = reflection::psnr({w, h, shown}, {w, h, truth}, mask);
        const double flip = reflection::meanError(reflection::flip({w, h, shown}, {w, h, truth}), mask);
        results.add({{"what", shot.name},
                     {"method", name},
                     {"city", options.city},
                     {"seconds", shot.seconds},
                     {"chrome_jobs", chrome ? plan.jobs.size() : 0},
                     {"pixels", pixels},
                     {"psnr_db", psnr},
                     {"mean_flip", flip}});
        table.push_back({file, std::to_string(pixels), fixed(psnr, 1), fixed(flip, 4), "", "", "", ""});
    }
    writePng(beside(strip), options.out / fileName(shot.name, "mem_chrome_truth"));
}

}  // namespace

int benchKerbside(const Options& asked) {
    Options options = asked;
    if (!options.staged) options.staged = reflection::gl::dataFolder() / "staged" / "kerbside.json";
    requireWritable(options.out / "kerbside_truth.png");
    PreparedScene stage(options);
    ResultFile results("kerbside", std::string(programVersion), stage.context.renderer());
    Table table{{"picture or frames", "pixels", "PSNR dB", "FLIP", "", "without, ms", "ms", "/ without"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    const Scene& scene = stage.scene;
    RayTracer rays(scene.city, scene.models);
    const CloseScene close(scene.city, scene.models);
    const vehicles::Traffic traffic = startTraffic(scene, options.seed, options.cars.front());
    const FrameScene frame = assembleFrame(scene.city, traffic, scene.lighting, {}, scene.staged);
    const std::vector<KerbsideShot> shots =
        kerbsideShots(scene, close.parts, frame, options.resolution, lookedAhead);
    if (shots.empty()) spdlog::error("no view of the staged vehicles shows chrome that is large enough");
    stage.renderer.setCloseScene(&close);
    for (const KerbsideShot& shot : shots) {
        if (interrupted()) break;
        measureShot(options, stage, close, rays, shot, results, table);
        if (!interrupted())
            measureChromeCost(options, stage, close, shot.name, shot.frame.views.front(), shot.frame,
                              shot.vehicle, results, table);
    }
    stage.renderer.setCloseScene(nullptr);
    return reportBench(options, results, table);
}

}  // namespace app
