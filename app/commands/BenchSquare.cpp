#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/CloseViews.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/SquareChrome.h"
#include "app/commands/SquareShots.h"
#include "app/commands/StoneBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/StandingReflectors.h"
#include "app/report/AsideFile.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

namespace {

constexpr double lookedAhead = 60;  // seconds in which the busiest moment is looked for
constexpr std::uint32_t framesBefore = 20, framesMeasured = 80;

using Table = std::vector<std::vector<std::string>>;

constexpr std::array<std::string_view, 9> methods{"truth", "none",   "static",   "blend",   "box",
                                                  "mem",   "chrome", "rerender", "raytrace"};
constexpr std::uint32_t framesOfMotion = 12;
constexpr double carStep = 0.15;  ///< metres a frame: 4.5 m/s at 30 frames a second

/// Pixels of one reflector, or of all.
CloseViews::Counts pixelsOf(const SquareShot& shot) {
    return [reflector = shot.reflector](const TracedPicture& picture, std::size_t i) {
        if (picture.vehicle[i] < firstStandingId) return false;
        return !reflector || picture.vehicle[i] == firstStandingId + *reflector;
    };
}

void measureShot(const Options& options, CloseViews& views, const SquareShot& shot, FrameScene frame,
                 ResultFile& results, Table& table) {
    frame.views = {shot.view};
    measureCloseUp(options, views, {shot.name, "square", frame, methods, pixelsOf(shot)}, results, table);
}

/// A reflector that the car parked beside it drives past.
void measurePassing(const Options& options, CloseViews& views, const SquareShot& shot,
                    const FrameScene& parked, ResultFile& results, Table& table) {
    const std::string& name = shot.name;
    measureMotion(
        options, views, name + ", which drives by",
        [&](std::uint32_t k) {
            FrameScene frame = parked;
            frame.views = {shot.view};
            vehicles::VehiclePose& car = frame.vehicles.front();
            const double along = carStep * (k - 0.5 * framesOfMotion);
            car.position += along * glm::dvec3(std::cos(car.heading), std::sin(car.heading), 0);
            car.speed = 30 * carStep;
            return frame;
        },
        framesOfMotion, pixelsOf(shot), results, table);
}

struct Case {
    std::string name;
    bool stand = false;  ///< nothing moves
    bool away = false;   ///< the view is turned round: none is in it
};

/// Frames with the reflectors beside frames without them, in turn, by `mem`.
void measureCost(const Options& options, PreparedScene& stage, const View& view, vehicles::Traffic& traffic,
                 ResultFile& results, Table& table) {
    const Scene& scene = stage.scene;
    const OffscreenTarget target(options.resolution);
    const glm::mat4& v = view.viewFromWorld;
    const glm::dvec3 back(glm::dvec3(v[0][2], v[1][2], v[2][2]));
    const std::vector<Case> cases{{"in view, traffic drives"},
                                  {"in view, traffic stands", true},
                                  {"none in view, traffic drives", false, true}};
    Progress progress("frames", cases.size() * (framesBefore + framesMeasured), options.quiet);
    for (const Case& what : cases) {
        const View seenFrom =
            what.away ? lookAt(view.eye, view.eye + back,
                               2 * std::atan(1 / std::abs(view.clipFromView[1][1])), options.resolution)
                      : view;
        ReflectionSettings settings;
        settings.quality = options.quality;
        ReflectionEngine engines[2]{
            {*stage.reflections.tracer, stage.reflections.maps, scene.models, settings},
            {*stage.reflections.tracer, stage.reflections.maps, scene.models, settings}};
        std::vector<double> ms[2], ratio, reflecting[2];
        std::uint64_t maps[2] = {0, 0}, ofReflectors = 0, seenReflectors = 0;
        for (std::uint32_t i = 0; i < framesBefore + framesMeasured && !interrupted(); ++i) {
            if (!what.stand) traffic.step();
            FrameScene with = assembleFrame(scene.city, traffic, scene.lighting, {seenFrom}, scene.staged);
            if (what.stand)
                for (vehicles::VehiclePose& pose : with.vehicles) pose.speed = 0;
            FrameScene without = with;
            std::erase_if(without.vehicles, stands);
            double took[2] = {0, 0};
            for (int turn = 0; turn < 2; ++turn) {
                const int k = (turn + static_cast<int>(i)) % 2;
                const FrameScene& frame = k == 1 ? with : without;
                finishDrawing();
                const Stopwatch watch;
                stage.renderer.prepare(frame);
                const ReflectionPlan& plan =
                    engines[k].update(frame, seenIn(stage.renderer, frame.views), stage.renderer);
                stage.renderer.drawView(seenFrom, {engines[k].textures(), plan.slots}, target.framebuffer());
                finishDrawing();
                took[k] = watch.elapsed();
                if (i < framesBefore) continue;
                maps[k] += plan.jobs.size();
                reflecting[k].push_back(engines[k].counters().milliseconds);
                if (k == 0) continue;
                for (const MapJob& job : plan.jobs) ofReflectors += stands(frame.vehicles[job.vehicle]);
                for (std::size_t s = 0; s < plan.slots.size(); ++s)
                    seenReflectors += plan.slots[s].valid() && stands(frame.vehicles[s]);
            }
            progress.advance();
            if (i < framesBefore) continue;
            for (const int k : {0, 1}) ms[k].push_back(took[k]);
            ratio.push_back(took[1] / took[0]);
        }
        if (ratio.empty()) return;
        const auto perFrame = [](std::uint64_t n) { return static_cast<double>(n) / framesMeasured; };
        const double middle = timingOf(ratio).median;
        results.add({{"what", what.name},
                     {"city", options.city},
                     {"width", options.resolution.x},
                     {"height", options.resolution.y},
                     {"reflectors_with_maps", perFrame(seenReflectors)},
                     {"their_maps_per_frame", perFrame(ofReflectors)},
                     {"maps_per_frame", perFrame(maps[1])},
                     {"maps_per_frame_without", perFrame(maps[0])},
                     {"reflection_ms", toJson(timingOf(reflecting[1]))},
                     {"reflection_ms_without", toJson(timingOf(reflecting[0]))},
                     {"frame_ms", toJson(timingOf(ms[1]))},
                     {"frame_ms_without", toJson(timingOf(ms[0]))},
                     {"ratio_to_without", middle}});
        table.push_back({what.name, "", "", "", fixed(perFrame(ofReflectors), 2),
                         fixed(timingOf(ms[0]).median, 2), fixed(timingOf(ms[1]).median, 2),
                         fixed(middle, 3)});
    }
}

}  // namespace

