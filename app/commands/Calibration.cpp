#include "app/commands/Calibration.h"

#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>
#include <iomanip>
#include <iterator>
#include <memory>
#include <sstream>
#include <thread>

#include "app/commands/MirrorMask.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/CameraRig.h"
#include "app/render/Readback.h"
#include "app/report/AsideFile.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

/// Changes when the measuring does.
constexpr int calibrationVersion = 3;
constexpr std::uint32_t calibrationCars = 60;
constexpr std::size_t framesBefore = 2, framesMeasured = 4;  // of a clip
constexpr double frameStep = 1.0 / 25;
/// Share of the finest frame that a step must save: less is noise.
constexpr double leastSaving = 0.005;

using Clip = std::vector<FrameScene>;

std::vector<Clip> recordClips(const Scene& scene, const Lighting& lighting,
                              const CalibrationOptions& options) {
    vehicles::Traffic traffic = startTraffic(scene, options.seed, calibrationCars);
    CameraRig camera(scene.city.tour, scene.city.bounds);
    std::vector<Clip> clips;
    for (const CameraMode mode : {CameraMode::follow, CameraMode::tour}) {
        camera.setMode(mode, traffic.poses());
        Clip& clip = clips.emplace_back();
        for (std::size_t i = 0; i < framesBefore + framesMeasured; ++i) {
            const double until = traffic.time() + frameStep;
            while (traffic.size() > 0 && traffic.time() < until) traffic.step();
            camera.update(frameStep, traffic.poses(), {});
            clip.push_back(assembleFrame(
                scene.city, traffic, lighting,
                {lookAt(camera.pose().eye, camera.pose().target, glm::radians(60.0), options.resolution)}));
        }
    }
    return clips;
}

struct Candidate {
    Detail detail;
    std::unique_ptr<ReflectionEngine> engine;
    std::vector<double> drawing, reflecting;  ///< of one clip, milliseconds
    std::vector<Image8> images;               ///< of the last frame of each clip
    Rung rung;
};

/// Whatever else runs makes frames slower, never faster: of like frames the fastest tells most. Those of
/// reflections differ, as maps are built in turns; there the middle one does.
double fastest(const std::vector<double>& values) {
    return values.empty() ? 0 : timingOf(values).min;
}
double middle(const std::vector<double>& values) {
    return values.empty() ? 0 : timingOf(values).median;
}

/// Draws details over the clips and compares them with re-rendering.
class Bench {
  public:
    Bench(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
          const CalibrationOptions& options, std::span<const Clip> clips)
        : scene_(scene),
          prepared_(prepared),
          renderer_(renderer),
          options_(options),
          clips_(clips),
          target_(options.resolution) {
        ReflectionSettings settings;
        settings.method = ReflectionMethod::rerender;
        ReflectionEngine rerender(*prepared.tracer, prepared.maps, scene.models, settings);
        MirrorMask mirrors;
        for (const Clip& clip : clips) {
            draw(clip.back(), rerender, {});
            truths_.push_back(toFloat(readPixels(target_.framebuffer(), target_.size())));
            masks_.push_back(mirrors.of(renderer, clip.back(), target_));
            mirrors_.push_back(partOf(masks_.back()));
        }
    }

