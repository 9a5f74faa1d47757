#include "app/commands/Calibration.h"

#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <thread>

#include "app/commands/DetailBench.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/CameraRig.h"
#include "app/report/AsideFile.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

namespace {

/// Changes when the measuring does.
constexpr int calibrationVersion = 11;
/// Many: what is given up first must help where there are many.
constexpr std::uint32_t calibrationCars = 120;
constexpr double frameStep = 1.0 / 25;
/// Share of the finest frame that a step must save: less is noise.
constexpr double leastSaving = 0.01;
/// Where the fastest times scatter more than this however often they are repeated, nothing is kept for later
/// runs.
constexpr double steadyEnough = 0.15;

using Clip = DetailBench::Clip;

std::vector<Clip> recordClips(const Scene& scene, const Lighting& lighting,
                              const CalibrationOptions& options) {
    vehicles::Traffic traffic = startTraffic(scene, options.seed, calibrationCars);
    CameraRig camera(scene.city.tour, scene.city.bounds);
    std::vector<Clip> clips;
    for (const CameraMode mode : {CameraMode::follow, CameraMode::tour}) {
        camera.setMode(mode, traffic.poses());
        Clip& clip = clips.emplace_back();
        for (std::size_t i = 0; i < DetailBench::framesBefore + DetailBench::framesMeasured; ++i) {
            const double until = traffic.time() + frameStep;
            while (traffic.size() > 0 && traffic.time() < until) traffic.step();
            camera.update(frameStep, traffic.poses(), {});
            clip.push_back(assembleFrame(
                scene.city, traffic, lighting,
                {lookAt(camera.pose().eye, camera.pose().target, glm::radians(60.0), options.resolution)},
                scene.staged));
        }
    }
    return clips;
}

/// The rungs that a ladder keeps, with what is seen from each to the next.
std::vector<Rung> withJumps(const DetailBench& bench, std::span<const DetailBench::Measured> inOrder) {
    std::vector<Rung> rungs;
    for (const DetailBench::Measured& measured : inOrder) rungs.push_back(measured.rung);
    const DetailLadder kept(rungs);
    rungs.assign(kept.rungs().begin(), kept.rungs().end());
    const auto measuredAs = [&](const Rung& rung) {
        return std::ranges::find_if(inOrder, [&](const auto& m) { return m.rung.detail == rung.detail; });
    };
    tbb::parallel_for(std::size_t{1}, rungs.size(), [&](std::size_t i) {
        rungs[i].jump = bench.jump(*measuredAs(rungs[i - 1]), *measuredAs(rungs[i]));
    });
    return rungs;
}

/// What mirrors flatly, where anything does.
const CityMirrors* mirrorsOf(const CalibrationOptions& options) {
    return options.mirrors != nullptr && options.mirrors->any() ? options.mirrors : nullptr;
}

Detail finestDetail(const CityMirrors* mirrors) {
    Detail finest{detailOf(Quality::high), {}};
    if (mirrors != nullptr) finest.mirrors = mirrors->most();
    return finest;
}

/// Each knob turned down alone, fine to coarse.
std::vector<Trial> trialsFor(Antialiasing antialiasing, const CityMirrors* mirrors, bool chrome) {
    std::vector<Trial> trials;
    const auto add = [&](Knob knob, std::initializer_list<double> values) {
        for (const double value : values) trials.push_back({knob, value, 0, 0});
    };
    // Not the texel budget: what it saves comes with more vehicles than there are here, and the governor sees
    // to it. Nor the vehicles' levels: twice as far off saves 1% (llvmpipe, 120 cars), a bus that loses its
    // windows adds as much to the error on mirrors as half the picture's size, and is seen three times as
    // well as its motion.
    add(Knob::texelsPerPixel, {0.25});
    add(Knob::errorThreshold, {1});
    add(Knob::candidates, {3});
    add(Knob::lookups, {4});
    // Steps of about a fifth of the pixels: with steps of a third, the best of them was up to 27% below the
    // budget (medians of 11.7 to 13.8 ms of 16.1).
    add(Knob::scale, {0.92, 0.85, 0.77, 0.7, 0.65, 0.6, 0.55, 0.5, 0.42, 0.35});
    if (antialiasing == Antialiasing::fxaa) add(Knob::antialiasing, {0.5, 0});
    // Not all of it: the clips have little, and would have close-ups lose theirs first.
    if (chrome) add(Knob::chromePixels, {48, 96, 192});
    if (mirrors == nullptr) return trials;
    // One reflection less is one picture less: from half of them to none.
    const MirrorDetail most = mirrors->most();
    add(Knob::mirrorTexels, {0.7, 0.5});
    if (most.depth > 1) add(Knob::mirrorDepth, {1});
    for (const double maps : {4, 2, 1, 0})
        if (maps < most.maps) trials.push_back({Knob::mirrorMaps, maps, 0, 0});
    return trials;
}

std::string keyOf(const Scene& scene, const CalibrationOptions& options) {
    const bool gpu = options.mapsOn == MapsOn::gpu ||
                     (options.mapsOn == MapsOn::automatic && !reflection::softwareRenderer());
    std::ostringstream key;
    key << "calibration " << calibrationVersion << "; " << options.renderer << "; " << processorName()
        << " x " << std::thread::hardware_concurrency() << "; city " << std::hex << scene.city.contentHash()
        << std::dec << "; " << options.resolution.x << "x" << options.resolution.y << "; antialiasing "
        << static_cast<int>(options.antialiasing) << "; maps on " << (gpu ? "gpu" : "cpu") << "; seed "
        << options.seed;
    // Cities in which nothing mirrors flatly have one calibration for all weathers.
    if (const CityMirrors* mirrors = mirrorsOf(options))
        key << "; windows " << mirrors->most().maps << " in a row " << mirrors->most().depth
            << (mirrors->wet() ? "; wet" : "");
    if (options.close != nullptr) key << "; close chrome up to 192 pixels";
    return key.str();
}

std::filesystem::path fileFor(const std::string& key, const CalibrationOptions& options) {
    std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a
    for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    std::ostringstream name;
    name << "calibration-" << std::hex << std::setw(16) << std::setfill('0') << hash << ".json";
    return (options.cache.empty() ? cacheFolder() : options.cache) / name.str();
}

}  // namespace