int benchSquare(const Options& options) {
    requireWritable(options.out / "square_truth.png");
    PreparedScene stage(options);
    ResultFile results("square", std::string(programVersion), stage.context.renderer());
    Table table{
        {"picture or frames", "pixels", "PSNR dB", "FLIP", "maps a frame", "without, ms", "ms", "/ without"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    const std::vector<SquareShot> shots = squareShots(stage.scene.city, options.resolution);
    if (shots.empty()) {
        spdlog::error("nothing stands in this city that mirrors: boulevard has a sphere and a pillar");
        return exitFailed;
    }
    const Scene& scene = stage.scene;
    const auto wanted = [&](const std::string& name) { return name.find(options.view) != std::string::npos; };
    vehicles::Traffic traffic = busyTraffic(scene, options.seed, options.cars.front(), lookedAhead);
    {
        CloseViews views(scene, stage.reflections, stage.renderer, options.resolution, options.quality,
                         {.share = options.chromeShare, .bounces = options.chromeBounces});
        const FrameScene frame =
            assembleFrame(stage.scene.city, traffic, stage.scene.lighting, {}, stage.scene.staged);
        for (const PairShot& shot : pairShots(scene.city, options.resolution)) {
            if (interrupted()) break;
            if (!wanted(shot.name)) continue;
            FrameScene pair = frame;
            pair.views = {shot.view};
            bringBeside(pair, shot);
            const auto twice = [&](const TracedPicture&, std::size_t i) {
                return metTwice(scene.city, shot, i);
            };
            measureCloseUp(
                options, views,
                {shot.name, "square", pair, methods, twice, {{"chrome_bounces", options.chromeBounces}}},
                results, table);
            measureChromeCost(
                options, stage, views.close(), shot.name, shot.view, pair,
                static_cast<std::uint32_t>(pair.vehicles.size() - scene.city.reflectors.size()) + shot.sphere,
                results, table);
        }
        for (const SquareShot& shot : shots) {
            if (interrupted()) break;
            if (wanted(shot.name)) measureShot(options, views, shot, frame, results, table);
            if (!shot.reflector || !shot.name.ends_with("near")) continue;
            SquareShot parkedBy = shot;
            parkedBy.name = scene.city.reflectors[*shot.reflector].name + " beside a car";
            if (!wanted(parkedBy.name)) continue;
            FrameScene parked = frame;
            parkBeside(parked, scene, *shot.reflector, 0.5);
            measureShot(options, views, parkedBy, parked, results, table);
            if (scene.city.reflectors[*shot.reflector].stuff == city::StandingReflector::Stuff::chrome &&
                !interrupted()) {
                measurePassing(options, views, parkedBy, parked, results, table);
                if (interrupted()) break;
                measureChromeCost(
                    options, stage, views.close(), parkedBy.name, parkedBy.view, parked,
                    static_cast<std::uint32_t>(parked.vehicles.size() - scene.city.reflectors.size()) +
                        *shot.reflector,
                    results, table);
            }
        }
    }
    if (!options.view.empty() || !options.part.empty()) return reportBench(options, results, table);
    if (!interrupted()) measureCost(options, stage, shots.back().view, traffic, results, table);
    if (!interrupted()) measureStone(options, stage, std::move(traffic), results, table);
    return reportBench(options, results, table);
}

}  // namespace app
