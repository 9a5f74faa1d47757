#include "app/compare/PictureStrip.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace app {

void errorColour(float error, std::uint8_t rgb[3]) {
    // Every sixteenth of matplotlib's magma (CC0), linear between.
    static constexpr std::array<std::array<int, 3>, 17> stops{{{0, 0, 4},
                                                               {11, 9, 36},
                                                               {32, 17, 75},
                                                               {59, 15, 112},
                                                               {87, 21, 126},
                                                               {114, 31, 129},
                                                               {140, 41, 129},
                                                               {168, 50, 125},
                                                               {196, 60, 117},
                                                               {222, 73, 104},
                                                               {241, 96, 93},
                                                               {250, 127, 94},
                                                               {254, 159, 109},
                                                               {254, 191, 132},
                                                               {253, 222, 160},
                                                               {252, 244, 181},
                                                               {252, 253, 191}}};
    const float place = error >= 0 && error <= 1 ? error * 16 : error < 0 ? 0 : 16;
    const auto low = std::min<std::size_t>(static_cast<std::size_t>(place), 15);
    const float share = place - static_cast<float>(low);
    for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = static_cast<std::uint8_t>(std::lround((1 - share) * static_cast<float>(stops[low][c]) +
                                                       share * static_cast<float>(stops[low + 1][c])));
}

}  // namespace app
