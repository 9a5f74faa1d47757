#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/compare/ChromeRow.h"
#include "app/compare/CompareRow.h"
#include "app/compare/PictureStrip.h"
#include "app/compare/WindowRow.h"

namespace app {

/// Where and how a comparison was measured.
struct PageHead {
    std::string city;
    std::uint64_t seed = 1;
    std::string version, renderer, cpu;
    unsigned threads = 0;
    std::uint32_t frames = 0;
    std::string truth;     ///< what errors are against
    bool partial = false;  ///< cut short by an interrupt
};

/// One HTML page that needs nothing but itself: charts, pictures with a slider, verdicts, and a table of all
/// rows; the city's windows and close-ups of chrome in parts of their own, where there are rows of them; with
/// a style for paper. Texts from outside are escaped.
std::string comparePage(const PageHead& head, const std::vector<CompareRow>& rows,
                        const std::vector<PictureStrip>& strips, const WindowComparison& windows = {},
                        const ChromeComparison& chrome = {});

}  // namespace app
