#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "app/frame/ReflectionMethod.h"

namespace app {

/// How accurate reflections are, in plain numbers; the three named qualities are points among them. Larger
/// costs more, but for `errorThreshold`, where smaller does.
struct ReflectionDetail {
    double texelBudget = 80'000;  ///< texels of local maps built a frame
    double texelsPerPixel = 0.5;  ///< face size wanted for each pixel of a vehicle's diameter
    double errorThreshold = 0.5;  ///< pixels of shift of a reflected feature that are let stand
    double candidates = 3;        ///< reference maps asked for a texel; whole numbers count
    double lookups = 4;           ///< of refining a hit; whole numbers count

    bool operator==(const ReflectionDetail&) const = default;
};

/// How accurately a view is drawn.
struct DrawingDetail {
    /// Side of the picture that is drawn over that of the view, (0, 1]; it is stretched afterwards.
    double scale = 1;
    /// Share of the picture's height, in its middle, where antialiasing after the fact mends edges: far
    /// things, which need it most, keep it longest. What it costs goes with it. Nothing where edges are
    /// otherwise treated.
    double antialiasing = 1;
    /// Pixels by which a vehicle's level of detail may be off.
    double vehicleTolerance = 2.5;

    bool operator==(const DrawingDetail&) const = default;
};

/// How much of what a city's windows and wet streets mirror is drawn: limits to what is asked for.
struct MirrorDetail {
    double texels = 1;  ///< side of a reflection over what the picture's size asks for
    double maps = 8;    ///< reflections a frame at most; whole numbers count
    double depth = 2;   ///< mirrors in a row; whole numbers count

    bool operator==(const MirrorDetail&) const = default;
    /// Whether as many reflections are drawn, as deep: those that come or go change a picture at once.
    bool drawsAsMany(const MirrorDetail& b) const {
        return std::lround(maps) == std::lround(b.maps) && std::lround(depth) == std::lround(b.depth);
    }
};

/// Which chrome shows close things itself.
struct ChromeDetail {
    /// Width on screen, pixels, from which on a part does; it does wholly from twice as much. Half of it and
    /// less: the local map is no worse to be seen (bench kerbside: FLIP within 0.01).
    double leastPixels = 24;
    /// The same of chrome seen in other chrome, where that shows close things, too.
    double bouncePixels = 24;
    static constexpr double none = 4096;  ///< no part is so large

    bool operator==(const ChromeDetail&) const = default;
};

struct Detail {
    ReflectionDetail reflection;
    DrawingDetail drawing;
    MirrorDetail mirrors = {};
    ChromeDetail chrome = {};

    bool operator==(const Detail&) const = default;
};

/// The numbers that a named quality stands for.
ReflectionDetail detailOf(Quality quality);

/// Between two details: 0 gives `a`, 1 gives `b`, both exactly. What multiplies costs is blended by ratio,
/// whole numbers in small steps as well, to be rounded where they are used.
Detail blend(const Detail& a, const Detail& b, double t);

/// What `now` gives up against `full`, for people: "half the texels, drawn at 80%"; empty where nothing.
std::string givenUp(const Detail& full, const Detail& now);

}  // namespace app
