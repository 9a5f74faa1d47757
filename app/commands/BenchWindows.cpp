#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/CityTriangles.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/commands/WindowShots.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/MirrorPlan.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/WetRoad.h"
#include "app/raytrace/Edges.h"
#include "app/raytrace/RayTracer.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr std::uint32_t cars = 30;
/// Frames before the measured ones: shaders are compiled, local maps made.
constexpr std::uint32_t framesBefore = 3, framesMeasured = 12;
/// Mirrors in a row of the truth: the fifth would add 1% of 1%.
constexpr int truthDepth = 4;

struct Case {
    std::string name;
    bool glass = true;  ///< panes are drawn; false: as they are painted
    MirrorSettings settings;
    std::uint32_t frames = framesMeasured;
};

std::vector<Case> allCases(const std::optional<double>& road) {
    std::vector<Case> cases;
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
    }
    MirrorSettings all;
    all.depth = 1;
    all.maps = 64;
    all.leastPixels = 1;  // or what is culled as too small would not be the same
    cases.push_back({"depth 1, 64 maps at most", true, all});
    all.economies.offScreen = all.economies.narrow = all.economies.scissor = all.economies.resolution =
        all.economies.occlusion = all.economies.share = false;
    cases.push_back({"the same, nothing culled", true, all, 2});
    return cases;
}

/// One configuration with what it keeps from frame to frame.
struct Run {
    Case what;
    std::unique_ptr<ReflectionEngine> engine;
    std::vector<double> ms, ratio;
    MirrorCounters planned;
    RenderCounters drawn;
    double psnr = 0, flip = 0, psnrToCulled = 0;  ///< of the street
    double nearPsnr = 0, nearFlip = 0;            ///< of the car in a window
    std::vector<double> awayMs, awayRatio;        ///< no window in view
    std::uint32_t awayPasses = 0;
    std::uint64_t awayBytes = 0;
};

class WindowsBench {
  public:
    WindowsBench(const Options& options, PreparedScene& stage, const std::optional<double>& road)
        : options_(options), stage_(stage), planner_(stage.scene.glass.fronts), target_(options.resolution) {
        stage_.renderer.setGlass(stage.scene.glass.fronts);
        for (const Case& what : allCases(road)) {
            Run& run = runs_.emplace_back();
            run.what = what;
            run.engine = std::make_unique<ReflectionEngine>(*stage.reflections.tracer, stage.reflections.maps,
                                                            stage.scene.models, ReflectionSettings{});
        }
    }

    /// One frame of a configuration, until OpenGL had finished: milliseconds.
    double draw(Run& run, const FrameScene& frame) {
        const View& view = frame.views.front();
        SceneRenderer& renderer = stage_.renderer;
        finishDrawing();
        const Stopwatch watch;
        renderer.prepare(frame);
        MirrorPlan plan;
        if (run.what.glass)
            plan = planner_.plan(frame.views, run.what.settings,
                                 [&](const auto& from, const auto* glass, const auto& box) {
                                     return renderer.hides(from, glass, box);
                                 });
        const PlanarReflections planar{run.what.glass ? &plan : nullptr, 0};
        std::vector<SeenVehicle> seen;
        for (const auto& v : renderer.visibleVehicles(view, planar))
            seen.push_back({v.index, v.diameterPixels});
        const ReflectionPlan& maps = run.engine->update(frame, seen, renderer);
        renderer.drawView(view, {run.engine->textures(), maps.slots}, target_.framebuffer(), planar);
        finishDrawing();
        const double ms = watch.elapsed();
        run.planned = plan.counters;
        run.drawn = renderer.counters();
        return ms;
    }

    /// The configurations in turn on the same frames, so that all see the same disturbances.
    void measure(CarsStage& set, Progress& progress) {
        for (std::uint32_t i = 0; i < framesBefore + framesMeasured && !interrupted(); ++i) {
            set.traffic->step();
            const FrameScene frame =
                assembleFrame(stage_.scene.city, *set.traffic, stage_.scene.lighting, {set.view});
            double first = 0;
            for (Run& run : runs_) {
                if (i >= framesBefore + run.what.frames) continue;
                const double ms = draw(run, frame);
                if (&run == &runs_.front()) first = ms;
                if (i < framesBefore) continue;
                run.ms.push_back(ms);
                run.ratio.push_back(ms / first);
            }
            progress.advance();
        }
    }

