#include "app/commands/CompareChrome.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "app/commands/CarsStage.h"
#include "app/commands/CloseViews.h"
#include "app/commands/KerbsideShots.h"
#include "app/commands/SquareShots.h"
#include "app/compare/PictureErrorsOf.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/StandingReflectors.h"
#include "app/report/Progress.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

namespace {

constexpr std::uint32_t carsOnStreets = 30;
constexpr double apart = 0.5;         ///< metres from what stands to the car parked beside it
constexpr double stagedSeconds = 16;  ///< in which the moment of a staged view is looked for
constexpr glm::ivec2 stripSize(640, 360);
constexpr std::array<std::string_view, 6> methods{"truth", "none", "mem", "chrome", "rerender", "raytrace"};

struct CloseShot {
    std::string name;
    FrameScene frame;
    CloseViews::Counts counts;
};

std::vector<CloseShot> viewsOf(const Scene& scene, const CloseViews& close, const CompareOptions& options) {
    std::vector<CloseShot> views;
    const vehicles::Traffic traffic = startTraffic(scene, options.seed, carsOnStreets);
    const FrameScene frame = assembleFrame(scene.city, traffic, scene.lighting, {}, scene.staged);
    for (const SquareShot& shot : squareShots(scene.city, options.resolution)) {
        if (!shot.reflector || !shot.name.ends_with("near")) continue;
        const city::StandingReflector& reflector = scene.city.reflectors[*shot.reflector];
        if (reflector.stuff != city::StandingReflector::Stuff::chrome) continue;
        CloseShot view{reflector.name + " beside a car", frame, {}};
        view.frame.views = {shot.view};
        parkBeside(view.frame, scene, *shot.reflector, apart);
        view.counts = [id = firstStandingId + *shot.reflector](const TracedPicture& picture, std::size_t i) {
            return picture.vehicle[i] == id;
        };
        views.push_back(std::move(view));
    }
    if (scene.staged.empty()) return views;
    for (KerbsideShot& shot :
         kerbsideShots(scene, close.close().parts, frame, options.resolution, stagedSeconds)) {
        const std::uint32_t id = shot.frame.vehicles[shot.vehicle].id;
        views.push_back({shot.name, std::move(shot.frame), [id](const TracedPicture& picture, std::size_t i) {
                             return picture.vehicle[i] == id &&
                                    picture.surface[i] ==
                                        static_cast<std::uint32_t>(vehicles::Surface::chrome);
                         }});
    }
    return views;
}

}  // namespace

ChromeComparison compareChrome(const Scene& scene, const PreparedReflections& prepared,
                               SceneRenderer& renderer, const CompareOptions& options, Quality quality) {
    ChromeComparison result;
    CloseViews close(scene, prepared, renderer, options.resolution, quality);
    const std::vector<CloseShot> views = viewsOf(scene, close, options);
    Progress progress("close chrome", views.size(), options.quiet);
    for (const CloseShot& view : views) {
        if (interrupted()) break;
        const std::vector<unsigned char> mask = close.pixelsOf(view.frame, view.counts);
        const auto pixels = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
        if (pixels == 0) continue;
        const std::vector<CloseViews::Drawn> drawn = close.draw(view.frame, methods, mask);
        if (drawn.size() < methods.size()) break;
        const std::span timed = std::span(methods).subspan(1);
        const std::vector<std::vector<double>> ms = close.time(view.frame, timed, options.frames);
        const glm::ivec2 size = options.resolution, piece = glm::min(stripSize, size);
        const glm::ivec2 corner = richestWindow(mask, size, piece);
        PictureStrip strip;
        strip.title = view.name;
        strip.truth = cutOut(drawn.front().picture, corner, piece);
        for (std::size_t m = 0; m < timed.size(); ++m) {
            const CloseViews::Drawn& of = drawn[m + 1];
            if (ms[m].empty()) break;
            ChromeRow row;
            row.view = view.name;
            row.method = of.method;
            row.jobs = static_cast<std::uint32_t>(of.plan.jobs.size());
            row.pixels = pixels;
            row.width = size.x;
            row.height = size.y;
            row.frame = timingOf(ms[m]);
            std::vector<double> ratio;
            for (std::size_t k = 0; k < std::min(ms[m].size(), ms[0].size()); ++k)
                ratio.push_back(ms[m][k] / ms[0][k]);
            row.ratioToNone = timingOf(ratio).median;
            row.psnr = of.psnr;
            row.flip = of.flip;
            if (options.pictures) {
                const Picture shown = cutOut(of.picture, corner, piece);
                strip.frames.push_back({row.method, fixed(row.frame.median, 1) + " ms a frame", row.flip,
                                        shown, differencePicture(shown, strip.truth)});
            }
            result.rows.push_back(std::move(row));
        }
        if (!strip.frames.empty()) result.strips.push_back(std::move(strip));
        progress.advance();
    }
    return result;
}

}  // namespace app
