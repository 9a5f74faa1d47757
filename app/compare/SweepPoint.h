#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/frame/ReflectionMethod.h"

namespace app {

/// The ways of drawing that are compared: those of ReflectionMethod, and the rival.
inline constexpr std::array<std::string_view, 7> comparedMethods{"none", "static",   "blend",   "box",
                                                                 "mem",  "rerender", "raytrace"};

/// One way of drawing reflections with one setting: a point in the plane of cost and error.
struct SweepPoint {
    std::string method;         ///< one of comparedMethods
    std::string variant;        ///< "paper" for the published form of mem, else empty
    std::string setting;        ///< what was set, for people; unique among the points of a method and variant
    bool isDefault = false;     ///< the method as the program runs it unless told otherwise
    bool severalViews = false;  ///< measured for several displays and eyes as well

    // Of maps, as far as each matters to the method.
    Quality quality = Quality::medium;
    double texelsPerPixel = 0.5;
    double texelBudget = 80'000;  ///< texels a frame
    double errorThreshold = 0.5;  ///< pixels
    double candidates = 3, lookups = 4;
    bool everyFrame = false;
    bool parallax = true;
    std::uint32_t mapsInTurn = 0;  ///< 0: not in turn
    int faceSize = 0;              ///< 0: by the size on screen
    // Of rays.
    int samples = 1;

    /// "mem", "mem paper".
    std::string title() const { return variant.empty() ? method : method + " " + variant; }
};

/// What was set, for result files: the numbers that matter to the method.
nlohmann::ordered_json settingsOf(const SweepPoint& point);

/// Every method with its settings swept from cheap to dear. `raytrace` where there is a ray tracer.
std::vector<SweepPoint> comparedPoints(bool raytrace);

}  // namespace app
