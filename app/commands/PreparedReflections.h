#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/frame/Lighting.h"
#include "city/model/CityModel.h"
#include "reflection/gl/SceneDrawer.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/reference_maps/Placement.h"
#include "reflection/tracing/GridTracer.h"

namespace app {

/// Asked between reference maps, with those that are finished and all there will be; (0, 0) while their
/// places are still being chosen. False ends the work.
using CarryOn = std::function<bool(std::size_t done, std::size_t total)>;

struct PreparationOptions {
    float cell = 1;      ///< heightfield cell, metres
    int faceSize = 256;  ///< of the reference maps, texels
    int supersampling = 2;
    reflection::PlacementOptions placement;
    bool useCache = true;
    bool maps = true;  ///< false: the tracer alone
    /// A cache that cannot be written is an error; otherwise it is said, and the maps are drawn for this run.
    bool cacheIsPurpose = false;
    std::filesystem::path cache;  ///< empty: the user's cache folder
    bool quiet = false;
    CarryOn carryOn;  ///< may be empty; an interrupt ends the work in any case
};

/// What the reflections of a city need before its first frame: heightfield, tracer, reference maps.
struct PreparedReflections {
    std::unique_ptr<reflection::GridTracer> tracer;
    std::vector<reflection::PackedReferenceMap> maps;
    double coverage = 0;  ///< share of the surface visible from driving positions that some map sees
    std::size_t loaded = 0;
    std::size_t baked = 0;
    bool complete = true;          ///< false: interrupted; finished maps are in the cache
    std::filesystem::path folder;  ///< of the cache; empty when none is used
};

/// Points along all car and tram lanes, `step` metres apart, on the road.
std::vector<glm::vec3> drivingPositions(const city::CityModel& city, float step);

/// Folder in which a user's caches belong: $MIRRORSTREET_CACHE, else $XDG_CACHE_HOME/mirrorstreet, else
/// ~/.cache/mirrorstreet.
std::filesystem::path cacheFolder();

/// What the cache holds of a city's reference maps.
struct CachedReflections {
    std::size_t placed = 0, finished = 0;  ///< maps
    double coverage = 0;                   ///< as in PreparedReflections, once all are finished
    std::size_t bytes = 0;                 ///< of the finished ones, packed as they are used
    double bytesPerTexel = 0;              ///< colour and distance together; 0 where none is finished
};

/// Looks without drawing anything; nothing where no places were chosen yet for this light and these options.
std::optional<CachedReflections> cachedReflections(const city::CityModel& city, const Lighting& lighting,
                                                   const PreparationOptions& options);

/// Places and renders the city's reference maps, or takes them from the cache. `drawer` must be prepared with
/// the lighting and no vehicles. Says on stderr which damaged cache entries it rebuilt.
PreparedReflections prepareReflections(const city::CityModel& city, const Lighting& lighting,
                                       reflection::SceneDrawer& drawer, const PreparationOptions& options);

}  // namespace app
