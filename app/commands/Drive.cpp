#include "app/commands/Drive.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "app/commands/Calibration.h"
#include "app/commands/CityMirrors.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/CloseScene.h"
#include "app/frame/WetRoad.h"
#include "app/report/Timing.h"

namespace app {

namespace {

/// Drawings of a first view from which a fixed quality is chosen: some steps of the governor.
constexpr int framesOfChoice = 40;

}  // namespace

Drive::Drive(const Scene& scene, const Options& options, std::string renderer)
    : scene_(&scene),
      seed_(options.seed),
      mapsOn_(options.mapsOn),
      gpuMapBytes_(options.gpuMapBytes()),
      resolution_(options.resolution),
      rendererName_(std::move(renderer)),
      settings_{options.method,  options.mem,         options.quality,       options.cars.front(),
                options.hour,    options.budgetMs,    options.error,         options.fixedQuality,
                options.mirrors, options.mirrorDepth, options.mirrorMaps,    options.mirrorFade,
                options.chrome,  options.chromeShare, options.chromeBounces, options.weather,
                options.adapt},
      traffic_(startTraffic(scene, options.seed, options.cars.front())),
      mirrorPlanner_(scene.glass.fronts),
      waitForChrome_(options.offscreen || options.fixedQuality),
      lighting_(scene.lighting) {
    makeRenderer();
    preparation_.cell = static_cast<float>(options.cell);
    preparation_.quiet = options.quiet;
}

Drive::~Drive() = default;

bool Drive::startReflecting(const CarryOn& carryOn, const CarryOn& calibrating) {
    if (settings_.method != ReflectionMethod::none && !reflectIn(lighting_, carryOn)) return false;
    govern(calibrating);
    return true;
}

void Drive::makeRenderer() {
    renderer_.reset();
    renderer_ = std::make_unique<SceneRenderer>(scene_->city, scene_->models, renderOptions());
    renderer_->setGlass(scene_->glass.fronts);
    renderer_->setCloseScene(closeScene_.get());
}

MirrorSettings Drive::mirrorSettings(const View& view) const {
    MirrorSettings settings;
    settings.on = settings_.mirrors;
    settings.depth = settings_.mirrorDepth;
    settings.maps = settings_.mirrorMaps;
    settings.fade = settings_.mirrorFade;
    if (settings_.weather == Weather::wet) settings.wetRoad = roadSeenBy(scene_->city.roads, view);
    return settings;
}

void Drive::makeCloseScene() {
    if (closeScene_) return;
    closeScene_ = std::make_unique<CloseScene>(scene_->city, scene_->models);
    closeScene_->parts.keepIn(cacheFolder() / "chrome",
                              [](const std::string& text) { spdlog::warn("{}", text); });
    renderer_->setCloseScene(closeScene_.get());
}

ChromePlan Drive::chromePlan(std::span<const SeenVehicle> seen) {
    if (!settings_.chrome || settings_.method == ReflectionMethod::raytrace) return {};
    makeCloseScene();
    std::vector<std::uint32_t> indices;
    for (const SeenVehicle& vehicle : seen) indices.push_back(vehicle.index);
    ChromePlanOptions options;
    options.wait = waitForChrome_;
    if (governor_) options.leastPixels = governor_->detail().chrome.leastPixels;
    ChromePlan plan = planChrome(frame_, indices, scene_->models, closeScene_->parts, options, &chromeFades_);
    chromeFades_.follow(plan);
    return plan;
}

void Drive::govern(const CarryOn& calibrating) {
    governor_.reset();
    choosing_ = false;
    renderer_->setDetail({});
    if (!engine_ || !settings_.governed()) return;
    if (!ladder_) {
        CalibrationOptions options;
        options.resolution = resolution_;
        options.antialiasing = renderOptions().antialiasing;
        options.mapsOn = mapsOn_;
        options.gpuMapBytes = gpuMapBytes_;
        options.renderer = rendererName_;
        options.quiet = preparation_.quiet;
        options.carryOn = calibrating;
        MirrorSettings windows;
        windows.on = settings_.mirrors;
        windows.depth = settings_.mirrorDepth;
        windows.maps = settings_.mirrorMaps;
        windows.fade = settings_.mirrorFade;
        CityMirrors mirrors(*scene_, windows, settings_.weather == Weather::wet);
        options.mirrors = &mirrors;
        if (settings_.chrome) {
            makeCloseScene();
            options.close = closeScene_.get();
            options.chromeBounces = settings_.chromeBounces;
        }
        const Stopwatch watch;
        Calibration calibration = calibrate(*scene_, lighting_, prepared_, *renderer_, options);
        if (!calibration.complete || calibration.ladder.empty()) {
            spdlog::warn("no calibration, no budget: quality stays {}", nameOf(settings_.quality));
            settings_.budgetMs = settings_.error = 0;
            return;
        }
        ladder_ = std::move(calibration.ladder);
        if (calibration.fromCache)
            spdlog::info("calibration of this machine and city, from {}:\n{}", calibration.file.string(),
                         describe(*ladder_));
        else
            spdlog::info("calibrated this machine and city in {:.1f} s, kept in {}:\n{}",
                         watch.elapsed() / 1000,
                         calibration.file.empty() ? "memory" : calibration.file.string(), describe(*ladder_));
    }
    DetailLadder ladder = *ladder_;
    double budget = settings_.budgetMs;
    // A budget is met by what the first view takes: see chooseOnce.
    choosing_ = settings_.error <= 0 && settings_.fixedQuality;
    if (settings_.error > 0) {
        // One rung: there is nowhere to go.
        const Rung chosen = ladder.at(ladder.positionForError(settings_.error));
        if (chosen.error > settings_.error)
            spdlog::warn("the finest detail has an error of {:.4f}: {} cannot be met", chosen.error,
                         settings_.error);
        const std::string less = givenUp(ladder.rungs().front().detail, chosen.detail);
        spdlog::info("chosen: {:.1f} ms a frame, FLIP {:.4f} on mirrors{}{}", chosen.ms(), chosen.error,
                     less.empty() ? "" : "; given up: ", less);
        ladder = DetailLadder({chosen});
        budget = std::numeric_limits<double>::infinity();
    }
    governor_.emplace(std::move(ladder), budget);
    if (std::isfinite(budget)) renderer_->prepareForChanges(resolution_);
}

bool Drive::reflectIn(const Lighting& lighting, const CarryOn& carryOn) {
    FrameScene empty;
    empty.lighting = lighting;
    empty.signalColours.assign(scene_->city.signalHeads.size(), vehicles::SignalColour::red);
    renderer_->prepare(empty);
    PreparationOptions preparation = preparation_;
    preparation.carryOn = carryOn;
    preparation.maps = readsReferenceMaps(settings_.method);
    const Stopwatch watch;
    PreparedReflections prepared = prepareReflections(scene_->city, lighting, *renderer_, preparation);
    if (!prepared.complete) return false;
    if (preparation.maps)
        spdlog::info(
            "{} reference maps see {:.1f}% of what can be seen from the lanes ({} from the cache, {} drawn, "
            "{:.1f} s)",
            prepared.maps.size(), 100 * prepared.coverage, prepared.loaded, prepared.baked,
            watch.elapsed() / 1000);
    engine_.reset();  // before the maps that it reads
    prepared_ = std::move(prepared);
    engine_ = std::make_unique<ReflectionEngine>(*prepared_.tracer, prepared_.maps, scene_->models,
                                                 reflectionSettings());
    lendRays();
    return true;
}

void Drive::lendRays() {
    if (settings_.method != ReflectionMethod::raytrace || !engine_) return;
    if (!rays_) rays_ = std::make_unique<RayTracer>(scene_->city, scene_->models);
    engine_->useRayTracer(rays_.get(), [this] { return renderer_->sunMap(); });
}

ReflectionSettings Drive::reflectionSettings() const {
    ReflectionSettings settings;
    settings.method = settings_.method;
    settings.variant = settings_.mem;
    settings.quality = settings_.quality;
    settings.mapsOn = mapsOn_;
    settings.gpuMapBytes = gpuMapBytes_;
    settings.wet = settings_.weather == Weather::wet;
    return settings;
}

RenderOptions Drive::renderOptions() const {
    RenderOptions options;
    options.shadows = settings_.quality != Quality::low;
    options.antialiasing = settings_.quality == Quality::low      ? Antialiasing::none
                           : settings_.quality == Quality::medium ? Antialiasing::fxaa
                                                                  : Antialiasing::msaa4;
    return options;
}

void Drive::advance(double seconds) {
    if (traffic_.size() == 0) return;
    // A long pause (a window that was dragged) is not caught up with.
    lead_ += std::clamp(seconds, 0.0, 0.5);
    double before = traffic_.time();
    while (lead_ > 0) {
        traffic_.step();
        lead_ -= traffic_.time() - before;
        before = traffic_.time();
    }
}

FrameStats Drive::draw(const View& view, std::uint32_t framebuffer, double seconds) {
    frame_ = assembleFrame(scene_->city, traffic_, lighting_, {view}, scene_->staged);
    if (settings_.adapt && prepared_.tracer)
        frame_.adaptation =
            adaptation_.follow(exposureAround(*prepared_.tracer, lighting_, view.eye), view.eye, seconds);
    if (!rehearsed_) {
        rehearsed_ = true;
        drawFrame(view, framebuffer);
        finishDrawing();
        timer_ = {};
    }
    if (choosing_) chooseOnce(view, framebuffer);
    return drawFrame(view, framebuffer);
}

void Drive::chooseOnce(const View& view, std::uint32_t framebuffer) {
    for (int i = 0; i < framesOfChoice; ++i) drawFrame(view, framebuffer);
    choosing_ = false;
    const DetailLadder& ladder = governor_->ladder();
    // A whole rung: so that another run, with times a little different, chooses the same.
    const double position = std::ceil(governor_->position());
    Rung chosen = ladder.at(position);
    const double here = governor_->predictedMs() / ladder.at(governor_->position()).ms();
    const double predicted = here * chosen.ms();
    const std::string less = givenUp(ladder.rungs().front().detail, chosen.detail);
    spdlog::info(
        "chosen from {} drawings of the first view, which takes {:.2f} times what the calibration's did: "
        "{:.1f} ms a "
        "frame, FLIP {:.4f} on mirrors{}{}",
        framesOfChoice, here, predicted, chosen.error, less.empty() ? "" : "; given up: ", less);
    if (predicted > settings_.budgetMs)
        spdlog::warn("the lowest detail takes {:.1f} ms, more than the budget of {:.1f} ms", predicted,
                     settings_.budgetMs);
    chosen.drawingMs *= here;
    chosen.reflectionMs *= here;
    governor_.emplace(DetailLadder({chosen}), std::numeric_limits<double>::infinity());
}

FrameStats Drive::drawFrame(const View& view, std::uint32_t framebuffer) {
    FrameStats stats;
    timer_.begin();
    renderer_->prepare(frame_);
    reflections_ = {};
    const auto planMirrors = [&] {
        MirrorSettings settings = mirrorSettings(view);
        if (governor_) settings.limit(governor_->detail());
        mirrorPlan_ = mirrorPlanner_.plan(std::span(&view, 1), settings,
                                          [this](const auto& from, const auto* glass, const auto& box) {
                                              return renderer_->hides(from, glass, box);
                                          });
    };
    planMirrors();
    ChromePlan chrome;
    PlanarReflections planar;
    if (settings_.mirrors) planar.plan = &mirrorPlan_;
    planar.wet = settings_.weather == Weather::wet;
    if (settings_.method != ReflectionMethod::none && engine_) {
        std::vector<SeenVehicle> seen;
        for (const auto& visible : renderer_->visibleVehicles(view, planar))
            seen.push_back({visible.index, visible.diameterPixels});
        if (governor_) {
            // The detail follows from what is seen, in windows too: those of the detail before.
            const MirrorDetail before = governor_->detail().mirrors;
            stats.governed = chooseDetail(seen.size(), view);
            if (!(governor_->detail().mirrors == before)) planMirrors();
        }
        const Stopwatch reflecting;
        const ReflectionPlan& plan = engine_->update(frame_, seen, *renderer_);
        reflections_ = {engine_->textures(), plan.slots, engine_->mirroredIn(view), renewedBy(plan)};
        stats.reflectionMs = reflecting.elapsed();
        stats.reflections = engine_->counters();
        chrome = chromePlan(seen);
        stats.chromeParts = chrome.parts;
        stats.chromeLeftOut = chrome.leftOut;
        stats.chromeMaking = chrome.making;
        if (closeScene_) stats.chromeBytes = closeScene_->parts.bytes();
    }
    ChromeDrawing chromeDrawing;
    chromeDrawing.share = settings_.chromeShare;
    chromeDrawing.bounces = settings_.chromeBounces;
    chromeDrawing.wait = waitForChrome_;
    if (governor_) chromeDrawing.bouncePixels = governor_->detail().chrome.bouncePixels;
    renderer_->drawView(view, reflections_, framebuffer, planar, {&chrome, 0, chromeDrawing});
    stats.frameMs = timer_.end();
    stats.drawn = renderer_->counters();
    stats.mirrors = mirrorPlan_.counters;
    if (governor_) {
        FrameCost cost{stats.frameMs, stats.reflectionMs, stats.reflections.visible,
                       stats.reflections.texels};
        // The same frame again and again needs no new maps: they are taken for what they cost elsewhere.
        if (choosing_) {
            const double maps = governor_->ladder().at(governor_->position()).reflectionMs;
            cost.frameMs += std::max(maps - cost.reflectionMs, 0.0);
            cost.reflectionMs = std::max(cost.reflectionMs, maps);
        }
        governor_->observe(cost);
        // With one rung nothing was to be held.
        if (const auto news = governor_->news(); news && governor_->ladder().rungs().size() > 1)
            spdlog::info("{}", *news);
    }
    return stats;
}

Governed Drive::chooseDetail(std::size_t seen, const View& view) {
    governor_->expect({seen, !choosing_ && renderer_->drewLast(view)});
    const Rung rung = governor_->ladder().at(governor_->position());
    renderer_->setDetail(governor_->detail().drawing, governor_->dissolveFrames());
    ReflectionSettings reflecting = reflectionSettings();
    reflecting.detail = governor_->detail().reflection;
    engine_->configure(reflecting);
    return {true,
            governor_->position(),
            governor_->ladder().last(),
            governor_->predictedMs(),
            rung.error,
            ladder_ ? givenUp(ladder_->rungs().front().detail, rung.detail) : std::string()};
}

bool Drive::change(const DriveSettings& wanted, const CarryOn& carryOn, const CarryOn& calibrating) {
    const DriveSettings old = settings_;
    settings_ = wanted;
    if (wanted.cars != old.cars) traffic_ = startTraffic(*scene_, seed_, wanted.cars);
    if (wanted.quality != old.quality) {
        makeRenderer();
        ladder_.reset();
    }
    // What was measured with windows, rain or close chrome does not hold without.
    if (wanted.mirrors != old.mirrors || wanted.weather != old.weather || wanted.chrome != old.chrome ||
        wanted.chromeBounces != old.chromeBounces)
        ladder_.reset();
    const bool relit = wanted.hour != old.hour;
    const Lighting lighting =
        relit ? lightingAt(wanted.hour, scene_->city.frame ? scene_->city.frame->latitude() : 50) : lighting_;
    const bool reflects = wanted.method != ReflectionMethod::none;
    bool finished = true;
    const bool mapsMissing = readsReferenceMaps(wanted.method) && prepared_.maps.empty();
    if (reflects && (!engine_ || relit || mapsMissing)) finished = reflectIn(lighting, carryOn);
    if (finished) {
        lighting_ = lighting;
        // Maps of another light are of no use later.
        if (!reflects && relit) engine_.reset();
    } else {
        settings_.hour = old.hour;
        settings_.method = engine_ && !mapsMissing ? wanted.method : old.method;
    }
    if (engine_ && settings_.method != ReflectionMethod::none) {
        engine_->configure(reflectionSettings());
        lendRays();
    }
    const auto asked = [](const DriveSettings& s) { return std::tuple(s.budgetMs, s.error, s.fixedQuality); };
    if (settings_.governed() != (governor_ != std::nullopt) || asked(settings_) != asked(old) ||
        (governor_ && !ladder_))
        govern(calibrating);
    return finished;
}

}  // namespace app
