#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "app/commands/Benches.h"
#include "app/commands/Calibration.h"
#include "app/commands/CarsStage.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/Governor.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/Readback.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

constexpr std::uint32_t fewCars = 10, manyCars = 200;
constexpr double frameStep = 1.0 / 30;
/// Frames of a phase, and those at its beginning whose pictures are compared: the governor settles there.
constexpr std::uint32_t phaseFrames = 180, comparedFrames = 24;
/// Without --budget: this share of what the finest detail took when calibrated.
constexpr double defaultShare = 0.75;
constexpr double settledWithin = 0.1;
constexpr std::size_t settledWindow = 5;

struct Phase {
    std::uint32_t cars = 0, visible = 0;
    std::vector<double> frameMs, predictedMs;
    double position = 0, error = 0;
    std::string givenUp;
    std::vector<Image8> governed, fixedDetail;
    double largestJump = 0, largestOwn = 0, medianOwn = 0, largestRatio = 0;
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

/// Mean FLIP from each picture to the next.
std::vector<double> jumps(const std::vector<Image8>& images) {
    std::vector<double> found(images.empty() ? 0 : images.size() - 1);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        const glm::ivec2 size = images[i].size;
        const std::vector<glm::vec3> a = toFloat(images[i]), b = toFloat(images[i + 1]);
        found[i] = reflection::meanError(reflection::flip({size.x, size.y, b}, {size.x, size.y, a}));
    });
    return found;
}

/// The scene of the load step, drawn with a detail of its own each time.
class Play {
  public:
    Play(PreparedScene& stage, const Options& options)
        : stage_(stage),
          target_(options.resolution),
          set_(setCarsStage(stage.scene, stage.renderer, manyCars, options.seed, options.resolution)) {
        ReflectionSettings settings;
        settings.gpuMapBytes = options.gpuMapBytes();
        for (auto& engine : engines_)
            engine = std::make_unique<ReflectionEngine>(*stage.reflections.tracer, stage.reflections.maps,
                                                        stage.scene.models, settings);
    }

    bool possible() const { return set_.traffic.has_value(); }

    void next(Cast& cast) {
        for (double ahead = 0; ahead < frameStep; ahead += vehicles::TrafficOptions{}.step)
            set_.traffic->step();
        frame_ = assembleFrame(stage_.scene.city, *set_.traffic, stage_.scene.lighting, {set_.view});
        cast.select(frame_, set_.view, stage_.renderer);
    }
    /// `which` of two engines, as each keeps maps of its own.
    FrameCost draw(std::size_t which, const Detail& detail) {
        ReflectionEngine& engine = *engines_[which];
        ReflectionSettings settings = engine.settings();
        settings.detail = detail.reflection;
        engine.configure(settings);
        stage_.renderer.setDetail(detail.drawing);
        finishDrawing();
        const Stopwatch watch;
        stage_.renderer.prepare(frame_);
        const Stopwatch reflecting;
        const ReflectionPlan& plan =
            engine.update(frame_, seenIn(stage_.renderer, frame_.views), stage_.renderer);
        const double reflectionMs = reflecting.elapsed();
        stage_.renderer.drawView(set_.view, {engine.textures(), plan.slots}, target_.framebuffer());
        finishDrawing();
        return {watch.elapsed(), reflectionMs, plan.visible};
    }
    Image8 picture() const { return readPixels(target_.framebuffer(), target_.size()); }

  private:
    PreparedScene& stage_;
    OffscreenTarget target_;
    CarsStage set_;
    std::array<std::unique_ptr<ReflectionEngine>, 2> engines_;
    FrameScene frame_;
};