    /// False: ended early.
    bool measure(std::vector<Candidate>& candidates, const std::function<bool()>& goOn) {
        for (Candidate& candidate : candidates) {
            ReflectionSettings settings;
            settings.detail = candidate.detail.reflection;
            settings.mapsOn = options_.mapsOn;
            // They all hold maps at once.
            settings.gpuMapBytes = std::max(options_.gpuMapBytes / candidates.size(), std::size_t{64} << 20);
            candidate.engine = std::make_unique<ReflectionEngine>(*prepared_.tracer, prepared_.maps,
                                                                  scene_.models, settings);
        }
        for (const Clip& clip : clips_) {
            for (Candidate& candidate : candidates) {
                candidate.drawing.clear();
                candidate.reflecting.clear();
            }
            for (std::size_t frame = 0; frame < clip.size(); ++frame) {
                for (std::size_t k = 0; k < candidates.size(); ++k) {
                    // Forwards and backwards: a clock that goes down must not always meet the same ones.
                    Candidate& candidate = candidates[frame % 2 == 0 ? k : candidates.size() - 1 - k];
                    const auto [drawing, reflecting] =
                        draw(clip[frame], *candidate.engine, candidate.detail.drawing);
                    if (frame >= framesBefore) {
                        candidate.drawing.push_back(drawing);
                        candidate.reflecting.push_back(reflecting);
                    }
                    if (frame + 1 == clip.size())
                        candidate.images.push_back(readPixels(target_.framebuffer(), target_.size()));
                }
                if (!goOn()) return false;
            }
            const double share = 1.0 / static_cast<double>(clips_.size());
            for (Candidate& candidate : candidates) {
                candidate.rung.drawingMs += share * fastest(candidate.drawing);
                candidate.rung.reflectionMs += share * middle(candidate.reflecting);
            }
        }
        for (Candidate& candidate : candidates) candidate.engine.reset();
        renderer_.setDetail({});
        tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t k) { compare(candidates[k]); });
        return goOn();
    }

  private:
    /// Milliseconds of drawing and of reflecting.
    std::pair<double, double> draw(const FrameScene& frame, ReflectionEngine& engine,
                                   const DrawingDetail& detail) {
        renderer_.setDetail(detail);
        finishDrawing();
        const Stopwatch watch;
        renderer_.prepare(frame);
        const View& view = frame.views.front();
        const Stopwatch reflecting;
        std::vector<SeenVehicle> seen;
        for (const auto& v : renderer_.visibleVehicles(view)) seen.push_back({v.index, v.diameterPixels});
        const ReflectionPlan& plan = engine.update(frame, seen, renderer_);
        const double reflectionMs = reflecting.elapsed();
        renderer_.drawView(view, {engine.textures(), plan.slots}, target_.framebuffer());
        finishDrawing();
        return {watch.elapsed() - reflectionMs, reflectionMs};
    }

    void compare(Candidate& candidate) const {
        double errors[2] = {0, 0};  // beside the mirrors, and on them
        std::size_t clips[2] = {0, 0};
        // Drawn in full, the picture differs on mirrors alone.
        const bool full = candidate.detail.drawing == DrawingDetail{};
        for (std::size_t clip = 0; clip < truths_.size(); ++clip) {
            const Part part = full ? mirrors_[clip] : Part{{0, 0}, options_.resolution};
            if (part.size.x <= 0) continue;
            const std::vector<glm::vec3> test = cut(toFloat(candidate.images[clip]), part),
                                         truth = cut(truths_[clip], part);
            const std::vector<float> flip =
                reflection::flip({part.size.x, part.size.y, test}, {part.size.x, part.size.y, truth});
            std::vector<unsigned char> mask = cut(masks_[clip], part);
            for (const int mirrors : {1, 0}) {
                if (full && mirrors == 0) break;
                const double error = reflection::meanError(flip, mask);
                // Without a mirror in sight there is nothing to be wrong about.
                if (std::isfinite(error)) {
                    errors[mirrors] += error;
                    ++clips[mirrors];
                }
                for (unsigned char& inside : mask) inside = inside == 0;
            }
        }
        candidate.images.clear();
        candidate.rung.detail = candidate.detail;
        candidate.rung.error = clips[1] == 0 ? 0 : errors[1] / static_cast<double>(clips[1]);
        candidate.rung.pictureError = clips[0] == 0 ? 0 : errors[0] / static_cast<double>(clips[0]);
    }

    /// A rectangle of a picture.
    struct Part {
        glm::ivec2 corner{0}, size{0};
    };

    template <typename T>
    std::vector<T> cut(const std::vector<T>& picture, const Part& part) const {
        std::vector<T> pixels;
        pixels.reserve(static_cast<std::size_t>(part.size.x) * static_cast<std::size_t>(part.size.y));
        for (int y = 0; y < part.size.y; ++y) {
            const auto row = picture.begin() +
                             static_cast<std::ptrdiff_t>(part.corner.y + y) * options_.resolution.x +
                             part.corner.x;
            pixels.insert(pixels.end(), row, row + part.size.x);
        }
        return pixels;
    }

    /// What holds all mirrors, and as much around them as FLIP's filters reach.
    Part partOf(const std::vector<unsigned char>& mask) const {
        constexpr int reach = 24;
        const glm::ivec2 size = options_.resolution;
        glm::ivec2 low = size, high(-1);
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                if (mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                         static_cast<std::size_t>(x)] != 0) {
                    low = glm::min(low, glm::ivec2(x, y));
                    high = glm::max(high, glm::ivec2(x, y));
                }
        if (high.x < 0) return {};
        low = glm::max(low - reach, glm::ivec2(0));
        high = glm::min(high + reach, size - 1);
        return {low, high - low + 1};
    }

    const Scene& scene_;
    const PreparedReflections& prepared_;
    SceneRenderer& renderer_;
    const CalibrationOptions& options_;
    std::span<const Clip> clips_;
    OffscreenTarget target_;
    std::vector<std::vector<glm::vec3>> truths_;
    std::vector<std::vector<unsigned char>> masks_;
    std::vector<Part> mirrors_;
};

