#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/compare/CompareRow.h"
#include "app/compare/PictureStrip.h"
#include "app/report/Timing.h"

namespace app {

/// One close-up of chrome by one method: what a frame costs and how wrong the chrome's pixels are.
struct ChromeRow {
    std::string view;        ///< what is looked at
    std::string method;      ///< "mem", "chrome", ...
    std::uint32_t jobs = 0;  ///< parts that show close things themselves
    std::size_t pixels = 0;  ///< of the chrome
    int width = 0, height = 0;
    Timing frame;
    double ratioToNone = PictureErrors::unknown;  ///< median of a frame over the one of `none` beside it
    double psnr = PictureErrors::unknown, flip = PictureErrors::unknown;  ///< against the truth
};

/// The close-ups of a comparison; no rows where nothing of chrome stands close to anything.
struct ChromeComparison {
    std::vector<ChromeRow> rows;
    std::vector<PictureStrip> strips;
};

/// In the words of result files.
nlohmann::ordered_json toJson(const ChromeRow& row, const std::string& city);

}  // namespace app
