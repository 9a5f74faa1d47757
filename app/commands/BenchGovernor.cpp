#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "app/commands/Benches.h"
#include "app/commands/Calibration.h"
#include "app/commands/GovernorPlay.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

namespace {

constexpr std::uint32_t fewCars = 10, manyCars = 200;
constexpr std::uint32_t phaseFrames = 180;
/// Without --budget: this share of what the finest detail took when calibrated.
constexpr double defaultShare = 0.75;
constexpr double settledWithin = 0.1;
constexpr std::size_t settledWindow = 5;

/// Frames of one play.
struct Frames {
    std::vector<double> frameMs, reflectionMs, predictedMs, position, texels;
    std::vector<Image8> pictures;
    std::vector<double> jumps;  ///< to each picture from the one before; the first from the last phase's
};

struct Phase {
    std::uint32_t cars = 0, visible = 0;
    double position = 0, error = 0, chromeJobs = 0;
    std::string givenUp;
    Frames governed, finest, settled;
};

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return NAN;
    std::sort(values.begin(), values.end());
    const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::clamp<std::size_t>(at, 1, values.size()) - 1];
}

/// Seconds of frames until the median of the last few is within 10% of the budget and stays there for as many
/// again; not a number if it never does.
double settlingSeconds(const std::vector<double>& frameMs, double budget) {
    double seconds = 0;
    std::size_t good = 0;
    for (std::size_t i = 0; i < frameMs.size(); ++i) {
        seconds += frameMs[i] / 1000;
        if (i + 1 < settledWindow) continue;
        const std::vector<double> last(frameMs.begin() + static_cast<std::ptrdiff_t>(i + 1 - settledWindow),
                                       frameMs.begin() + static_cast<std::ptrdiff_t>(i + 1));
        const bool inside = std::abs(timingOf(last).median - budget) <= settledWithin * budget;
        good = inside ? good + 1 : 0;
        if (good == settledWindow) {
            for (std::size_t k = 0; k < settledWindow; ++k) seconds -= frameMs[i - k] / 1000;
            return seconds;
        }
    }
    return NAN;
}

double shareWithin(const std::vector<double>& frameMs, double most) {
    if (frameMs.empty()) return NAN;
    const auto within = std::count_if(frameMs.begin(), frameMs.end(), [&](double ms) { return ms <= most; });
    return static_cast<double>(within) / static_cast<double>(frameMs.size());
}

double median(const std::vector<double>& values) {
    return values.empty() ? NAN : timingOf(values).median;
}
double largest(const std::vector<double>& values) {
    return values.empty() ? NAN : *std::max_element(values.begin(), values.end());
}

/// The pictures' jumps, of which `last`, that of the phase before, is the first; they are let go but for the
/// last one.
void comparePictures(Frames& frames, std::optional<Image8>& last) {
    if (frames.pictures.empty()) return;
    if (last) frames.pictures.insert(frames.pictures.begin(), std::move(*last));
    frames.jumps = jumps(frames.pictures);
    last = std::move(frames.pictures.back());
    frames.pictures = {};
}

/// Largest jump over what the traffic makes by itself there: in that frame, or in the middle one where that
/// is more, since its own jumps need not fall on the same frames.
double largestRatio(const Phase& phase) {
    const double usual = median(phase.finest.jumps);
    double worst = 0;
    for (std::size_t i = 0; i < std::min(phase.governed.jumps.size(), phase.finest.jumps.size()); ++i)
        worst = std::max(worst, phase.governed.jumps[i] / std::max({phase.finest.jumps[i], usual, 1e-6}));
    return worst;
}

}  // namespace

