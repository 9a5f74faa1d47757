#include "app/commands/Calibration.h"

#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <thread>

#include "app/commands/ChromeClip.h"
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
constexpr int calibrationVersion = 12;
/// Many: what is given up first must help where there are many.
constexpr std::uint32_t calibrationCars = 120;
constexpr double frameStep = 1.0 / 25;
/// Share of the finest frame that a step must save: less is noise.
constexpr double leastSaving = 0.01;
/// Share that a rung must be expected to save over those that lose less, to be measured.
constexpr double leastStep = 0.04;
/// Share of frames in which chrome is taken to be as near as in the clip for it: as one clip of three.
constexpr double chromeShare = 1.0 / 3;
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
std::vector<Trial> trialsFor(Antialiasing antialiasing, const CityMirrors* mirrors, bool chrome,
                             bool bounces) {
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
    // Not all of it: close-ups would lose theirs. What chrome shows of other chrome may go.
    if (chrome && bounces) add(Knob::bouncePixels, {48, 96, ChromeDetail::none});
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

bool ofChrome(Knob knob) {
    return knob == Knob::chromePixels || knob == Knob::bouncePixels;
}

/// What pictures of other sizes cost and lose lies between those that are measured.
bool measured(const Trial& trial) {
    if (trial.knob != Knob::scale) return true;
    constexpr std::array<double, 3> scales{0.77, 0.55, 0.35};
    return std::ranges::find(scales, trial.value) != scales.end();
}

/// By the number of pixels.
void interpolateSizes(std::vector<Trial>& trials) {
    const auto pixels = [](const Trial& t) { return t.value * t.value; };
    for (Trial& trial : trials) {
        if (measured(trial)) continue;
        Trial above{Knob::scale, 1, 0, 0}, below = above;
        for (const Trial& t : trials) {
            if (t.knob != Knob::scale || !measured(t)) continue;
            if (t.value > trial.value && t.value < above.value) above = t;
            if (t.value < trial.value && (below.value == 1 || t.value > below.value)) below = t;
        }
        const double way = (pixels(above) - pixels(trial)) / (pixels(above) - pixels(below));
        trial.savedMs = above.savedMs + way * (below.savedMs - above.savedMs);
        trial.lost = above.lost + way * (below.lost - above.lost);
    }
}

/// What a detail saves and loses against the finest, by the trials of its knobs.
struct Expected {
    double savedMs = 0, lost = 0;
};
template <typename Counts>
Expected expectedOf(Detail detail, std::span<const Trial> trials, const Counts& counts) {
    Expected sum;
    for (const Trial& t : trials) {
        if (!counts(t.knob) || valueOf(detail, t.knob) != t.value) continue;
        sum.savedMs += t.savedMs;
        sum.lost += std::max(t.lost, 0.0);
    }
    return sum;
}

/// Those details of an order, and of its cheapest of the full size in all others, that are worth measuring:
/// by the trials, none that loses less costs as little. An order begins anew with each size of the picture,
/// so that most of it costs more than what went before.
std::vector<Detail> worthMeasuring(const std::vector<Detail>& order, std::span<const Trial> trials,
                                   double finestMs) {
    struct Rated {
        const Detail* detail;
        double ms, lost;
    };
    std::vector<Rated> rated;
    std::vector<Detail> all = order;
    const auto fullSize = [](const Detail& d) { return d.drawing.scale == 1; };
    Detail small = *std::ranges::find_if(order.rbegin(), order.rend(), fullSize);
    for (const Trial& trial : trials) {
        if (trial.knob != Knob::scale) continue;
        small.drawing.scale = trial.value;
        all.push_back(small);
    }
    for (const Detail& detail : all) {
        const Expected size = expectedOf(detail, trials, [](Knob k) { return k == Knob::scale; }),
                       other = expectedOf(detail, trials, [](Knob k) { return k != Knob::scale; });
        const double left = std::max(1 - size.savedMs / finestMs, 0.0);
        rated.push_back({&detail, left * (finestMs - other.savedMs), size.lost + other.lost});
    }
    std::stable_sort(rated.begin(), rated.end(),
                     [](const Rated& a, const Rated& b) { return a.lost < b.lost; });
    std::vector<Detail> worth{all.front()};
    double least = finestMs;
    for (const Rated& r : rated) {
        if (r.detail == &all.front() || !(r.ms < (1 - leastStep) * least)) continue;
        worth.push_back(*r.detail);
        least = r.ms;
    }
    return worth;
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
    if (options.close != nullptr) key << "; close chrome, bounces " << options.chromeBounces;
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

    std::vector<Trial> trials = trialsFor(options.antialiasing, mirrorsOf(options), options.close != nullptr,
                                          options.chromeBounces > 1);
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
    DetailBench bench(scene, prepared, renderer, reflecting, clips, options.mirrors, options.close,
                      options.chromeBounces);

    const Detail full = finestDetail(mirrorsOf(options));
    // Each knob where it shows: streets have little chrome that is near.
    const auto measureTrials = [&](DetailBench& by, double share, const auto& belongs) {
        std::vector<Detail> alone{full};
        for (const Trial& trial : trials)
            if (belongs(trial)) valueOf(alone.emplace_back(full), trial.knob) = trial.value;
        const std::vector<DetailBench::Measured> tried = by.measure(alone, goOn);
        if (tried.empty()) return -1.0;
        std::size_t next = 1;
        const Rung& finest = tried.front().rung;
        for (Trial& trial : trials) {
            if (!belongs(trial)) continue;
            const Rung& rung = tried[next++].rung;
            trial.savedMs = share * (finest.ms() - rung.ms());
            trial.lost = share * (rung.loss() - finest.loss());
        }
        return finest.ms();
    };
    const double finestMs =
        measureTrials(bench, 1, [](const Trial& t) { return measured(t) && !ofChrome(t.knob); });
    if (finestMs < 0) return calibration;
    interpolateSizes(trials);
    if (options.close != nullptr) {
        const Clip near = chromeClip(scene, *options.close, clips.front(), options.resolution);
        if (!near.empty()) {
            DetailBench nearby(scene, prepared, renderer, reflecting, {&near, 1}, options.mirrors,
                               options.close, options.chromeBounces);
            if (measureTrials(nearby, chromeShare, [](const Trial& t) { return ofChrome(t.knob); }) < 0)
                return calibration;
        }
    }
    std::vector<DetailBench::Measured> inOrder = bench.measure(
        worthMeasuring(orderOfGivingUp(full, trials, leastSaving * finestMs), trials, finestMs), goOn);
    if (inOrder.empty()) return calibration;
    // Chrome that is near is not in those clips: it has its share of the pixels.
    Detail without = full;
    for (const Trial& trial : trials)
        if (ofChrome(trial.knob)) valueOf(without, trial.knob) = trial.value;
    const double most = expectedOf(without, trials, ofChrome).savedMs;
    for (DetailBench::Measured& m : inOrder) {
        const Expected chrome = expectedOf(m.rung.detail, trials, ofChrome);
        const double scale = m.rung.detail.drawing.scale;
        m.rung.drawingMs += scale * scale * std::max(most - chrome.savedMs, 0.0);
        m.rung.pictureError += chrome.lost;
    }
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
