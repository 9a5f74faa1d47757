#include "app/commands/SquareChrome.h"

#include <array>
#include <cmath>

#include "app/commands/CarsStage.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/frame/ReflectionEngine.h"
#include "app/report/Progress.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

namespace {

constexpr std::uint32_t framesBefore = 8, framesMeasured = 40;
constexpr double eyeStep = 0.02;  // metres a frame

struct Case {
    std::string name;
    bool moves = false;
    bool away = false;
};

}  // namespace

void measureChromeCost(const Options& options, PreparedScene& stage, const CloseScene& close,
                       const std::string& name, const View& from, FrameScene frame, std::uint32_t reflector,
                       ResultFile& results, std::vector<std::vector<std::string>>& table) {
    if (!options.part.empty() && options.part != "cost") return;
    const Scene& scene = stage.scene;
    SceneRenderer& renderer = stage.renderer;
    const OffscreenTarget target(options.resolution);
    const glm::mat4& v = from.viewFromWorld;
    const glm::dvec3 right(v[0][0], v[1][0], v[2][0]), back(v[0][2], v[1][2], v[2][2]);
    ReflectionSettings settings;
    settings.quality = options.quality;
    ReflectionEngine engine(*stage.reflections.tracer, stage.reflections.maps, scene.models, settings);
    ReflectionSettings again = settings;
    again.method = ReflectionMethod::rerender;
    again.everyFrame = true;
    ReflectionEngine rerender(*stage.reflections.tracer, stage.reflections.maps, scene.models, again);
    const std::array<Case, 3> cases{
        {{"chrome, eye moves", true}, {"chrome, all stands"}, {"no chrome in view", true, true}}};
    Progress progress("frames", cases.size() * (framesBefore + framesMeasured), options.quiet);
    for (const Case& what : cases) {
        std::vector<double> ms[2], ratio, more, searching, all, oneMap;
        std::uint64_t jobs = 0, drawn = 0, vertices = 0, searched = 0, triangles = 0, pictures = 0, picturesDrawn = 0;
        for (std::uint32_t i = 0; i < framesBefore + framesMeasured && !interrupted(); ++i) {
            View view = from;
            if (what.moves) view.eye += eyeStep * std::abs(static_cast<double>(i % 20) - 10) * right;
            if (what.away)
                view = lookAt(view.eye, view.eye + back, 2 * std::atan(1 / std::abs(view.clipFromView[1][1])),
                              options.resolution);
            frame.views = {view};
            double took[2] = {0, 0};
            for (int turn = 0; turn < 2; ++turn) {
                const int k = (turn + static_cast<int>(i)) % 2;
                finishDrawing();
                const Stopwatch watch;
                renderer.prepare(frame);
                const std::vector<SeenVehicle> seen = seenIn(renderer, frame.views);
                const ReflectionPlan& plan = engine.update(frame, seen, renderer);
                std::vector<std::uint32_t> indices;
                for (const SeenVehicle& s : seen) indices.push_back(s.index);
                ChromePlanOptions chromeOptions;
                chromeOptions.on = k == 1;
                const ChromePlan chrome =
                    planChrome(frame, indices, scene.models, close.parts, chromeOptions);
                renderer.drawView(view, {engine.textures(), plan.slots, 0, renewedBy(plan)},
                                  target.framebuffer(), {}, {&chrome, 0, {.bounces = options.chromeBounces}});
                finishDrawing();
                took[k] = watch.elapsed();
                if (i < framesBefore || k == 0) continue;
                const ChromeCounts& c = renderer.counters().chrome;
                jobs += c.jobs;
                drawn += c.drawn;
                vertices += c.vertices;
                searched += c.searched;
                triangles += c.triangles;
                pictures += c.bounces.pictures;
                picturesDrawn += c.bounces.drawn;
                searching.push_back(c.searchMilliseconds);
                all.push_back(c.milliseconds);
            }
            if (!what.away) {
                const std::vector<SeenVehicle> one{{reflector, 500}};
                const Stopwatch watch;
                rerender.update(frame, one, renderer);
                finishDrawing();
                if (i >= framesBefore) oneMap.push_back(watch.elapsed());
            }
            progress.advance();
            if (i < framesBefore) continue;
            for (const int k : {0, 1}) ms[k].push_back(took[k]);
            ratio.push_back(took[1] / took[0]);
            more.push_back(took[1] - took[0]);
        }
        if (ratio.empty()) return;
        const auto perFrame = [](std::uint64_t n) { return static_cast<double>(n) / framesMeasured; };
        const double middle = timingOf(ratio).median;
        results.add({{"what", name + ": " + what.name},
                     {"city", options.city},
                     {"width", options.resolution.x},
                     {"height", options.resolution.y},
                     {"chrome_jobs", perFrame(jobs)},
                     {"jobs_drawn", perFrame(drawn)},
                     {"chrome_bounces", options.chromeBounces},
                     {"pictures", perFrame(pictures)},
                     {"pictures_drawn", perFrame(picturesDrawn)},
                     {"vertices", perFrame(vertices)},
                     {"searched", perFrame(searched)},
                     {"triangles", perFrame(triangles)},
                     {"search_ms", toJson(timingOf(searching))},
                     {"chrome_ms", toJson(timingOf(all))},
                     {"one_rerendered_map_ms", toJson(timingOf(oneMap))},
                     {"added_ms", toJson(timingOf(more))},
                     {"frame_ms", toJson(timingOf(ms[1]))},
                     {"frame_ms_without", toJson(timingOf(ms[0]))},
                     {"ratio_to_without", middle}});
        table.push_back({name + ": " + what.name + ": " + fixed(perFrame(searched) / 1000, 1) +
                             "k searched, " + fixed(perFrame(pictures), 1) + " pictures (" + fixed(perFrame(picturesDrawn), 1) + " anew), in " +
                             fixed(timingOf(searching).median, 1) + " ms, " +
                             fixed(timingOf(more).median, 1) + " ms a frame; one map drawn: " +
                             (oneMap.empty() ? "-" : fixed(timingOf(oneMap).median, 1)) + " ms",
                         "", "", "", "", fixed(timingOf(ms[0]).median, 2), fixed(timingOf(ms[1]).median, 2),
                         fixed(middle, 3)});
    }
}

}  // namespace app
