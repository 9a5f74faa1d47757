#include "app/commands/CompareWindows.h"

#include <algorithm>
#include <optional>

#include "app/commands/MirrorMask.h"
#include "app/compare/PictureErrorsOf.h"
#include "app/frame/WetRoad.h"
#include "app/report/Table.h"

namespace app {

namespace {

constexpr std::uint32_t windowCars = 30;
/// Of the pictures that are kept.
constexpr glm::ivec2 stripSize(640, 360);
/// Of the city's streets, where the most fronts are looked for.
constexpr std::size_t placesTried = 80;

/// The first is what the others are measured by.
std::vector<WindowsCase> comparedCases(std::uint32_t frames, const std::optional<double>& road) {
    std::vector<WindowsCase> cases;
    cases.push_back({"painted", false, {}, frames});
    MirrorSettings none;
    none.maps = 0;
    cases.push_back({"without maps", true, none, frames});
    for (const int depth : {1, 2, 3, 4})
        for (const std::uint32_t maps : {1u, 2u, 4u, 8u, 16u}) {
            // One map shows one mirror: a second in a row needs another.
            if (static_cast<int>(maps) < depth) continue;
            MirrorSettings settings;
            settings.depth = depth;
            settings.maps = maps;
            settings.economies.cutOff = depth < 3;  // deeper ones show little; here they are measured
            cases.push_back({"depth " + std::to_string(depth) + ", " + std::to_string(maps) +
                                 (maps == 1 ? " map" : " maps"),
                             true, settings, frames});
        }
    if (road) {
        MirrorSettings wet = none;
        wet.wetRoad = road;
        cases.push_back({"wet street, without maps", true, wet, frames});
        wet.maps = 8;
        cases.push_back({"wet street, depth 2, 8 maps", true, wet, frames});
    }
    return cases;
}

/// All that is in view, however small, with more and more of it mirroring.
std::vector<WindowsCase> countedCases(std::uint32_t frames) {
    std::vector<WindowsCase> cases{{"painted", false, {}, frames}};
    MirrorSettings settings;
    settings.depth = 1;
    settings.leastPixels = 1;
    for (const std::uint32_t maps : {0u, 1u, 2u, 4u, 8u, 16u, 32u}) {
        settings.maps = maps;
        cases.push_back({std::to_string(maps) + (maps == 1 ? " map" : " maps"), true, settings, frames});
    }
    return cases;
}

/// The view down a street in which most fronts would mirror.
std::optional<View> viewOfMostFronts(const Scene& scene, const SceneRenderer& renderer,
                                     glm::ivec2 resolution) {
    const std::vector<View> views = viewsDownStreets(scene.city, resolution);
    const MirrorPlanner planner(scene.glass.fronts);
    const MirrorSettings settings = countedCases(0).back().settings;
    std::optional<View> best;
    std::uint32_t most = 0;
    const std::size_t stride = std::max<std::size_t>(1, views.size() / placesTried);
    for (std::size_t i = 0; i < views.size(); i += stride) {
        const MirrorPlan plan = planner.plan(std::span(&views[i], 1), settings,
                                             [&](const auto& from, const auto* glass, const auto& box) {
                                                 return renderer.hides(from, glass, box);
                                             });
        if (plan.counters.passes <= most) continue;
        most = plan.counters.passes;
        best = views[i];
    }
    return best;
}

bool pictured(const WindowsRun& run) {
    return run.what.settings.maps == 0 || !run.what.glass || run.what.settings.maps == 8;
}

}  // namespace

WindowRow windowRowOf(const WindowsRun& run, std::uint32_t cars, glm::ivec2 size,
                      const WindowsRun::Errors& errors) {
    WindowRow row;
    row.name = run.what.name;
    row.depth = run.what.glass && run.what.settings.maps > 0 ? run.what.settings.depth : 0;
    row.mostMaps = run.what.glass ? run.what.settings.maps : 0;
    row.cutOff = run.what.settings.economies.cutOff;
    row.cars = cars;
    row.inView = run.planned.inView;
    row.fronts = run.planned.shown;
    row.panes = run.planned.windows;
    row.passes = run.planned.passes;
    row.levels = run.planned.levels;
    row.texels = run.planned.texels;
    row.triangles = run.drawn.mirrorTriangles;
    row.textureBytes = run.drawn.mirrorTextureBytes;
    row.width = size.x;
    row.height = size.y;
    row.frame = timingOf(run.ms);
    row.ratioToPainted = timingOf(run.ratio).median;
    row.psnr = errors.psnr;
    row.flip = errors.flip;
    row.wet = run.what.settings.wetRoad.has_value();
    row.waterPsnr = errors.waterPsnr;
    row.waterFlip = errors.waterFlip;
    return row;
}

namespace {

/// Cost against the number of mirrors, at the place with most of them.
void countFronts(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                 const CompareOptions& options, CarsStage& set, WindowComparison& result) {
    const std::optional<View> view = viewOfMostFronts(scene, renderer, options.resolution);
    if (!view) return;
    set.view = *view;
    WindowsStage stage(scene, prepared, renderer, options.resolution, countedCases(options.frames));
    {
        Progress progress("many windows", WindowsStage::framesBefore + options.frames, options.quiet);
        stage.measure(set, options.frames, progress);
    }
    const auto cars = static_cast<std::uint32_t>(renderer.visibleVehicles(set.view).size());
    for (const WindowsRun& run : stage.runs()) {
        if (run.ms.empty()) continue;
        WindowRow row = windowRowOf(run, cars, options.resolution, {});
        row.place = "fronts";
        row.name = "many fronts, " + row.name;
        result.rows.push_back(std::move(row));
    }
}

}  // namespace

WindowComparison compareWindows(const Scene& scene, const PreparedReflections& prepared,
                                SceneRenderer& renderer, const CompareOptions& options) {
    WindowComparison result;
    if (scene.glass.fronts.empty()) return result;
    CarsStage set = setCarsStage(scene, renderer, windowCars, options.seed, options.resolution);
    if (!set.traffic || interrupted()) return result;
    WindowsStage stage(scene, prepared, renderer, options.resolution,
                       comparedCases(options.frames, roadHeightNear(scene.city.roads, set.view.eye)));
    {
        Progress progress("windows", WindowsStage::framesBefore + options.frames, options.quiet);
        stage.measure(set, options.frames, progress);
    }
    if (interrupted()) return result;
    const FrameScene frame = stage.frameOf(set);
    const WindowsTruth truth = stage.truthOf(frame), rained = stage.truthOf(frame, true);
    const glm::ivec2 size = options.resolution, piece = glm::min(stripSize, size);
    const glm::ivec2 corner = richestWindow(truth.glass, size, piece);
    const Image8 display = toImage(truth.display, size);
    PictureStrip strip;
    strip.title = "windows of a street with " + std::to_string(set.visible) + " cars";
    strip.truth = cutOut({size.x, size.y, display.rgba}, corner, piece);
    PictureStrip wet;
    wet.title = "the same after rain";
    wet.truth = cutOut({size.x, size.y, toImage(rained.display, size).rgba}, corner, piece);
    stage.compare(
        frame, [&](const WindowsRun& run) { return run.what.settings.wetRoad ? &rained : &truth; },
        [&](const WindowsRun& run) { return options.pictures && pictured(run); },
        [&](WindowsRun& run, WindowsPicture&& picture) {
            if (run.ms.empty()) return;
            const WindowRow row =
                windowRowOf(run, static_cast<std::uint32_t>(set.visible), size, picture.errors);
            result.rows.push_back(row);
            if (picture.seen.rgba.empty()) return;
            const Picture shown = cutOut({size.x, size.y, picture.seen.rgba}, corner, piece);
            PictureStrip& into = row.wet ? wet : strip;
            into.frames.push_back({row.name,
                                   fixed(row.ratioToPainted, 2) + " of the time with painted windows",
                                   row.flip, shown, differencePicture(shown, into.truth)});
        });
    for (PictureStrip* s : {&strip, &wet})
        if (!s->frames.empty()) result.strips.push_back(std::move(*s));
    if (!interrupted()) countFronts(scene, prepared, renderer, options, set, result);
    return result;
}

}  // namespace app
