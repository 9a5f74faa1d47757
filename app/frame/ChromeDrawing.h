#pragma once

#include <cstdint>

namespace app {

/// Radii of a part from which on things are left to a map around it: seen from all over the part, their
/// direction differs by less than one part in so many.
inline constexpr double closeRadii = 12;

inline constexpr int mostChromeBounces = 4;

/// How close things are searched for and drawn.
struct ChromeDrawing {
    /// Of a vehicle's vertices, searched for themselves; the rest follow on grids (BoundingGrid).
    double share = 0.096;
    double tolerance = 0.5;  ///< pixels by which a reflected edge may be off where it is drawn straight
    double detail = 1;       ///< pixels in the chrome by which close things' levels may be off
    bool keep = true;        ///< what nothing moved; false: for measuring
    /// Chrome parts in a row that show what is close to them, 1 .. mostChromeBounces. 1: chrome that is seen
    /// in chrome mirrors its vehicle's map alone.
    int bounces = 1;
    bool wait = true;  ///< for reflectors of parts seen in others; otherwise they are made in the background
};

/// What one view's close chrome took.
struct ChromeCounts {
    std::uint32_t jobs = 0, meshes = 0;
    std::uint32_t drawn = 0;    ///< parts of jobs that were drawn anew; the others show what they did
    std::uint32_t leftOut = 0;  ///< close things too small in a part, hidden behind it or too far
    std::uint64_t vertices = 0, searched = 0, triangles = 0;
    std::uint32_t pictures = 0;       ///< of what parts seen in other parts mirror
    std::uint32_t picturesDrawn = 0;  ///< of these: in which something was drawn anew
    std::uint64_t pictureTexels = 0;
    double milliseconds = 0;        ///< searching and handing over, CPU side
    double searchMilliseconds = 0;  ///< the searches alone, on all cores
};

}  // namespace app
