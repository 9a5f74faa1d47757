#include "app/commands/TourReport.h"

#include <algorithm>
#include <numeric>
#include <ostream>
#include <type_traits>
#include <utility>

#include "app/commands/Version.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

namespace {

std::string methodOf(const DriveSettings& settings) {
    const std::string method(nameOf(settings.method));
    return settings.method == ReflectionMethod::mem && settings.mem == MemVariant::paper ? method + " paper"
                                                                                         : method;
}

/// Index of the median.
std::size_t middleOf(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end(),
                     [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    return *middle;
}

double shareWithin(const std::vector<double>& values, double most) {
    const auto within = std::count_if(values.begin(), values.end(), [&](double v) { return v <= most; });
    return static_cast<double>(within) / static_cast<double>(values.size());
}

}  // namespace

TourReport::TourReport(const Options& options, std::string renderer)
    : options_(options), renderer_(std::move(renderer)) {}

void TourReport::add(const FrameStats& stats, const DriveSettings& settings, glm::ivec2 size) {
    auto stretch = std::find_if(stretches_.begin(), stretches_.end(), [&](const Stretch& known) {
        return known.settings == settings && known.size == size;
    });
    if (stretch == stretches_.end()) {
        stretch = stretches_.emplace(stretches_.end());
        stretch->settings = settings;
        stretch->size = size;
    }
    stretch->frameMs.push_back(stats.frameMs);
    stretch->reflectionMs.push_back(stats.reflectionMs);
    stretch->mapsUpdated += stats.reflections.rebuilt;
    const auto raise = [](auto& most, auto value) {
        most = std::max<std::remove_reference_t<decltype(most)>>(most, value);
    };
    const ChromeCounts& chrome = stats.drawn.chrome;
    stretch->chromeJobs += chrome.jobs;
    stretch->chromeMeshes += chrome.meshes;
    stretch->chromeSearched += chrome.searched;
    stretch->chromeDrawn += chrome.drawn;
    stretch->bounces.add(chrome.bounces);
    stretch->bounceMs.push_back(chrome.bounces.milliseconds);
    stretch->chromeMs.push_back(chrome.milliseconds);
    raise(stretch->chromeReflectorBytes, stats.chromeBytes);
    raise(stretch->chromeTextureBytes, stats.drawn.chromeTextureBytes);
    raise(stretch->localMapBytes, stats.reflections.localMapBytes);
    raise(stretch->referenceMapBytes, stats.reflections.referenceMapBytes);
    raise(stretch->referenceMapGpuBytes, stats.reflections.referenceMapGpuBytes);
    if (stats.governed.active) {
        stretch->positions.push_back(stats.governed.position);
        stretch->predictedMs.push_back(stats.governed.predictedMs);
        stretch->errors.push_back(stats.governed.error);
        stretch->givenUp.push_back(stats.governed.givenUp);
        stretch->last = stats.governed.last;
    }
    raise(stretch->bytesPerTexel, stats.reflections.referenceBytesPerTexel);
    ++frames_;
}

void TourReport::finish(bool partial, std::ostream& out) const {
    ResultFile results("tour", std::string(programVersion), renderer_);
    std::vector<std::vector<std::string>> table{{"method, quality, cars, size, hour", "frames", "ms: min",
                                                 "median", "max", "reflections", "maps a frame", "local maps",
                                                 "chrome jobs", "searches", "their ms"}};
    std::string governed, bounced;
    const Stretch* most = nullptr;  // memory
    for (const Stretch& stretch : stretches_) {
        const DriveSettings& settings = stretch.settings;
        const Timing frame = timingOf(stretch.frameMs);
        const Timing reflection = timingOf(stretch.reflectionMs);
        const double mapsPerFrame =
            static_cast<double>(stretch.mapsUpdated) / static_cast<double>(stretch.frameMs.size());
        table.push_back({methodOf(settings) + ", " + std::string(nameOf(settings.quality)) + ", " +
                             std::to_string(settings.cars) + ", " + std::to_string(stretch.size.x) + "x" +
                             std::to_string(stretch.size.y) + ", " + fixed(settings.hour, 1),
                         std::to_string(frame.n), fixed(frame.min, 1), fixed(frame.median, 1),
                         fixed(frame.max, 1), fixed(reflection.median, 1), fixed(mapsPerFrame, 1),
                         byteSize(static_cast<double>(stretch.localMapBytes)),
                         fixed(static_cast<double>(stretch.chromeJobs) / static_cast<double>(frame.n), 2),
                         fixed(static_cast<double>(stretch.chromeSearched) / static_cast<double>(frame.n), 0),
                         fixed(timingOf(stretch.chromeMs).median, 1)});
        nlohmann::ordered_json row{{"method", methodOf(settings)},
                                   {"quality", nameOf(settings.quality)},
                                   {"city", options_.city},
                                   {"cars", settings.cars},
                                   {"width", stretch.size.x},
                                   {"height", stretch.size.y},
                                   {"hour", settings.hour},
                                   {"exposure", settings.adapt ? "auto" : "hour"},
                                   {"frame_ms", toJson(frame)},
                                   {"reflection_ms", toJson(reflection)},
                                   {"maps_updated_per_frame", mapsPerFrame},
                                   {"maps_on", stretch.referenceMapGpuBytes > 0 ? "gpu" : "cpu"},
                                   {"texture_bytes", stretch.localMapBytes + stretch.referenceMapGpuBytes},
                                   {"reference_map_bytes", stretch.referenceMapBytes},
                                   {"reference_map_gpu_bytes", stretch.referenceMapGpuBytes},
                                   {"reference_map_bytes_per_texel", stretch.bytesPerTexel}};
        const auto perFrame = [&](std::uint64_t n) {
            return static_cast<double>(n) / static_cast<double>(stretch.frameMs.size());
        };
        row["chrome_jobs_per_frame"] = perFrame(stretch.chromeJobs);
        row["chrome_jobs_drawn_per_frame"] = perFrame(stretch.chromeDrawn);
        if (settings.chromeBounces > 1) {
            const ChromeBounceCounts& b = stretch.bounces;
            row["chrome_bounces"] = {{"bounces", settings.chromeBounces},
                                     {"parts_per_frame", perFrame(b.parts)},
                                     {"pictures_per_frame", perFrame(b.pictures)},
                                     {"drawn_per_frame", perFrame(b.drawn)},
                                     {"fading_per_frame", perFrame(b.fading)},
                                     {"too_small_per_frame", perFrame(b.tooSmall)},
                                     {"unseen_per_frame", perFrame(b.unseen)},
                                     {"too_bent_per_frame", perFrame(b.tooBent)},
                                     {"too_near_per_frame", perFrame(b.tooNear)},
                                     {"over_cap_per_frame", perFrame(b.overCap)},
                                     {"making_per_frame", perFrame(b.making)},
                                     {"texels_per_frame", perFrame(b.texels)},
                                     {"ms", toJson(timingOf(stretch.bounceMs))}};
            bounced += "chrome seen in chrome: " + fixed(perFrame(b.parts), 1) + " parts a frame, " +
                       fixed(perFrame(b.pictures), 1) + " in pictures (" + fixed(perFrame(b.drawn), 1) +
                       " drawn anew, " + fixed(perFrame(b.pictures - std::min(b.drawn, b.pictures)), 1) +
                       " kept); without: " + fixed(perFrame(b.tooSmall), 1) + " too small, " +
                       fixed(perFrame(b.unseen), 1) + " not seen, " +
                       fixed(perFrame(b.tooBent + b.tooNear), 1) + " too bent or too near, " +
                       fixed(perFrame(b.overCap), 1) + " for want of room, " + fixed(perFrame(b.making), 1) +
                       " being made; " + fixed(timingOf(stretch.bounceMs).median, 1) + " ms\n";
        }
        row["chrome_reflector_bytes"] = stretch.chromeReflectorBytes;
        row["chrome_meshes_per_frame"] = perFrame(stretch.chromeMeshes);
        row["chrome_searched_per_frame"] = perFrame(stretch.chromeSearched);
        row["chrome_ms"] = toJson(timingOf(stretch.chromeMs));
        row["chrome_texture_bytes"] = stretch.chromeTextureBytes;
        if (!stretch.positions.empty()) {
            const std::size_t middle = middleOf(stretch.positions);
            const double within = shareWithin(stretch.frameMs, 1.25 * settings.budgetMs);
            row["governor"] = {{"budget_ms", settings.budgetMs},
                               {"error_asked", settings.error},
                               {"fixed_quality", settings.fixedQuality},
                               {"position", stretch.positions[middle]},
                               {"last_position", stretch.last},
                               {"predicted_ms", timingOf(stretch.predictedMs).median},
                               {"predicted_flip", stretch.errors[middle]},
                               {"given_up", stretch.givenUp[middle]}};
            governed += (settings.budgetMs > 0 ? "budget of " + fixed(settings.budgetMs, 1) + " ms: "
                                               : "error of " + fixed(settings.error, 4) + ": ") +
                        "median frame " + fixed(frame.median, 1) + " ms, predicted " +
                        fixed(timingOf(stretch.predictedMs).median, 1) + " ms, FLIP " +
                        fixed(stretch.errors[middle], 4) + " on mirrors (calibrated)";
            if (settings.budgetMs > 0) {
                row["governor"]["within_125_percent"] = within;
                governed += ", " + fixed(100 * within, 0) + "% of frames within +25%";
            }
            governed += "; given up in the middle of it: " +
                        (stretch.givenUp[middle].empty() ? "nothing" : stretch.givenUp[middle]) + "\n";
        }
        results.add(std::move(row));
        if (most == nullptr || stretch.referenceMapBytes >= most->referenceMapBytes) most = &stretch;
    }
    if (!stretches_.empty()) out << formatTable(table) << bounced << governed;
    if (most != nullptr && most->referenceMapBytes > 0)
        out << "reference maps: " << byteSize(static_cast<double>(most->referenceMapBytes)) << ", "
            << fixed(most->bytesPerTexel, 2) << " bytes a texel for colour and distance; "
            << (most->referenceMapGpuBytes > 0
                    ? byteSize(static_cast<double>(most->referenceMapGpuBytes)) + " on the GPU"
                    : "in main memory")
            << "\n";
    if (options_.json) results.write(*options_.json, partial);
}

}  // namespace app
