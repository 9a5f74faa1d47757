#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <string>

#include "app/commands/Benches.h"
#include "app/commands/CarsStage.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ReflectionEngine.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

namespace {

constexpr std::uint32_t cars = 60;
constexpr std::uint32_t framesBefore = 20, framesMeasured = 60;

struct Case {
    std::string name;
    bool away = false;    ///< all vehicles are behind the eye
    bool nobody = false;  ///< there are none
    bool stands = false;  ///< nothing moves
};

}  // namespace

int benchEmpty(const Options& options) {
    PreparedScene stage(options);
    ResultFile results("empty", std::string(programVersion), stage.context.renderer());
    if (!stage.reflections.complete) return reportBench(options, results, {});
    const OffscreenTarget target(options.resolution);
    CarsStage set = setCarsStage(stage.scene, stage.renderer, cars, options.seed, options.resolution);
    if (!set.traffic) throw std::runtime_error("the city has no street to look down.");

    std::vector<std::vector<std::string>> table{
        {"what there is", "vehicles", "seen", "maps", "rays", "texels", "none, ms", "mem, ms", "mem / none"}};
    const std::vector<Case> cases{{"no vehicle", false, true, false},
                                  {"all out of sight", true, false, false},
                                  {"all in view stand", false, false, true}};
    Progress progress("frames", cases.size() * (framesBefore + framesMeasured), options.quiet);
    for (const Case& what : cases) {
        ReflectionEngine engine(*stage.reflections.tracer, stage.reflections.maps, stage.scene.models, {});
        std::vector<double> none, mem, ratio;
        ReflectionCounters most;
        std::size_t vehicleCount = 0;
        for (std::uint32_t i = 0; i < framesBefore + framesMeasured && !interrupted(); ++i) {
            if (!what.stands) set.traffic->step();
            FrameScene frame = assembleFrame(stage.scene.city, *set.traffic, stage.scene.lighting, {set.view},
                                             stage.scene.staged);
            if (what.nobody) frame.vehicles.clear();
            if (what.stands)
                for (vehicles::VehiclePose& pose : frame.vehicles) pose.speed = 0;
            if (what.away) {
                stage.renderer.prepare(frame);
                std::vector<bool> seen(frame.vehicles.size(), false);
                for (const SeenVehicle& v : seenIn(stage.renderer, frame.views)) seen[v.index] = true;
                std::vector<vehicles::VehiclePose> unseen;
                for (std::size_t v = 0; v < seen.size(); ++v)
                    if (!seen[v]) unseen.push_back(frame.vehicles[v]);
                frame.vehicles = std::move(unseen);
            }
            vehicleCount = frame.vehicles.size();
            double ms[2] = {0, 0};
            for (int turn = 0; turn < 2; ++turn) {
                const bool reflects = (turn == 0) == (i % 2 == 0);
                finishDrawing();
                const Stopwatch watch;
                stage.renderer.prepare(frame);
                VehicleReflections reflections;
                if (reflects) {
                    const ReflectionPlan& plan =
                        engine.update(frame, seenIn(stage.renderer, frame.views), stage.renderer);
                    reflections.textures = engine.textures();
                    reflections.slots = plan.slots;
                }
                stage.renderer.drawView(set.view, reflections, target.framebuffer());
                finishDrawing();
                ms[reflects ? 1 : 0] = watch.elapsed();
            }
            progress.advance();
            if (i < framesBefore) continue;
            none.push_back(ms[0]);
            mem.push_back(ms[1]);
            ratio.push_back(ms[1] / ms[0]);
            const ReflectionCounters& now = engine.counters();
            most.visible = std::max(most.visible, now.visible);
            most.rebuilt = std::max(most.rebuilt, now.rebuilt);
            most.rays = std::max(most.rays, now.rays);
            most.texels = std::max(most.texels, now.texels);
        }
        if (none.empty()) continue;
        const double middle = timingOf(ratio).median;
        results.add({{"method", "mem"},
                     {"city", options.city},
                     {"what", what.name},
                     {"vehicles", vehicleCount},
                     {"visible", most.visible},
                     {"maps_updated_most", most.rebuilt},
                     {"rays_most", most.rays},
                     {"texels_most", most.texels},
                     {"width", options.resolution.x},
                     {"height", options.resolution.y},
                     {"none_ms", toJson(timingOf(none))},
                     {"frame_ms", toJson(timingOf(mem))},
                     {"ratio_to_none", middle}});
        table.push_back({what.name, std::to_string(vehicleCount), std::to_string(most.visible),
                         std::to_string(most.rebuilt), std::to_string(most.rays), std::to_string(most.texels),
                         fixed(timingOf(none).median, 2), fixed(timingOf(mem).median, 2), fixed(middle, 4)});
    }
    return reportBench(options, results, table);
}

}  // namespace app
