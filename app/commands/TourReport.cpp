#include "app/commands/TourReport.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "app/commands/Version.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"

namespace app {

TourReport::TourReport(const Options& options, std::string renderer)
    : options_(options), renderer_(std::move(renderer)) {}

void TourReport::add(const FrameStats& stats) {
    frameMs_.push_back(stats.frameMs);
    reflectionMs_.push_back(stats.reflectionMs);
    mapsUpdated_ += stats.reflections.rebuilt;
    const auto raise = [](std::uint64_t& most, std::size_t bytes) {
        most = std::max<std::uint64_t>(most, bytes);
    };
    raise(localMapBytes_, stats.reflections.localMapBytes);
    raise(referenceMapBytes_, stats.reflections.referenceMapBytes);
    raise(referenceMapGpuBytes_, stats.reflections.referenceMapGpuBytes);
    bytesPerTexel_ = std::max(bytesPerTexel_, stats.reflections.referenceBytesPerTexel);
}

void TourReport::finish(bool partial, std::ostream& out) const {
    const Timing frame = timingOf(frameMs_);
    const Timing reflection = timingOf(reflectionMs_);
    const double mapsPerFrame =
        frame.n == 0 ? 0 : static_cast<double>(mapsUpdated_) / static_cast<double>(frame.n);
    const auto row = [](const std::string& name, const Timing& t) {
        return std::vector<std::string>{name, fixed(t.min, 1), fixed(t.median, 1), fixed(t.max, 1)};
    };
    if (frame.n > 0)
        out << formatTable({{std::to_string(frame.n) + " frames, " + std::string(nameOf(options_.method)),
                             "min", "median", "max"},
                            row("frame, ms", frame),
                            row("reflections, ms", reflection)})
            << "maps rebuilt a frame: " << fixed(mapsPerFrame, 1) << "\n"
            << "local maps, GPU:      " << byteSize(static_cast<double>(localMapBytes_)) << "\n"
            << "reference maps:       " << byteSize(static_cast<double>(referenceMapBytes_)) << ", "
            << fixed(bytesPerTexel_, 2) << " bytes a texel for colour and distance; "
            << (referenceMapGpuBytes_ > 0
                    ? byteSize(static_cast<double>(referenceMapGpuBytes_)) + " on the GPU"
                    : "in main memory")
            << "\n";
    if (!options_.json) return;
    ResultFile results("tour", std::string(programVersion), renderer_);
    results.add({{"method", nameOf(options_.method)},
                 {"city", options_.city},
                 {"cars", options_.cars.front()},
                 {"width", options_.resolution.x},
                 {"height", options_.resolution.y},
                 {"frame_ms", toJson(frame)},
                 {"reflection_ms", toJson(reflection)},
                 {"maps_updated_per_frame", mapsPerFrame},
                 {"maps_on", referenceMapGpuBytes_ > 0 ? "gpu" : "cpu"},
                 {"texture_bytes", localMapBytes_ + referenceMapGpuBytes_},
                 {"reference_map_bytes", referenceMapBytes_},
                 {"reference_map_gpu_bytes", referenceMapGpuBytes_},
                 {"reference_map_bytes_per_texel", bytesPerTexel_}});
    results.write(*options_.json, partial);
}

}  // namespace app
