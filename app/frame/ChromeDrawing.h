#pragma once

#include <cstdint>

namespace app {

/// Radii of a part from which on things are left to a map around it: seen from all over the part, their
/// direction differs by less than one part in so many.
inline constexpr double closeRadii = 12;

inline constexpr int mostChromeBounces = 4;

/// How close things are searched for and drawn.
struct ChromeDrawing {
    /// Of what a piece of chrome shows, vertices that are searched for themselves, at most; the rest follow
    /// in cells. 0: as many as it takes until none is off by more than half the tolerance.
    double share = 0;
    double tolerance = 0.5;  ///< pixels by which a reflected edge may be off where it is drawn straight
    double detail = 1;       ///< pixels in the chrome by which close things' levels may be off
    bool keep = true;        ///< what nothing moved; false: for measuring
    /// Chrome parts in a row that show what is close to them, 1 .. mostChromeBounces. 1: chrome that is seen
    /// in chrome mirrors its vehicle's map alone.
    int bounces = 1;
    /// Pixels that chrome must cover in other chrome to show what is close to it, where there is more than
    /// one bounce; see ChromeBounceOptions.
    double bouncePixels = 24;
    bool wait = true;  ///< for reflectors of parts seen in others; otherwise they are made in the background

    bool operator==(const ChromeDrawing&) const = default;
};

/// Chrome seen in the chrome of other vehicles, and what became of it, with all bounces.
struct ChromeBounceCounts {
    std::uint32_t parts = 0;     ///< close to parts with jobs
    std::uint32_t pictures = 0;  ///< of what they mirror: all that are shown
    std::uint32_t drawn = 0;     ///< of these: anew in this frame; the others hold to less than a pixel
    std::uint32_t fading = 0;    ///< of these: on their way in or out
    // Without a picture, and why: their vehicle's map is shown.
    std::uint32_t tooSmall = 0, unseen = 0, tooBent = 0, tooNear = 0, overCap = 0, making = 0;
    std::uint64_t texels = 0;  ///< of all pictures
    double milliseconds = 0;   ///< planning, searching and handing over, CPU side

    void add(const ChromeBounceCounts& b) {
        parts += b.parts;
        pictures += b.pictures;
        drawn += b.drawn;
        fading += b.fading;
        tooSmall += b.tooSmall;
        unseen += b.unseen;
        tooBent += b.tooBent;
        tooNear += b.tooNear;
        overCap += b.overCap;
        making += b.making;
        texels += b.texels;
    }
};

/// What one view's close chrome took.
struct ChromeCounts {
    std::uint32_t jobs = 0, meshes = 0;
    std::uint32_t drawn = 0;    ///< parts of jobs that were drawn anew; the others show what they did
    std::uint32_t leftOut = 0;  ///< close things too small in a part, hidden behind it or too far
    std::uint64_t vertices = 0, searched = 0, triangles = 0;
    ChromeBounceCounts bounces;
    double milliseconds = 0;        ///< searching and handing over, CPU side
    double searchMilliseconds = 0;  ///< the searches alone, on all cores
};

}  // namespace app
