#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <string_view>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/CloseViews.h"
#include "app/commands/KerbsideShots.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/SquareChrome.h"
#include "app/commands/Version.h"
#include "app/frame/AssembleFrame.h"
#include "app/report/AsideFile.h"
#include "app/report/Progress.h"
#include "reflection/gl/ShaderSource.h"

namespace app {

namespace {

constexpr double lookedAhead = 16;  // seconds: the cyclist of kerbside.json drives as long

using Table = std::vector<std::vector<std::string>>;

constexpr std::array<std::string_view, 6> methods{"truth", "none", "mem", "chrome", "rerender", "raytrace"};
constexpr std::uint32_t framesOfMotion = 12;
constexpr double frameTime = 1.0 / 30;  ///< seconds
constexpr double approach = 0.08;       ///< metres a frame: somebody walks up to it
/// From where the part is too small to show close things until it does wholly, and back.
constexpr std::uint32_t framesOfApproach = 40;
constexpr double approachFrom = 0.5, approachTo = 2.5;  ///< of the size at which it begins to

/// Pixels of the chrome of one vehicle.
CloseViews::Counts chromeOf(const KerbsideShot& shot) {
    const std::uint32_t id = shot.frame.vehicles[shot.vehicle].id;
    return [id](const TracedPicture& picture, std::size_t i) {
        return picture.vehicle[i] == id &&
               picture.surface[i] == static_cast<std::uint32_t>(vehicles::Surface::chrome);
    };
}

/// The same chrome while somebody walks up to it, and while what passes it drives on.
void measureMoving(const Options& options, CloseViews& views, const Scene& scene, const KerbsideShot& shot,
                   ResultFile& results, Table& table) {
    const glm::mat4& m = shot.frame.views.front().viewFromWorld;
    const glm::dvec3 back(m[0][2], m[1][2], m[2][2]);
    measureMotion(
        options, views, shot.name + ", eye approaches",
        [&](std::uint32_t k) {
            FrameScene frame = shot.frame;
            frame.views.front().eye += approach * (framesOfMotion - 1 - k) * back;
            return frame;
        },
        framesOfMotion, chromeOf(shot), results, table);
    if (interrupted()) return;
    // By size, so that each frame brings the same share of the change.
    const double begins = shot.pixels / ChromeDetail{}.leastPixels * shot.away;
    measureMotion(
        options, views, shot.name + ", eye comes and goes",
        [&](std::uint32_t k) {
            const double t = 1 - std::abs(2.0 * k / (framesOfApproach - 1) - 1);
            const double size = approachFrom * std::pow(approachTo / approachFrom, t);
            FrameScene frame = shot.frame;
            frame.views.front().eye += std::max(begins / size - shot.away, 0.0) * back;
            return frame;
        },
        framesOfApproach, chromeOf(shot), results, table);
    if (interrupted() || !(shot.apart > 0)) return;
    measureMotion(
        options, views, shot.name + ", passed by",
        [&](std::uint32_t k) {
            FrameScene frame = shot.frame;
            moveStaged(frame, scene, shot.seconds + frameTime * (k - 0.75 * framesOfMotion));
            return frame;
        },
        framesOfMotion, chromeOf(shot), results, table);
}

}  // namespace

int benchKerbside(const Options& asked) {
    Options options = asked;
    if (!options.staged) options.staged = reflection::gl::dataFolder() / "staged" / "kerbside.json";
    if (!asked.staged && asked.city != Options().city)
        spdlog::warn(
            "kerbside.json stages the boulevard's street; in {} its vehicles stand at the same metres, "
            "wherever that is: name vehicles of this city with --staged FILE.json",
            asked.city);
    requireWritable(options.out / "kerbside_truth.png");
    PreparedScene stage(options);
    ResultFile results("kerbside", std::string(programVersion), stage.context.renderer());
    Table table{{"picture or frames", "pixels", "PSNR dB", "FLIP", "", "without, ms", "ms", "/ without"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    const Scene& scene = stage.scene;
    CloseViews views(scene, stage.reflections, stage.renderer, options.resolution, options.quality,
                     {.share = options.chromeShare, .bounces = options.chromeBounces});
    const vehicles::Traffic traffic = startTraffic(scene, options.seed, options.cars.front());
    const FrameScene frame = assembleFrame(scene.city, traffic, scene.lighting, {}, scene.staged);
    const std::vector<KerbsideShot> shots =
        kerbsideShots(scene, views.close().parts, frame, options.resolution, lookedAhead);
    if (shots.empty()) spdlog::error("no view of the staged vehicles shows chrome that is large enough");
    for (const KerbsideShot& shot : shots) {
        if (interrupted()) break;
        if (shot.name.find(options.view) == std::string::npos) continue;
        spdlog::info("{}: at {:.2f} s, {:.2f} m apart", shot.name, shot.seconds, shot.apart);
        measureCloseUp(
            options, views,
            {shot.name, "kerbside", shot.frame, methods, chromeOf(shot), {{"seconds", shot.seconds}}},
            results, table);
        if (!interrupted()) measureMoving(options, views, scene, shot, results, table);
        if (!interrupted())
            measureChromeCost(options, stage, views.close(), shot.name, shot.frame.views.front(), shot.frame,
                              shot.vehicle, results, table);
    }
    return reportBench(options, results, table);
}

}  // namespace app