Detail finestDetail() {
    return {detailOf(Quality::high), {}};
}

/// Each knob turned down alone, fine to coarse.
std::vector<Trial> trialsFor(Antialiasing antialiasing) {
    std::vector<Trial> trials;
    const auto add = [&](Knob knob, std::initializer_list<double> values) {
        for (const double value : values) trials.push_back({knob, value, 0, 0});
    };
    add(Knob::texelBudget, {160e3, 80e3, 30e3, 10e3});
    add(Knob::texelsPerPixel, {0.5, 0.25});
    add(Knob::errorThreshold, {0.5, 1, 2});
    add(Knob::candidates, {3, 2});
    add(Knob::lookups, {4, 2});
    add(Knob::scale, {0.85, 0.7, 0.5, 0.35});
    if (antialiasing == Antialiasing::fxaa) add(Knob::antialiasing, {0.5, 0});
    add(Knob::vehicleTolerance, {5, 10});
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
                         {"picture_flip", rung.pictureError}});
    }
    return nlohmann::ordered_json{{"key", key}, {"rungs", rungs}}.dump(2) + "\n";
}

std::optional<DetailLadder> ladderFromText(const std::string& text, const std::string& key) {
    const nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
    try {
        if (document.at("key") != key) return std::nullopt;
        std::vector<Rung> rungs;
        for (const nlohmann::json& from : document.at("rungs")) {
            Rung& rung = rungs.emplace_back();
            for (std::size_t k = 0; k < knobNames.size(); ++k) {
                const double value = from.at("detail").at(std::string(knobNames[k])).get<double>();
                if (!std::isfinite(value) || value < 0) return std::nullopt;
                valueOf(rung.detail, static_cast<Knob>(k)) = value;
            }
            rung.drawingMs = from.at("drawing_ms").get<double>();
            rung.reflectionMs = from.at("reflection_ms").get<double>();
            rung.error = from.at("mean_flip").get<double>();
            rung.pictureError = from.at("picture_flip").get<double>();
        }
        DetailLadder ladder(rungs);
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

    std::vector<Trial> trials = trialsFor(options.antialiasing);
    const std::vector<Clip> clips = recordClips(scene, lighting, options);
    // The rungs are about as many as the trials, not known before.
    const std::size_t steps = 2 * (clips.size() * clips.front().size() + 1);
    Progress progress("calibration", steps, options.quiet);
    std::size_t done = 0;
    const auto goOn = [&] {
        progress.advance();
        return !interrupted() && (!options.carryOn || options.carryOn(++done, steps));
    };
    calibration.complete = false;
    Bench bench(scene, prepared, renderer, options, clips);

    std::vector<Candidate> alone(1 + trials.size());
    alone[0].detail = finestDetail();
    for (std::size_t i = 0; i < trials.size(); ++i) {
        alone[i + 1].detail = finestDetail();
        valueOf(alone[i + 1].detail, trials[i].knob) = trials[i].value;
    }
    if (!bench.measure(alone, goOn)) return calibration;
    const Rung finest = alone[0].rung;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        trials[i].savedMs = finest.ms() - alone[i + 1].rung.ms();
        trials[i].lost = alone[i + 1].rung.loss() - finest.loss();
    }

    std::vector<Candidate> rungs;
    for (const Detail& detail : orderOfGivingUp(finestDetail(), trials, leastSaving * finest.ms()))
        rungs.emplace_back().detail = detail;
    if (!bench.measure(rungs, goOn)) return calibration;
    std::vector<Rung> measured;
    for (const Candidate& candidate : rungs) measured.push_back(candidate.rung);
    calibration.ladder = DetailLadder(std::move(measured));
    calibration.complete = true;
    if (options.useCache) try {
            writeTextFile(calibration.file, ladderToText(calibration.ladder, key));
        } catch (const std::runtime_error& error) {
            spdlog::warn("{} The calibration holds for this run alone.", error.what());
            calibration.file.clear();
        }
    return calibration;
}

std::string describe(const DetailLadder& ladder) {
    std::vector<std::vector<std::string>> table{
        {"given up, one after the other", "frame ms", "reflections", "FLIP on mirrors", "beside them"}};
    Detail before = ladder.empty() ? Detail{} : ladder.rungs().front().detail;
    for (const Rung& rung : ladder.rungs()) {
        std::string step = givenUp(before, rung.detail);
        table.push_back({step.empty() ? "nothing" : step, fixed(rung.ms(), 1), fixed(rung.reflectionMs, 2),
                         fixed(rung.error, 4), fixed(rung.pictureError, 4)});
        before = rung.detail;
    }
    return formatTable(table);
}

}  // namespace app
