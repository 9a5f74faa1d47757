#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/ReflectionSource.h"
#include "app/commands/SquareChrome.h"
#include "app/commands/SquareShots.h"
#include "app/commands/StoneBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/StandingReflectors.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr double lookedAhead = 60;  // seconds in which the busiest moment is looked for
constexpr std::uint32_t framesBefore = 20, framesMeasured = 80;

using Table = std::vector<std::vector<std::string>>;

std::string fileName(std::string shot, const std::string& method) {
    std::ranges::replace(shot, ' ', '_');
    return "square_" + shot + "_" + method + ".png";
}

std::vector<std::uint32_t> indicesOf(std::span<const SeenVehicle> seen) {
    std::vector<std::uint32_t> indices;
    for (const SeenVehicle& v : seen) indices.push_back(v.index);
    return indices;
}

/// Errors of every method on the pixels of one reflector (or of all), against many rays through each.
class Errors {
  public:
    Errors(const Options& options, PreparedScene& stage)
        : options_(options),
          stage_(stage),
          target_(options.resolution),
          rays_(stage.scene.city, stage.scene.models),
          close_(stage.scene.city, stage.scene.models) {
        stage.renderer.setCloseScene(&close_);
    }
    ~Errors() { stage_.renderer.setCloseScene(nullptr); }

    void measure(const SquareShot& shot, FrameScene frame, ResultFile& results, Table& table) {
        SceneRenderer& renderer = stage_.renderer;
        frame.views = {shot.view};
        renderer.prepare(frame);
        const std::vector<SeenVehicle> seen = seenIn(renderer, frame.views);
        rays_.prepare(frame);
        const std::vector<unsigned char> mask = pixelsOf(shot);
        const auto pixels = std::count(mask.begin(), mask.end(), 1);
        if (pixels == 0) {
            spdlog::warn("{}: nothing of it is seen", shot.name);
            return;
        }
        std::vector<glm::vec3> truth;
        const std::vector<std::pair<std::string, std::optional<ReflectionMethod>>> methods{
            {"truth", std::nullopt},
            {"none", ReflectionMethod::none},
            {"static", ReflectionMethod::fixed},
            {"blend", ReflectionMethod::blend},
            {"box", ReflectionMethod::box},
            {"mem", ReflectionMethod::mem},
            {"chrome", ReflectionMethod::mem},
            {"rerender", ReflectionMethod::rerender},
            {"raytrace", ReflectionMethod::raytrace}};
        for (const auto& [name, method] : methods) {
            if (interrupted()) return;
            ReflectionSettings settings;
            settings.method = method.value_or(ReflectionMethod::none);
            settings.quality = options_.quality;
            settings.everyFrame = true;
            const std::unique_ptr<ReflectionSource> source =
                method ? engineSource(stage_.scene, stage_.reflections, settings, rays_) : tracedTruth(rays_);
            renderer.prepare(frame);
            source->beginFrame(frame, seen, renderer);
            ChromePlan plan;
            if (name == "chrome")
                plan = planChrome(frame, indicesOf(seen), stage_.scene.models, close_.parts, {});
            renderer.drawView(shot.view, source->forView(shot.view, renderer), target_.framebuffer(), {},
                              {&plan, 0, {}});
            if (name == "chrome") {
                const ChromeCounts& c = renderer.counters().chrome;
                spdlog::info(
                    "{}: {} jobs, {} meshes, {} vertices, {} searched, {} triangles, {:.1f} ms ({:.1f} "
                    "searching)",
                    shot.name, c.jobs, c.meshes, c.vertices, c.searched, c.triangles, c.milliseconds,
                    c.searchMilliseconds);
            }
            const Image8 image = readPixels(target_.framebuffer(), target_.size());
            const std::string file = fileName(shot.name, name);
            writePng({image.size.x, image.size.y, image.rgba}, options_.out / file);
            const std::vector<glm::vec3> shown = toFloat(image);
            if (!method) truth = shown;
            const int w = image.size.x, h = image.size.y;
            const double psnr = reflection::psnr({w, h, shown}, {w, h, truth}, mask);
            const double flip = reflection::meanError(reflection::flip({w, h, shown}, {w, h, truth}), mask);
            results.add({{"what", shot.name},
                         {"method", name},
                         {"city", options_.city},
                         {"pixels", pixels},
                         {"psnr_db", psnr},
                         {"mean_flip", flip}});
            table.push_back({file, std::to_string(pixels), fixed(psnr, 1), fixed(flip, 4), "", "", "", ""});
        }
    }

    const CloseScene& close() const { return close_; }

  private:
    std::vector<unsigned char> pixelsOf(const SquareShot& shot) const {
        TraceOptions plain;
        plain.plain = true;
        const TracedPicture picture = rays_.render(shot.view, plain);
        std::vector<unsigned char> mask(picture.kind.size());
        for (std::size_t i = 0; i < mask.size(); ++i) {
            if (picture.kind[i] != SeenKind::vehicle || picture.vehicle[i] < firstStandingId) continue;
            mask[i] = !shot.reflector || picture.vehicle[i] == firstStandingId + *shot.reflector ? 1 : 0;
        }
        return mask;
    }

    const Options& options_;
    PreparedScene& stage_;
    OffscreenTarget target_;
    RayTracer rays_;
    CloseScene close_;
};

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
    vehicles::Traffic traffic = busyTraffic(scene, options.seed, options.cars.front(), lookedAhead);
    {
        Errors errors(options, stage);
        const FrameScene frame =
            assembleFrame(stage.scene.city, traffic, stage.scene.lighting, {}, stage.scene.staged);
        for (const SquareShot& shot : shots) {
            if (interrupted()) break;
            errors.measure(shot, frame, results, table);
            if (!shot.reflector || !shot.name.ends_with("near")) continue;
            SquareShot parkedBy = shot;
            parkedBy.name = scene.city.reflectors[*shot.reflector].name + " beside a car";
            FrameScene parked = frame;
            parkBeside(parked, scene, *shot.reflector, 0.5);
            errors.measure(parkedBy, parked, results, table);
            if (scene.city.reflectors[*shot.reflector].stuff == city::StandingReflector::Stuff::chrome &&
                !interrupted())
                measureChromeCost(
                    options, stage, errors.close(), parkedBy.name, parkedBy.view, parked,
                    static_cast<std::uint32_t>(parked.vehicles.size() - scene.city.reflectors.size()) +
                        *shot.reflector,
                    results, table);
        }
    }
    if (!interrupted()) measureCost(options, stage, shots.back().view, traffic, results, table);
    if (!interrupted()) measureStone(options, stage, std::move(traffic), results, table);
    return reportBench(options, results, table);
}

}  // namespace app
