#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "app/raytrace/RayTracer.h"

namespace app {

/// Everything that a picture depends on in one number: city, frame, view, options. For the same light and
/// textures: sun map and texture filter are the caller's to keep.
std::uint64_t pictureKey(const city::CityModel& city, const FrameScene& frame, const View& view,
                         const TraceOptions& options);

/// A picture that takes long, rendered in bands of sixteen rows. Each is a file in `folder` as soon as it is
/// finished; a later call with the same key takes it from there and goes on with the rest: the result is the
/// same, bit for bit. A damaged file, or one of another key, is rendered anew. `carryOn` is asked before each
/// band with those that are finished and all there are; false ends the work, and nothing is returned.
/// Throws std::runtime_error when a band cannot be written.
std::optional<TracedPicture> renderInParts(const RayTracer& tracer, const View& view,
                                           const TraceOptions& options, const std::filesystem::path& folder,
                                           std::uint64_t key,
                                           const std::function<bool(int done, int total)>& carryOn);

}  // namespace app
