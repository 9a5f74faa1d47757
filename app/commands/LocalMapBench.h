#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "app/commands/PreparedReflections.h"
#include "app/frame/ReflectionEngine.h"
#include "app/report/Timing.h"
#include "city/model/CityModel.h"

namespace app {

struct LocalMapBenchOptions {
    int faceSize = 128;  ///< texels of the local maps
    int places = 12;     ///< positions along the lanes, chosen by the seed
    int repeats = 5;     ///< timed builds at each place
    std::uint64_t seed = 1;
    float centreHeight = 0.8f;  ///< of the maps above the road, metres
    Lighting lighting;
    bool quiet = false;
    MapsOn mapsOn =
        MapsOn::automatic;  ///< gpu, or automatic on a graphics card: a row `mem gpu` beside `mem`
    std::size_t gpuMapBytes = ReflectionSettings{}.gpuMapBytes;
};

struct LocalMapRow {
    std::string method;
    Timing time;                 ///< one map
    double ratioToRerender = 0;  ///< median of time / re-rendering's at the same place in the same round
    // Not a number where nothing was measured: Embree finds distances, not colours.
    double psnr = NAN;  ///< dB, tone mapped, against re-rendering at the same size; over all places' texels
    double psnrWorst = NAN;         ///< of the worst place
    double psnrSupersampled = NAN;  ///< against re-rendering with 4x4 samples a texel
    double psnrToProcessor = NAN;   ///< `mem gpu`: against `mem`, texels rounded as on the GPU included
    double flip = NAN;              ///< mean FLIP over the faces
    std::uint64_t rays = 0;         ///< a map, mean
    std::size_t referenceMapGpuBytes = 0;  ///< `mem gpu`: allocated
    double bytesPerTexel = NAN;            ///< `mem gpu`: of the reference maps there
};

/// One local map of a stopped car: every method against re-rendering its six faces, interleaved place by
/// place, all on the same threads; beside it an exact trace of the same texels by Embree. Needs a GL context;
/// `drawer` prepared without vehicles.
std::vector<LocalMapRow> runLocalMapBench(const city::CityModel& city, const PreparedReflections& prepared,
                                          reflection::SceneDrawer& drawer,
                                          const LocalMapBenchOptions& options);

}  // namespace app
