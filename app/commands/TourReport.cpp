#include "app/commands/TourReport.h"

#include <algorithm>
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
    raise(stretch->localMapBytes, stats.reflections.localMapBytes);
    raise(stretch->referenceMapBytes, stats.reflections.referenceMapBytes);
    raise(stretch->referenceMapGpuBytes, stats.reflections.referenceMapGpuBytes);
    raise(stretch->bytesPerTexel, stats.reflections.referenceBytesPerTexel);
    ++frames_;
}

void TourReport::finish(bool partial, std::ostream& out) const {
    ResultFile results("tour", std::string(programVersion), renderer_);
    std::vector<std::vector<std::string>> table{{"method, quality, cars, size, hour", "frames", "ms: min",
                                                 "median", "max", "reflections", "maps a frame",
                                                 "local maps"}};
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
                         byteSize(static_cast<double>(stretch.localMapBytes))});
        results.add({{"method", methodOf(settings)},
                     {"quality", nameOf(settings.quality)},
                     {"city", options_.city},
                     {"cars", settings.cars},
                     {"width", stretch.size.x},
                     {"height", stretch.size.y},
                     {"hour", settings.hour},
                     {"frame_ms", toJson(frame)},
                     {"reflection_ms", toJson(reflection)},
                     {"maps_updated_per_frame", mapsPerFrame},
                     {"maps_on", stretch.referenceMapGpuBytes > 0 ? "gpu" : "cpu"},
                     {"texture_bytes", stretch.localMapBytes + stretch.referenceMapGpuBytes},
                     {"reference_map_bytes", stretch.referenceMapBytes},
                     {"reference_map_gpu_bytes", stretch.referenceMapGpuBytes},
                     {"reference_map_bytes_per_texel", stretch.bytesPerTexel}});
        if (most == nullptr || stretch.referenceMapBytes >= most->referenceMapBytes) most = &stretch;
    }
    if (!stretches_.empty()) out << formatTable(table);
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
