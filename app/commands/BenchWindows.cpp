#include <spdlog/spdlog.h>

#include <map>
#include <optional>
#include <string>

#include "app/commands/Benches.h"
#include "app/commands/CityTriangles.h"
#include "app/commands/CompareWindows.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/commands/WindowShots.h"
#include "app/commands/WindowsStage.h"
#include "app/frame/WetRoad.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

namespace {

constexpr std::uint32_t cars = 30;
constexpr std::uint32_t framesMeasured = 12;
constexpr const char* unculled = "the same, nothing culled";

std::vector<WindowsCase> allCases(const std::optional<double>& road) {
    std::vector<WindowsCase> cases;
    cases.push_back({"painted windows", false, {}});
    MirrorSettings none;
    none.maps = 0;
    cases.push_back({"glass without maps", true, none});
    for (const int depth : {1, 2, 3}) {
        MirrorSettings settings;
        settings.depth = depth;
        settings.economies.cutOff = depth < 3;
        cases.push_back({"depth " + std::to_string(depth), true, settings});
    }
    for (const std::uint32_t maps : {1u, 2u, 4u, 16u}) {
        MirrorSettings settings;
        settings.maps = maps;
        cases.push_back({"depth 2, " + std::to_string(maps) + " maps at most", true, settings});
    }
    if (road) {
        MirrorSettings wet;
        wet.wetRoad = road;
        cases.push_back({"depth 2, wet street", true, wet});
        wet.maps = 0;
        cases.push_back({"wet street without maps", true, wet});
    }
    MirrorSettings all;
    all.depth = 1;
    all.maps = 64;
    all.leastPixels = 1;  // or what is culled as too small would not be the same
    cases.push_back({"depth 1, 64 maps at most", true, all});
    all.economies.offScreen = all.economies.narrow = all.economies.scissor = all.economies.resolution =
        all.economies.occlusion = all.economies.share = false;
    cases.push_back({unculled, true, all, 2});
    return cases;
}

/// What a case was in the view of the street and in that of a car in a window.
struct Compared {
    WindowsRun::Errors street, near;
};

void write(const Image8& image, const std::filesystem::path& file) {
    writePng({image.size.x, image.size.y, image.rgba}, file);
}

}  // namespace

