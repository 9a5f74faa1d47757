#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "city/terrain/Heightfield.h"

namespace app {

/// A heightfield to be measured, by name.
struct TracerBenchField {
    std::string city;
    city::Heightfield field;
};

struct TracerBenchOptions {
    int repeats = 9;   ///< timed rounds; every round times each method once, in turn
    int origins = 32;  ///< points 1.5 m above the street; each sends a fan of 6 x 32 x 32 rays
    std::int64_t checkedRays = 10'000'000;  ///< compared with the exact reference, for each field; 0: none
    bool embree = true;                     ///< measure Embree on the same columns, built as boxes
    std::uint64_t seed = 1;
    std::function<void(double)> progress;  ///< told the finished share, 0 to 1; may be empty
    std::function<bool()> interrupted;     ///< true: stop and return what is finished; may be empty
};

/// Measures ray casting against heightfields on the calling thread. One row for each field, order of rays
/// ("cube": the texels of cube maps, what a local map asks for; "random": uniform directions) and method:
///   dda              textbook Amanatides & Woo, one ray at a time, floats that accumulate: the yardstick
///   trace            GridTracer::trace
///   fan              GridTracer::traceFan
///   embree           rtcIntersect1, default build;   embree_robust: RTC_SCENE_FLAG_ROBUST
///   embree_packet16  rtcIntersect16;                 embree_packet16_robust
/// with {"bench","method","city","rays","mrays_per_s":{min,median,max,n},"ratio_to_dda"} where the ratio is
/// that of medians. Rows of `trace` and `fan` carry "checked", "disagreements" (status, cell or t wrong
/// beyond "t_bound_ulp") for rays that were compared with an integer reference. A field whose borders or
/// heights that reference cannot hold exactly is not checked, and its row has "checked": 0.
nlohmann::json runTracerBench(std::span<const TracerBenchField> fields, const TracerBenchOptions& options);

/// A seeded town of streets and blocks, 1 m cells, for a bench without a city.
TracerBenchField blockTown(std::uint64_t seed, int size = 1000);

}  // namespace app