    /// The same looking up at the sky: two configurations, with glass and without.
    void measureAway(const CarsStage& set) {
        FrameScene frame = assembleFrame(stage_.scene.city, *set.traffic, stage_.scene.lighting, {set.view});
        frame.views.front() =
            lookAt(set.view.eye, set.view.eye + glm::dvec3(0.1, 0, 1), 1.0, options_.resolution);
        Run* with = nullptr;
        for (Run& run : runs_)
            if (run.what.name == "depth 2") with = &run;
        if (with == nullptr) return;
        const MirrorCounters planned = with->planned;
        const RenderCounters drawn = with->drawn;
        for (std::uint32_t i = 0; i < framesBefore + 4 * framesMeasured && !interrupted(); ++i) {
            const bool first = i % 2 == 0;
            double with_ = 0, without = 0;
            if (first) without = draw(runs_.front(), frame);
            with_ = draw(*with, frame);
            with->awayPasses = std::max(with->awayPasses, with->planned.passes);
            with->awayBytes = std::max(with->awayBytes, with->drawn.mirrorTextureBytes);
            if (!first) without = draw(runs_.front(), frame);
            if (i < framesBefore) continue;
            with->awayMs.push_back(with_);
            with->awayRatio.push_back(with_ / without);
        }
        with->planned = planned;  // those of the measurement
        with->drawn = drawn;
    }

    /// Errors on the pixels that show glass, but for outlines, against ray traced pictures; pictures in
    /// --out.
    void compare(const FrameScene& frame, const std::string& name, bool near) {
        const View& view = frame.views.front();
        stage_.renderer.prepare(frame);
        RayTracer tracer(stage_.scene.city, stage_.scene.models);
        tracer.useTextureFilter(reflection::softwareRenderer() ? TextureFilter::llvmpipe
                                                               : TextureFilter::standard);
        tracer.prepare(frame);
        tracer.useSunMap(stage_.renderer.sunMap());
        TraceOptions trace;
        trace.samples = 4;
        trace.bounces = 2;
        trace.windows = truthDepth;
        const TracedPicture traced = tracer.render(view, trace);
        const std::vector<glm::vec3> truth = traced.display(frame.lighting.exposure);
        std::vector<unsigned char> glass = edgesOf(traced, view);
        for (std::size_t i = 0; i < glass.size(); ++i)
            glass[i] = glass[i] == 0 && traced.kind[i] == SeenKind::glass ? 1 : 0;
        write(truth, name + "_truth.png");
        DrawingDetail detail;
        detail.antialiasing = 0;
        const glm::ivec2 size = options_.resolution;
        std::vector<glm::vec3> culled;
        for (Run& run : runs_) {
            if (interrupted()) break;
            stage_.renderer.setDetail(detail);
            const MirrorCounters planned = run.planned;
            const RenderCounters drawn = run.drawn;
            draw(run, frame);
            run.planned = planned;  // those of the measurement
            run.drawn = drawn;
            const std::vector<glm::vec3> pixels = toFloat(readPixels(target_.framebuffer(), size));
            // Wet streets are not traced.
            const bool comparable = !run.what.settings.wetRoad;
            (near ? run.nearPsnr : run.psnr) =
                comparable ? reflection::psnr({size.x, size.y, pixels}, {size.x, size.y, truth}, glass)
                           : std::nan("");
            (near ? run.nearFlip : run.flip) =
                comparable ? reflection::meanError(
                                 reflection::flip({size.x, size.y, pixels}, {size.x, size.y, truth}), glass)
                           : std::nan("");
            run.psnrToCulled =
                culled.empty() ? 0 : reflection::psnr({size.x, size.y, pixels}, {size.x, size.y, culled}, {});
            culled = pixels;
            // Pictures to look at are antialiased.
            stage_.renderer.setDetail({});
            if (run.what.name != "painted windows" && run.what.name != "depth 2" && comparable) continue;
            draw(run, frame);
            run.planned = planned;
            run.drawn = drawn;
            write(toFloat(readPixels(target_.framebuffer(), size)),
                  name + (!comparable      ? "_wet.png"
                          : run.what.glass ? "_mirrors.png"
                                           : "_painted.png"));
        }
    }

    std::vector<Run>& runs() { return runs_; }

  private:
    void write(const std::vector<glm::vec3>& pixels, const std::string& name) const {
        Picture picture{options_.resolution.x, options_.resolution.y, {}};
        for (const glm::vec3& p : pixels) {
            for (int c = 0; c < 3; ++c)
                picture.rgba.push_back(
                    static_cast<std::uint8_t>(std::lround(255 * std::clamp(p[c], 0.0f, 1.0f))));
            picture.rgba.push_back(255);
        }
        writePng(picture, options_.out / name);
    }

    const Options& options_;
    PreparedScene& stage_;
    MirrorPlanner planner_;
    OffscreenTarget target_;
    std::vector<Run> runs_;
};

}  // namespace

