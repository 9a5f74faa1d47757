#include "app/commands/CarsBench.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "app/commands/CarsStage.h"
#include "app/commands/MirrorMask.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ReflectionEngine.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/Readback.h"
#include "app/report/Progress.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

ReflectionSettings withoutParallax(ReflectionSettings settings) {
    settings.parallax = false;
    return settings;
}

struct MethodRun {
    std::string name;
    std::unique_ptr<ReflectionEngine> engine;
    std::vector<double> frameMs;
    double psnrSum = 0, flipSum = 0, maps = 0;
    std::uint32_t compared = 0;
};

}  // namespace

std::vector<CarsRow> runCarsBench(const Scene& scene, const PreparedReflections& prepared,
                                  SceneRenderer& renderer, const CarsBenchOptions& options) {
    std::vector<CarsRow> rows;
    const OffscreenTarget target(options.resolution);
    MirrorMask mirrors;
    RayTracer rays(scene.city, scene.models);
    Progress progress("frames", options.cars.size() * (options.frames + options.warmUp), options.quiet);
    for (const std::uint32_t cars : options.cars) {
        CarsStage stage = setCarsStage(scene, renderer, cars, options.seed, options.resolution);
        if (!stage.traffic) {
            spdlog::warn("the city has no street to look down; nothing was measured for {} cars", cars);
            continue;
        }
        if (stage.visible < cars) spdlog::warn("only {} of {} cars fit on screen", stage.visible, cars);

        std::vector<MethodRun> methods;
        const auto add = [&](std::string name, ReflectionMethod method, MemVariant variant,
                             MapsOn mapsOn = MapsOn::cpu) {
            ReflectionSettings settings;
            settings.shareMaps = false;  // each vehicle a map of its own
            settings.method = method;
            settings.variant = variant;
            settings.quality = options.quality;
            settings.mapsOn = mapsOn;
            settings.gpuMapBytes = options.gpuMapBytes;
            MethodRun run;
            run.name = std::move(name);
            run.engine =
                std::make_unique<ReflectionEngine>(*prepared.tracer, prepared.maps, scene.models, settings);
            methods.push_back(std::move(run));
        };
        add("none", ReflectionMethod::none, MemVariant::ours);
        add("static", ReflectionMethod::fixed, MemVariant::ours);
        add("blend", ReflectionMethod::blend, MemVariant::ours);
        add("box", ReflectionMethod::box, MemVariant::ours);
        add("mem paper", ReflectionMethod::mem, MemVariant::paper);
        add("mem", ReflectionMethod::mem, MemVariant::ours);
        // Re-rendered maps are environment maps as well: this is what comes near to them, and `mem` to the
        // truth.
        add("mem flat", ReflectionMethod::mem, MemVariant::ours);
        methods.back().engine->configure(withoutParallax(methods.back().engine->settings()));
        if (options.mapsOn == MapsOn::gpu ||
            (options.mapsOn == MapsOn::automatic && !reflection::softwareRenderer()))
            add("mem gpu", ReflectionMethod::mem, MemVariant::ours, MapsOn::gpu);
        add("raytrace", ReflectionMethod::raytrace, MemVariant::ours);
        methods.back().engine->useRayTracer(&rays, [&] { return renderer.sunMap(); });
        add("rerender", ReflectionMethod::rerender, MemVariant::ours);

        Cast cast(cars);
        std::uint32_t visible = 0;
        for (std::uint32_t frame = 0; frame < options.warmUp + options.frames && !interrupted(); ++frame) {
            for (double ahead = 0; ahead < options.frameStep; ahead += vehicles::TrafficOptions{}.step)
                stage.traffic->step();
            FrameScene picture =
                assembleFrame(scene.city, *stage.traffic, scene.lighting, {stage.view}, scene.staged);
            cast.select(picture, stage.view, renderer);
            const bool measured = frame >= options.warmUp;

            std::vector<Image8> images;
            for (MethodRun& method : methods) {
                // Re-rendering holds nothing from frame to frame: its warm-up would only cost time.
                if (!measured && method.engine->settings().method == ReflectionMethod::rerender &&
                    frame + 1 < options.warmUp)
                    continue;
                finishDrawing();
                const Stopwatch watch;
                renderer.prepare(picture);
                VehicleReflections reflections;
                if (method.engine->settings().method != ReflectionMethod::none) {
                    const std::vector<SeenVehicle> seen = seenIn(renderer, picture.views);
                    visible = static_cast<std::uint32_t>(seen.size());
                    const ReflectionPlan& plan = method.engine->update(picture, seen, renderer);
                    reflections = {method.engine->textures(), plan.slots,
                                   method.engine->mirroredIn(stage.view)};
                }
                renderer.drawView(stage.view, reflections, target.framebuffer());
                finishDrawing();
                if (!measured) continue;
                method.frameMs.push_back(watch.elapsed());
                method.maps += method.engine->counters().rebuilt;
                images.push_back(readPixels(target.framebuffer(), target.size()));
            }
            if (measured) {
                const std::vector<unsigned char> mask = mirrors.of(renderer, picture, target);
                const std::vector<glm::vec3> truth = toFloat(images.back());
                const int width = options.resolution.x, height = options.resolution.y;
                for (std::size_t m = 0; m < methods.size(); ++m) {
                    const std::vector<glm::vec3> test = toFloat(images[m]);
                    methods[m].psnrSum +=
                        reflection::psnr({width, height, test}, {width, height, truth}, mask);
                    methods[m].flipSum += reflection::meanError(
                        reflection::flip({width, height, test}, {width, height, truth}), mask);
                    ++methods[m].compared;
                }
            }
            progress.advance();
        }

        const std::vector<double>& none = methods.front().frameMs;
        const std::vector<double>& rerender = methods.back().frameMs;
        for (const MethodRun& method : methods) {
            if (method.compared == 0) continue;
            CarsRow row;
            row.method = method.name;
            row.cars = cars;
            row.visible = visible;
            row.frame = timingOf(method.frameMs);
            std::vector<double> extra, ratio, against;
            for (std::size_t i = 0; i < method.frameMs.size(); ++i) {
                extra.push_back(method.frameMs[i] - none[i]);
                ratio.push_back(method.frameMs[i] / none[i]);
                against.push_back((rerender[i] - none[i]) / std::max(method.frameMs[i] - none[i], 1e-3));
            }
            row.reflection = timingOf(extra);
            row.ratioToNone = timingOf(ratio).median;
            // What costs nothing has no share of re-rendering's cost.
            if (method.engine->settings().method != ReflectionMethod::none)
                row.rerenderRatio = timingOf(against).median;
            row.psnr = method.psnrSum / method.compared;
            row.flip = method.flipSum / method.compared;
            row.mapsPerFrame = method.maps / method.compared;
            row.textureBytes =
                method.engine->counters().localMapBytes + method.engine->counters().referenceMapGpuBytes;
            rows.push_back(row);
        }
        if (interrupted()) break;
    }
    return rows;
}

}  // namespace app
