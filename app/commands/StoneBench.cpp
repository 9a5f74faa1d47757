#include "app/commands/StoneBench.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "app/commands/MirrorMask.h"
#include "app/commands/StoneShots.h"
#include "app/commands/WindowsStage.h"
#include "app/frame/AssembleFrame.h"
#include "app/raytrace/Edges.h"
#include "app/report/Picture.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

namespace {

constexpr std::uint32_t framesMeasured = 24;
/// After so many frames of a standing view all cars' maps are as fine as they get.
constexpr int framesOfAge = 8;
/// Rays of a pixel for what rough surfaces spread: noise well below what is compared.
constexpr int spreadRays = 256;

std::vector<WindowsCase> allCases() {
    std::vector<WindowsCase> cases{{"painted", false, {}, framesMeasured}};
    MirrorSettings none;
    none.maps = 0;
    cases.push_back({"without maps", true, none, framesMeasured});
    for (const int depth : {1, 2}) {
        MirrorSettings settings;
        settings.depth = depth;
        cases.push_back({"depth " + std::to_string(depth), true, settings, framesMeasured});
    }
    return cases;
}

std::string fileOf(std::string name) {
    std::ranges::replace(name, ' ', '_');
    return "stone_" + name + ".png";
}

}  // namespace

void measureStone(const Options& options, PreparedScene& stage, vehicles::Traffic traffic,
                  ResultFile& results, std::vector<std::vector<std::string>>& table) {
    const Scene& scene = stage.scene;
    RayTracer rays(scene.city, scene.models);
    rays.useTextureFilter(reflection::softwareRenderer() ? TextureFilter::llvmpipe : TextureFilter::standard);
    FrameScene frame = assembleFrame(scene.city, traffic, scene.lighting, {});
    stage.renderer.prepare(frame);
    rays.prepare(frame);
    rays.useSunMap(stage.renderer.sunMap());
    const std::optional<View> view = stoneShot(scene, rays, options.resolution);
    if (!view) {
        spdlog::info("no front of polished stone in this city");
        return;
    }
    frame.views = {*view};
    TraceOptions trace;
    trace.samples = 4;
    trace.bounces = 2;
    trace.windows = 4;
    trace.film = spreadRays;
    const TracedPicture traced = rays.render(*view, trace);
    const std::vector<glm::vec3> truth = traced.display(scene.lighting.exposure);
    const glm::ivec2 size = options.resolution;
    const Image8 shown = toImage(truth, size);
    writePng({size.x, size.y, shown.rgba}, options.out / fileOf("truth"));
    const std::vector<unsigned char> edges = edgesOf(traced, *view);
    const std::vector<std::pair<std::string, SeenKind>> kinds{{"polished stone", SeenKind::stone},
                                                              {"frosted glass", SeenKind::frosted},
                                                              {"clear glass", SeenKind::glass}};

    WindowsStage bench(scene, stage.reflections, stage.renderer, size, allCases());
    CarsStage set;
    set.view = *view;
    set.traffic.emplace(std::move(traffic));
    {
        Progress progress("stone", WindowsStage::framesBefore + framesMeasured, options.quiet);
        bench.measure(set, framesMeasured, progress);
    }
    DrawingDetail plain;
    plain.antialiasing = 0;
    for (WindowsRun& run : bench.runs()) {
        if (interrupted() || run.ms.empty()) return;
        const double ms = timingOf(run.ms).median, ratio = timingOf(run.ratio).median;
        const MirrorCounters planned = run.planned;
        const RenderCounters drawn = run.drawn;
        stage.renderer.setDetail(plain);
        const std::vector<glm::vec3> pixels = toFloat(bench.picture(run, frame, framesOfAge));
        stage.renderer.setDetail({});
        const Image8 picture = bench.picture(run, frame, 1);
        writePng({size.x, size.y, picture.rgba}, options.out / fileOf(run.what.name));
        for (const auto& [name, kind] : kinds) {
            std::vector<unsigned char> mask(traced.kind.size());
            for (std::size_t i = 0; i < mask.size(); ++i)
                mask[i] = traced.kind[i] == kind && edges[i] == 0 ? 1 : 0;
            const auto count = std::ranges::count(mask, 1);
            if (count == 0) continue;
            const reflection::ImageView image{size.x, size.y, pixels}, reference{size.x, size.y, truth};
            const double psnr = reflection::psnr(image, reference, mask);
            const double flip = reflection::meanError(reflection::flip(image, reference), mask);
            results.add({{"what", name},
                         {"method", run.what.name},
                         {"city", options.city},
                         {"pixels", count},
                         {"psnr_db", psnr},
                         {"mean_flip", flip},
                         {"passes", planned.passes},
                         {"rough_fronts", planned.rough},
                         {"mirror_texture_bytes", drawn.mirrorTextureBytes},
                         {"frame_ms", toJson(timingOf(run.ms))},
                         {"ratio_to_painted", ratio}});
            table.push_back({name + ", " + run.what.name, std::to_string(count), fixed(psnr, 1),
                             fixed(flip, 4), std::to_string(planned.passes) + " passes", "", fixed(ms, 2),
                             fixed(ratio, 3)});
        }
    }
}

}  // namespace app
