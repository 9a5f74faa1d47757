#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/report/Picture.h"

namespace app {

/// The same piece of the same frame by several methods.
struct PictureStrip {
    struct Frame {
        std::string title;    ///< of the method
        std::string setting;  ///< of the point
        double flip = 0;      ///< mean over the whole frame's mirroring pixels, against the truth
        Picture picture;
        Picture difference;  ///< FLIP against the truth, in the magma colours: black 0, pale yellow 1
    };
    std::string title;  ///< empty: so many cars on screen
    std::uint32_t cars = 0;
    Picture truth;
    std::vector<Frame> frames;
};

/// An error of 0..1 as a colour, sRGB 8 bit: the magma map, as FLIP's authors show errors. Dark to light in
/// grey as well, for print. NaN shows as 1.
void errorColour(float error, std::uint8_t rgb[3]);

}  // namespace app