void comparePictures(Phase& phase) {
    const std::vector<double> governed = jumps(phase.governed), own = jumps(phase.fixedDetail);
    // From the first picture on the cars are there.
    for (std::size_t i = 0; i < governed.size(); ++i) {
        phase.largestJump = std::max(phase.largestJump, governed[i]);
        phase.largestOwn = std::max(phase.largestOwn, own[i]);
        phase.largestRatio = std::max(phase.largestRatio, governed[i] / std::max(own[i], 1e-6));
    }
    phase.medianOwn = own.empty() ? NAN : timingOf(own).median;
    phase.governed.clear();
    phase.fixedDetail.clear();
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
    const Calibration calibration =
        calibrate(stage.scene, stage.scene.lighting, stage.reflections, stage.renderer, settings);
    if (!calibration.complete || calibration.ladder.empty()) return reportBench(options, results, {});
    spdlog::info("the ladder{}:\n{}", calibration.fromCache ? ", from the cache" : "",
                 describe(calibration.ladder));
    const Detail finest = calibration.ladder.rungs().front().detail;
    const double budget =
        options.budgetMs > 0 ? options.budgetMs : defaultShare * calibration.ladder.rungs().front().ms();

    Play play(stage, options);
    if (!play.possible()) throw std::runtime_error("the city has no street to look down.");
    Governor governor(calibration.ladder, budget);
    std::vector<Phase> phases;
    Progress progress("frames", 3 * phaseFrames, options.quiet);
    for (const std::uint32_t cars : {fewCars, manyCars, fewCars}) {
        Phase& phase = phases.emplace_back();
        phase.cars = cars;
        Cast cast(cars);
        for (std::uint32_t frame = 0; frame < phaseFrames && !interrupted(); ++frame) {
            play.next(cast);
            phase.predictedMs.push_back(governor.predictedMs());
            const FrameCost cost = play.draw(0, governor.detail());
            phase.visible = static_cast<std::uint32_t>(cost.reflecting);
            if (frame < comparedFrames) {
                phase.governed.push_back(play.picture());
                play.draw(1, finest);
                phase.fixedDetail.push_back(play.picture());
            }
            governor.observe(cost);
            phase.frameMs.push_back(cost.frameMs);
            progress.advance();
        }
        phase.position = governor.position();
        phase.error = governor.predictedError();
        phase.givenUp = governor.givenUp();
        if (const auto news = governor.news()) spdlog::info("{} cars: {}", cars, *news);
        comparePictures(phase);
    }
    stage.renderer.setDetail({});

    std::vector<std::vector<std::string>> table{{"cars", "seen", "budget ms", "median", "95%", "within +25%",
                                                 "settled after s", "FLIP", "largest jump", "traffic's own",
                                                 "given up"}};
    for (const Phase& phase : phases) {
        if (phase.frameMs.empty()) continue;
        const double median = timingOf(phase.frameMs).median, high = quantile(phase.frameMs, 0.95);
        const auto within = std::count_if(phase.frameMs.begin(), phase.frameMs.end(),
                                          [&](double ms) { return ms <= 1.25 * budget; });
        const double share = static_cast<double>(within) / static_cast<double>(phase.frameMs.size());
        const double settled = settlingSeconds(phase.frameMs, budget);
        results.add({{"city", options.city},
                     {"cars", phase.cars},
                     {"visible", phase.visible},
                     {"width", options.resolution.x},
                     {"height", options.resolution.y},
                     {"budget_ms", budget},
                     {"frame_ms", toJson(timingOf(phase.frameMs))},
                     {"frame_ms_95", high},
                     {"within_125_percent", share},
                     {"settled_after_s", settled},
                     {"predicted_ms", timingOf(phase.predictedMs).median},
                     {"position", phase.position},
                     {"last_position", calibration.ladder.last()},
                     {"predicted_flip", phase.error},
                     {"largest_jump_flip", phase.largestJump},
                     {"own_jump_flip", phase.medianOwn},
                     {"largest_own_jump_flip", phase.largestOwn},
                     {"largest_jump_ratio", phase.largestRatio},
                     {"given_up", phase.givenUp}});
        table.push_back({std::to_string(phase.cars), std::to_string(phase.visible), fixed(budget, 1),
                         fixed(median, 1), fixed(high, 1), fixed(100 * share, 0) + "%", fixed(settled, 2),
                         fixed(phase.error, 4), fixed(phase.largestJump, 4), fixed(phase.medianOwn, 4),
                         phase.givenUp.empty() ? "nothing" : phase.givenUp});
    }
    return reportBench(options, results, table);
}

}  // namespace app