std::string ladderToText(const DetailLadder& ladder, const std::string& key) {
    nlohmann::ordered_json rungs = nlohmann::ordered_json::array();
    for (Rung rung : ladder.rungs()) {
        nlohmann::ordered_json values = nlohmann::ordered_json::object();
        for (std::size_t k = 0; k < knobNames.size(); ++k)
            values[std::string(knobNames[k])] = valueOf(rung.detail, static_cast<Knob>(k));
        rungs.push_back({{"detail", values},
                         {"drawing_ms", rung.drawingMs},
                         {"reflection_ms", rung.reflectionMs},
                         {"mean_flip", rung.error},
                         {"picture_flip", rung.pictureError},
                         {"jump_flip", rung.jump}});
    }
    return nlohmann::ordered_json{{"key", key},
                                  {"vehicles", ladder.vehicles().vehicles},
                                  {"vehicle_ms", ladder.vehicles().ms},
                                  {"rungs", rungs}}
               .dump(2) +
           "\n";
}

std::optional<DetailLadder> ladderFromText(const std::string& text, const std::string& key) {
    const nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
    try {
        if (document.at("key") != key) return std::nullopt;
        std::vector<Rung> rungs;
        for (const nlohmann::json& from : document.at("rungs")) {
            Rung& rung = rungs.emplace_back();
            for (std::size_t k = 0; k < knobNames.size(); ++k) {
                // What is not named is as fine as it gets.
                const double value = from.at("detail").value(std::string(knobNames[k]),
                                                             valueOf(rung.detail, static_cast<Knob>(k)));
                if (!std::isfinite(value) || value < 0) return std::nullopt;
                valueOf(rung.detail, static_cast<Knob>(k)) = value;
            }
            rung.drawingMs = from.at("drawing_ms").get<double>();
            rung.reflectionMs = from.at("reflection_ms").get<double>();
            rung.error = from.at("mean_flip").get<double>();
            rung.pictureError = from.at("picture_flip").get<double>();
            rung.jump = from.at("jump_flip").get<double>();
        }
        const VehicleCost vehicles{document.at("vehicles").get<double>(),
                                   document.at("vehicle_ms").get<double>()};
        if (!std::isfinite(vehicles.vehicles) || !(vehicles.ms >= 0)) return std::nullopt;
        DetailLadder ladder(rungs, vehicles);
        if (ladder.empty()) return std::nullopt;
        return ladder;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

Calibration calibrate(const Scene& scene, const Lighting& lighting, const PreparedReflections& prepared,
                      SceneRenderer& renderer, const CalibrationOptions& options) {
    Calibration calibration;
    const std::string key = keyOf(scene, options);
    if (options.useCache) {
        calibration.file = fileFor(key, options);
        if (std::ifstream in(calibration.file); in) {
            const std::string text{std::istreambuf_iterator<char>(in), {}};
            if (auto ladder = ladderFromText(text, key)) {
                calibration.ladder = std::move(*ladder);
                calibration.fromCache = true;
                return calibration;
            }
            spdlog::warn("{}: the calibration is damaged; it is measured again", calibration.file.string());
        }
    }

    std::vector<Trial> trials = trialsFor(options.antialiasing, mirrorsOf(options), options.close != nullptr);
    const std::vector<Clip> clips = recordClips(scene, lighting, options);
    // The rungs are about as many as the trials, not known before.
    const std::size_t steps = 2 * DetailBench::steps(clips.size(), 1 + trials.size());
    Progress progress("calibration", steps, options.quiet);
    std::size_t done = 0;
    const auto goOn = [&] {
        progress.advance();
        done = std::min(done + 1, steps);
        return !interrupted() && (!options.carryOn || options.carryOn(done, steps));
    };
    calibration.complete = false;
    ReflectionSettings reflecting;
    reflecting.mapsOn = options.mapsOn;
    reflecting.gpuMapBytes = options.gpuMapBytes;
    DetailBench bench(scene, prepared, renderer, reflecting, clips, options.mirrors, options.close);

    const Detail full = finestDetail(mirrorsOf(options));
    std::vector<Detail> alone{full};
    for (const Trial& trial : trials) valueOf(alone.emplace_back(full), trial.knob) = trial.value;
    const std::vector<DetailBench::Measured> tried = bench.measure(alone, goOn);
    if (tried.empty()) return calibration;
    const Rung& finest = tried.front().rung;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        trials[i].savedMs = finest.ms() - tried[i + 1].rung.ms();
        trials[i].lost = tried[i + 1].rung.loss() - finest.loss();
    }
    const std::vector<DetailBench::Measured> inOrder =
        bench.measure(orderOfGivingUp(full, trials, leastSaving * finest.ms()), goOn);
    if (inOrder.empty()) return calibration;
    calibration.scatter = bench.scatter();
    calibration.ladder = DetailLadder(withJumps(bench, inOrder), bench.vehicleCost());
    calibration.complete = true;
    if (calibration.scatter > steadyEnough) {
        spdlog::warn(
            "the machine is busy: like frames differ by {:.0f}%. The calibration is rough, and holds for "
            "this "
            "run alone.",
            100 * calibration.scatter);
        calibration.file.clear();
    } else if (options.useCache)
        try {
            writeTextFile(calibration.file, ladderToText(calibration.ladder, key));
        } catch (const std::runtime_error& error) {
            spdlog::warn("{} The calibration holds for this run alone.", error.what());
            calibration.file.clear();
        }
    return calibration;
}

std::string describe(const DetailLadder& ladder) {
    std::vector<std::vector<std::string>> table{{"given up, one after the other", "frame ms", "reflections",
                                                 "FLIP on mirrors", "beside them", "from the one before"}};
    Detail before = ladder.empty() ? Detail{} : ladder.rungs().front().detail;
    for (const Rung& rung : ladder.rungs()) {
        std::string step = givenUp(before, rung.detail);
        if (step.empty()) step = table.size() == 1 ? "nothing" : "nothing more, and some is back";
        table.push_back({step, fixed(rung.ms(), 1), fixed(rung.reflectionMs, 2), fixed(rung.error, 4),
                         fixed(rung.pictureError, 4), fixed(rung.jump, 4)});
        before = rung.detail;
    }
    return formatTable(table);
}

}  // namespace app
