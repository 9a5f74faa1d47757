#include "app/commands/CompareWindows.h"

#include <algorithm>

#include "app/commands/MirrorMask.h"
#include "app/compare/PictureErrorsOf.h"
#include "app/report/Table.h"

namespace app {

namespace {

constexpr std::uint32_t windowCars = 30;
/// Of the pictures that are kept.
constexpr glm::ivec2 stripSize(640, 360);

/// The first is what the others are measured by.
std::vector<WindowsCase> comparedCases(std::uint32_t frames) {
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
    return cases;
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

WindowComparison compareWindows(const Scene& scene, const PreparedReflections& prepared,
                                SceneRenderer& renderer, const CompareOptions& options) {
    WindowComparison result;
    if (scene.glass.fronts.empty()) return result;
    CarsStage set = setCarsStage(scene, renderer, windowCars, options.seed, options.resolution);
    if (!set.traffic || interrupted()) return result;
    WindowsStage stage(scene, prepared, renderer, options.resolution, comparedCases(options.frames));
    {
        Progress progress("windows", WindowsStage::framesBefore + options.frames, options.quiet);
        stage.measure(set, options.frames, progress);
    }
    if (interrupted()) return result;
    const FrameScene frame = stage.frameOf(set);
    const WindowsTruth truth = stage.truthOf(frame);
    const glm::ivec2 size = options.resolution, piece = glm::min(stripSize, size);
    const glm::ivec2 corner = richestWindow(truth.glass, size, piece);
    const Image8 display = toImage(truth.display, size);
    PictureStrip strip;
    strip.title = "windows of a street with " + std::to_string(set.visible) + " cars";
    strip.truth = cutOut({size.x, size.y, display.rgba}, corner, piece);
    stage.compare(
        frame, [&](const WindowsRun&) { return &truth; },
        [&](const WindowsRun& run) { return options.pictures && pictured(run); },
        [&](WindowsRun& run, WindowsPicture&& picture) {
            if (run.ms.empty()) return;
            const WindowRow row =
                windowRowOf(run, static_cast<std::uint32_t>(set.visible), size, picture.errors);
            result.rows.push_back(row);
            if (picture.seen.rgba.empty()) return;
            const Picture shown = cutOut({size.x, size.y, picture.seen.rgba}, corner, piece);
            strip.frames.push_back({row.name,
                                    fixed(row.ratioToPainted, 2) + " of the time with painted windows",
                                    row.flip, shown, differencePicture(shown, strip.truth)});
        });
    if (!strip.frames.empty()) result.strips.push_back(std::move(strip));
    return result;
}

}  // namespace app