int benchWindows(const Options& options) {
    requireWritable(options.out / "windows_truth.png");
    PreparedScene stage(options);
    ResultFile results("windows", std::string(programVersion), stage.context.renderer());
    std::vector<std::vector<std::string>> table{{"windows", "fronts", "panes", "passes", "levels", "Mtexels",
                                                 "textures", "k triangles", "ms", "/ painted", "PSNR dB",
                                                 "FLIP", "near, dB", "FLIP"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    if (stage.scene.glass.fronts.empty()) {
        spdlog::error("the city has no windows that mirror; info tells what was looked for");
        return exitFailed;
    }
    CarsStage set = setCarsStage(stage.scene, stage.renderer, cars, options.seed, options.resolution);
    if (!set.traffic) throw std::runtime_error("the city has no street to look down.");
    WindowsBench bench(options, stage, roadHeightNear(stage.scene.city.roads, set.view.eye));
    {
        Progress progress("frames", framesBefore + framesMeasured, options.quiet);
        bench.measure(set, progress);
    }
    bench.measureAway(set);
    const FrameScene street = assembleFrame(stage.scene.city, *set.traffic, stage.scene.lighting, {set.view});
    // The picture that shows a car in a window is for looking at; errors are those of the street.
    reflection::TriangleTracer triangles;
    addCity(triangles, stage.scene.city);
    triangles.commit();
    FrameScene close = street;
    if (const auto shot = carInWindow(stage.scene, close, triangles, options.resolution)) {
        close.views = {shot->view};
        bench.compare(close, "window", true);
    }
    bench.compare(street, "windows", false);

    const Run* before = nullptr;
    for (const Run& run : bench.runs()) {
        if (run.ms.empty()) continue;
        const Timing frame = timingOf(run.ms);
        const double ratio = timingOf(run.ratio).median;
        const MirrorCounters& p = run.planned;
        nlohmann::ordered_json row{{"method", run.what.name},
                                   {"city", options.city},
                                   {"cars", set.visible},
                                   {"depth", run.what.glass ? run.what.settings.depth : 0},
                                   {"most_maps", run.what.settings.maps},
                                   {"fronts_in_city", p.inCity},
                                   {"fronts_in_reach", p.inReach},
                                   {"fronts_in_view", p.inView},
                                   {"fronts", p.shown},
                                   {"windows", p.windows},
                                   {"passes", p.passes},
                                   {"levels", p.levels},
                                   {"texels", p.texels},
                                   {"culled",
                                    {{"back_facing", p.backFacing},
                                     {"off_screen", p.offScreen},
                                     {"occluded", p.occluded},
                                     {"below_cut_off", p.belowCutOff},
                                     {"over_cap", p.overCap},
                                     {"shared", p.shared}}},
                                   {"mirror_texture_bytes", run.drawn.mirrorTextureBytes},
                                   {"mirror_triangles", run.drawn.mirrorTriangles},
                                   {"width", options.resolution.x},
                                   {"height", options.resolution.y},
                                   {"plan_ms", p.milliseconds},
                                   {"frame_ms", toJson(frame)},
                                   {"ratio_to_painted", ratio},
                                   {"psnr_db", run.psnr},
                                   {"mean_flip", run.flip},
                                   {"near_psnr_db", run.nearPsnr},
                                   {"near_mean_flip", run.nearFlip}};
        if (!run.awayMs.empty()) {
            const double away = timingOf(run.awayRatio).median;
            row["no_window_in_view"] = {{"frame_ms", toJson(timingOf(run.awayMs))},
                                        {"ratio_to_painted", away},
                                        {"passes", run.awayPasses},
                                        {"mirror_texture_bytes", run.awayBytes}};
            spdlog::info("no window in view: {} passes, {} bytes of maps, {:.3f} of painted windows' time",
                         run.awayPasses, run.awayBytes, away);
        }
        if (run.what.name == "the same, nothing culled" && before != nullptr) {
            row["ratio_to_culled"] = frame.median / timingOf(before->ms).median;
            row["psnr_to_culled_db"] = run.psnrToCulled;
        }
        results.add(row);
        table.push_back({run.what.name, std::to_string(p.shown), std::to_string(p.windows),
                         std::to_string(p.passes), std::to_string(p.levels),
                         fixed(static_cast<double>(p.texels) / 1e6, 2),
                         byteSize(static_cast<double>(run.drawn.mirrorTextureBytes)),
                         fixed(static_cast<double>(run.drawn.mirrorTriangles) / 1000, 0),
                         fixed(frame.median, 1), fixed(ratio, 2), fixed(run.psnr, 1), fixed(run.flip, 4),
                         fixed(run.nearPsnr, 1), fixed(run.nearFlip, 4)});
        if (run.what.name == "the same, nothing culled" && before != nullptr)
            spdlog::info("culling: {:.1f} times as fast, PSNR {:.1f} dB between the pictures",
                         frame.median / timingOf(before->ms).median, run.psnrToCulled);
        before = &run;
    }
    return reportBench(options, results, table);
}

}  // namespace app