int benchWindows(const Options& options) {
    requireWritable(options.out / "windows_truth.png");
    PreparedScene stage(options);
    ResultFile results("windows", std::string(programVersion), stage.context.renderer());
    std::vector<std::vector<std::string>> table{{"windows", "fronts", "panes", "passes", "levels", "Mtexels",
                                                 "textures", "k triangles", "ms", "/ painted", "PSNR dB",
                                                 "FLIP", "near, dB", "FLIP", "wet, dB", "FLIP"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    if (stage.scene.glass.fronts.empty()) {
        spdlog::error("the city has no windows that mirror; info tells what was looked for");
        return exitFailed;
    }
    CarsStage set = setCarsStage(stage.scene, stage.renderer, cars, options.seed, options.resolution);
    if (!set.traffic) throw std::runtime_error("the city has no street to look down.");
    WindowsStage bench(stage.scene, stage.reflections, stage.renderer, options.resolution,
                       allCases(roadHeightNear(stage.scene.city.roads, set.view.eye)));
    {
        Progress progress("frames", WindowsStage::framesBefore + framesMeasured, options.quiet);
        bench.measure(set, framesMeasured, progress);
    }
    bench.measureAway(set, "depth 2", 4 * framesMeasured);
    const FrameScene street = bench.frameOf(set);
    std::map<std::string, Compared> compared;
    const auto compare = [&](const FrameScene& frame, const std::string& name, bool near) {
        const WindowsTruth truth = bench.truthOf(frame);
        write(toImage(truth.display, options.resolution), options.out / (name + "_truth.png"));
        const WindowsTruth rained = bench.truthOf(frame, true);
        write(toImage(rained.display, options.resolution), options.out / (name + "_wet_truth.png"));
        bench.compare(
            frame, [&](const WindowsRun& run) { return run.what.settings.wetRoad ? &rained : &truth; },
            [](const WindowsRun& run) {
                return !run.what.glass || run.what.name == "depth 2" ||
                       (run.what.settings.wetRoad && run.what.settings.maps > 0);
            },
            [&](WindowsRun& run, WindowsPicture&& picture) {
                Compared& c = compared[run.what.name];
                (near ? c.near : c.street) = picture.errors;
                if (picture.seen.rgba.empty()) return;
                write(picture.seen, options.out / (name + (run.what.settings.wetRoad ? "_wet.png"
                                                           : run.what.glass          ? "_mirrors.png"
                                                                                     : "_painted.png")));
            });
    };
    // The picture that shows a car in a window is for looking at; errors are those of the street.
    reflection::TriangleTracer triangles;
    addCity(triangles, stage.scene.city);
    triangles.commit();
    FrameScene close = street;
    if (const auto shot = carInWindow(stage.scene, close, triangles, options.resolution)) {
        close.views = {shot->view};
        compare(close, "window", true);
    }
    compare(street, "windows", false);

    const WindowsRun* before = nullptr;
    for (const WindowsRun& run : bench.runs()) {
        if (run.ms.empty()) continue;
        const WindowRow measured = windowRowOf(run, static_cast<std::uint32_t>(set.visible),
                                               options.resolution, compared[run.what.name].street);
        const WindowsRun::Errors& near = compared[run.what.name].near;
        const Timing& frame = measured.frame;
        const double ratio = measured.ratioToPainted;
        const MirrorCounters& p = run.planned;
        nlohmann::ordered_json row = toJson(measured, options.city);
        row["fronts_in_city"] = p.inCity;
        row["fronts_in_reach"] = p.inReach;
        row["fronts_in_view"] = p.inView;
        row["culled"] = {{"back_facing", p.backFacing}, {"off_screen", p.offScreen},
                         {"occluded", p.occluded},      {"below_cut_off", p.belowCutOff},
                         {"over_cap", p.overCap},       {"shared", p.shared}};
        row["plan_ms"] = p.milliseconds;
        row["near_psnr_db"] = near.psnr;
        row["near_mean_flip"] = near.flip;
        if (!run.awayMs.empty()) {
            const double away = timingOf(run.awayRatio).median;
            row["no_window_in_view"] = {{"frame_ms", toJson(timingOf(run.awayMs))},
                                        {"ratio_to_painted", away},
                                        {"passes", run.awayPasses},
                                        {"mirror_texture_bytes", run.awayBytes}};
            spdlog::info("no window in view: {} passes, {} bytes of maps, {:.3f} of painted windows' time",
                         run.awayPasses, run.awayBytes, away);
        }
        if (run.what.name == unculled && before != nullptr) {
            row["ratio_to_culled"] = frame.median / timingOf(before->ms).median;
            row["psnr_to_culled_db"] = compared[run.what.name].street.psnrToBefore;
        }
        results.add(row);
        table.push_back(
            {run.what.name, std::to_string(p.shown), std::to_string(p.windows), std::to_string(p.passes),
             std::to_string(p.levels), fixed(static_cast<double>(p.texels) / 1e6, 2),
             byteSize(static_cast<double>(run.drawn.mirrorTextureBytes)),
             fixed(static_cast<double>(run.drawn.mirrorTriangles) / 1000, 0), fixed(frame.median, 1),
             fixed(ratio, 2), fixed(measured.psnr, 1), fixed(measured.flip, 4), fixed(near.psnr, 1),
             fixed(near.flip, 4), fixed(measured.waterPsnr, 1), fixed(measured.waterFlip, 4)});
        if (run.what.name == unculled && before != nullptr)
            spdlog::info("culling: {:.1f} times as fast, PSNR {:.1f} dB between the pictures",
                         frame.median / timingOf(before->ms).median,
                         compared[run.what.name].street.psnrToBefore);
        before = &run;
    }
    return reportBench(options, results, table);
}

}  // namespace app
