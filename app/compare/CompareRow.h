#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/compare/SweepPoint.h"
#include "app/report/Timing.h"

namespace app {

/// Errors of a picture over the cars' mirroring pixels; not a number where not measured.
struct PictureErrors {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double psnr = unknown;     ///< dB
    double ssim = unknown;     ///< structural similarity
    double flip = unknown;     ///< mean LDR-FLIP
    double hdrFlip = unknown;  ///< mean HDR-FLIP
    double flicker = unknown;  ///< see reflection::flicker
    double angle = unknown;    ///< radians, see meanFeatureAngle; against the truth alone
};

/// One measured point.
struct CompareRow {
    SweepPoint point;
    std::uint32_t cars = 0;     ///< asked for
    std::uint32_t visible = 0;  ///< on screen
    std::string views = "one";  ///< "one", "eyes", "four"
    int viewCount = 1;
    int width = 0, height = 0;  ///< of a view
    Timing frame;               ///< whole frame, all views
    Timing reflection;          ///< beyond the same frame of `none`
    double ratioToNone = PictureErrors::unknown;
    double ratioToRerender = PictureErrors::unknown;  ///< of reflection times
    double mapsPerFrame = 0;
    std::size_t textureBytes = 0;
    PictureErrors againstTruth, againstRerender;
    bool onFront = false;  ///< of FLIP against the truth over reflection time, among its cars and views
};

/// Marks the front among the rows of each number of cars and kind of views.
void markFronts(std::vector<CompareRow>& rows);

/// What is published about a method's front beside another's, at one number of cars in one view.
struct FrontVerdict {
    std::uint32_t cars = 0;
    std::string other;       ///< title of the other method
    std::size_t points = 0;  ///< of the other's, between mem's cheapest point and full re-rendering
    std::size_t below = 0;   ///< those where mem has no more error for no more time
};

/// mem's front against `static`, `blend`, `box`, the paper's mem, re-rendering in turn and `raytrace`,
/// wherever they lie between mem's cheapest point and re-rendering every car every frame.
std::vector<FrontVerdict> frontVerdicts(const std::vector<CompareRow>& rows);

/// In the words of result files.
nlohmann::ordered_json toJson(const CompareRow& row, const std::string& city);

}  // namespace app