int benchGovernor(const Options& options) {
    PreparedScene stage(options);
    ResultFile results("governor", std::string(programVersion), stage.context.renderer());
    if (!stage.reflections.complete) return reportBench(options, results, {});
    CalibrationOptions settings;
    settings.resolution = options.resolution;
    settings.seed = options.seed;
    settings.gpuMapBytes = options.gpuMapBytes();
    settings.renderer = stage.context.renderer();
    settings.quiet = options.quiet;
    CityMirrors mirrors = cityMirrors(stage.scene, options);
    settings.mirrors = &mirrors;
    if (mirrors.any()) stage.renderer.setGlass(stage.scene.glass.fronts);
    // Close chrome as the program has it.
    std::unique_ptr<CloseScene> close;
    if (options.chrome) {
        close = std::make_unique<CloseScene>(stage.scene.city, stage.scene.models);
        close->parts.keepIn(cacheFolder() / "chrome",
                            [](const std::string& text) { spdlog::warn("{}", text); });
        stage.renderer.setCloseScene(close.get());
        settings.close = close.get();
        settings.chromeBounces = options.chromeBounces;
    }
    ChromeDrawing chromeDrawing;
    chromeDrawing.share = options.chromeShare;
    chromeDrawing.bounces = options.chromeBounces;
    const Stopwatch calibrating;
    const Calibration calibration =
        calibrate(stage.scene, stage.scene.lighting, stage.reflections, stage.renderer, settings);
    if (!calibration.complete || calibration.ladder.empty()) return reportBench(options, results, {});
    spdlog::info("the ladder{}, {:.1f} s, scatter {:.3f}, a vehicle {:.4f} ms:\n{}",
                 calibration.fromCache ? ", from the cache" : "", calibrating.elapsed() / 1000,
                 calibration.scatter, calibration.ladder.vehicles().ms, describe(calibration.ladder));
    const Detail finest = calibration.ladder.rungs().front().detail;
    const double budget =
        options.budgetMs > 0 ? options.budgetMs : defaultShare * calibration.ladder.rungs().front().ms();

    // The governed play, and beside it, for what traffic and machine do by themselves, the same frames with
    // the finest detail and with that which the governor settles at.
    SceneRenderer controlRenderer(stage.scene.city, stage.scene.models, RenderOptions{});
    ReflectionSettings reflecting;
    reflecting.gpuMapBytes = options.gpuMapBytes();
    const auto makePlay = [&](SceneRenderer& renderer) {
        return std::make_unique<GovernorPlay>(stage.scene, stage.reflections, renderer, manyCars,
                                              options.seed, options.resolution, reflecting, mirrors,
                                              close.get(), chromeDrawing);
    };
    const auto governed = makePlay(stage.renderer), unchanged = makePlay(controlRenderer),
               settled = makePlay(controlRenderer);
    if (!governed->possible()) throw std::runtime_error("the city has no street to look down.");
    Governor governor(calibration.ladder, budget);
    stage.renderer.prepareForChanges(options.resolution);
    std::vector<Phase> phases;
    std::optional<Image8> lastGoverned, lastFinest;
    Progress progress("frames", 9 * phaseFrames, options.quiet);
    const auto play = [&](GovernorPlay& what, std::uint32_t cars, Frames& frames, bool pictures,
                          const auto& draw) {
        Cast cast(cars);
        for (std::uint32_t frame = 0; frame < phaseFrames && !interrupted(); ++frame) {
            what.next(cast);
            const FrameCost cost = draw(what);
            if (pictures) frames.pictures.push_back(what.picture());
            frames.frameMs.push_back(cost.frameMs);
            frames.reflectionMs.push_back(cost.reflectionMs);
            frames.texels.push_back(static_cast<double>(what.counters().texels));
            progress.advance();
        }
    };
    for (const std::uint32_t cars : {fewCars, manyCars, fewCars}) {
        Phase& phase = phases.emplace_back();
        phase.cars = cars;
        const std::uint64_t jobsBefore = governed->chromeJobs();
        play(*governed, cars, phase.governed, true, [&](GovernorPlay& what) {
            const FrameCost cost = what.draw(governor);
            phase.visible = static_cast<std::uint32_t>(cost.reflecting);
            phase.governed.predictedMs.push_back(governor.predictedMs());
            phase.governed.position.push_back(governor.position());
            return cost;
        });
        phase.chromeJobs = static_cast<double>(governed->chromeJobs() - jobsBefore) / phaseFrames;
        phase.position = governor.position();
        phase.error = governor.predictedError();
        phase.givenUp = governor.givenUp();
        if (const auto news = governor.news()) spdlog::info("{} cars: {}", cars, *news);
        comparePictures(phase.governed, lastGoverned);
        const Detail detail = governor.detail();
        play(*settled, cars, phase.settled, false, [&](GovernorPlay& what) { return what.draw(detail); });
        play(*unchanged, cars, phase.finest, true, [&](GovernorPlay& what) { return what.draw(finest); });
        comparePictures(phase.finest, lastFinest);
    }

    std::vector<std::vector<std::string>> table{{"cars", "seen", "budget ms", "median", "95%", "within +25%",
                                                 "unchanged detail", "settled after s", "FLIP",
                                                 "largest jump", "traffic's own", "ratio", "given up"}};
    for (const Phase& phase : phases) {
        const std::vector<double>& frameMs = phase.governed.frameMs;
        if (frameMs.empty()) continue;
        const double share = shareWithin(frameMs, 1.25 * budget),
                     settledAfter = settlingSeconds(frameMs, budget);
        // What the machine does to frames whose detail never changes.
        const double unchangedShare =
            shareWithin(phase.settled.frameMs, 1.25 * median(phase.settled.frameMs));
        const double jump = largest(phase.governed.jumps), own = median(phase.finest.jumps),
                     ratio = largestRatio(phase);
        results.add({{"city", options.city},
                     {"cars", phase.cars},
                     {"visible", phase.visible},
                     {"width", options.resolution.x},
                     {"height", options.resolution.y},
                     {"windows", mirrors.any()},
                     {"chrome_jobs", phase.chromeJobs},
                     {"budget_ms", budget},
                     {"frame_ms", toJson(timingOf(frameMs))},
                     {"frame_ms_95", quantile(frameMs, 0.95)},
                     {"within_125_percent", share},
                     {"unchanged_frame_ms", toJson(timingOf(phase.settled.frameMs))},
                     {"unchanged_within_125_percent_of_its_median", unchangedShare},
                     {"settled_after_s", settledAfter},
                     {"predicted_ms", median(phase.governed.predictedMs)},
                     {"position", phase.position},
                     {"last_position", calibration.ladder.last()},
                     {"predicted_flip", phase.error},
                     {"largest_jump_flip", jump},
                     {"own_jump_flip", own},
                     {"largest_own_jump_flip", largest(phase.finest.jumps)},
                     {"largest_jump_ratio", ratio},
                     {"given_up", phase.givenUp},
                     {"frames",
                      {{"ms", frameMs},
                       {"reflection_ms", phase.governed.reflectionMs},
                       {"texels", phase.governed.texels},
                       {"position", phase.governed.position},
                       {"jump_flip", phase.governed.jumps},
                       {"own_jump_flip", phase.finest.jumps},
                       {"unchanged_ms", phase.settled.frameMs}}}});
        table.push_back({std::to_string(phase.cars), std::to_string(phase.visible), fixed(budget, 1),
                         fixed(median(frameMs), 1), fixed(quantile(frameMs, 0.95), 1),
                         fixed(100 * share, 1) + "%", fixed(100 * unchangedShare, 1) + "%",
                         fixed(settledAfter, 2), fixed(phase.error, 4), fixed(jump, 4), fixed(own, 4),
                         fixed(ratio, 2), phase.givenUp.empty() ? "nothing" : phase.givenUp});
    }
    return reportBench(options, results, table);
}

}  // namespace app
