#pragma once

#include <cstdint>

#include "app/frame/ReflectionMethod.h"
#include "app/frame/Weather.h"

namespace app {

/// What a drive can be asked to change while it runs.
struct DriveSettings {
    ReflectionMethod method = ReflectionMethod::mem;
    MemVariant mem = MemVariant::ours;
    Quality quality = Quality::medium;
    std::uint32_t cars = 60;
    double hour = 15;
    double budgetMs = 0;           ///< time of a frame that is to be held (method mem, ours); 0: none
    double error = 0;              ///< mean FLIP on mirrors that is to be met as cheaply as may be; 0: none
    bool fixedQuality = false;     ///< budget (by the first view) or error choose a detail once, and it stays
    bool mirrors = true;           ///< the city's windows mirror
    int mirrorDepth = 2;           ///< mirrors in a row
    std::uint32_t mirrorMaps = 8;  ///< reflections drawn a frame at most
    double mirrorFade = 0;         ///< metres behind a mirror on which what it shows fades to 1/e; 0: not
    bool chrome = true;            ///< chrome shows close things where they truly appear
    double chromeShare = 0;        ///< of what chrome shows, searched for at most; 0: no bound
    int chromeBounces = 1;         ///< chrome parts in a row that show close things
    Weather weather = Weather::dry;  ///< wet streets need `mirrors`
    bool adapt = true;               ///< exposure follows the light around the viewer

    /// Whether details follow from a budget or an error instead of `quality`.
    bool governed() const {
        return method == ReflectionMethod::mem && mem == MemVariant::ours && (budgetMs > 0 || error > 0);
    }

    bool operator==(const DriveSettings&) const = default;
};

}  // namespace app
