#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/ChromeStage.h"
#include "app/commands/MirrorBench.h"
#include "reflection/chrome/VirtualObject.h"

namespace app {

/// How `bench chrome` measures: seeded, what is compared in turns.
struct ChromeBenchOptions {
    glm::ivec2 size{1280, 720};     ///< pixels in which displacements are measured
    int repeats = 7;                ///< timed rounds
    glm::ivec2 picture{640, 480};   ///< pixels of pictures and of timed frames
    int steps = 1000;               ///< of the moving eye
    std::size_t vertices = 200000;  ///< searched for a shape
    std::uint64_t seed = 1;
    reflection::VirtualOptions vertex;          ///< which search; its share is what is measured
    std::optional<std::filesystem::path> car;   ///< GLB whose front is searched in place of the saloon's
    double carLength = 4.5;                     ///< metres
    std::optional<std::filesystem::path> save;  ///< pictures go here
    bool searchOnGpu = false;                   ///< in pictures, where everything is searched for
    std::function<bool()> interrupted;
    std::function<void()> advance;  ///< told after each measurement
    bool stop() const { return interrupted && interrupted(); }
};

/// Searches on a ball, an ellipsoid, a rounded cylinder, a bowl and a saloon's front: how many a second on
/// this thread, how many lookups, what comes out, and the worst angle between bisector and normal of those
/// found, computed anew. Needs no graphics.
MirrorRows chromeSearches(const ChromeBenchOptions& options);

/// The same on the graphics card, against the processor's search in double precision: how far points and
/// virtual vertices lie apart as seen from the eye, and statuses that differ. Needs a context.
MirrorRows chromeSearchesOnGpu(const ChromeBenchOptions& options);

/// The share of vertices that is searched for, as in Estalella et al. 2005, figure 7: time, and how far
/// vertices land from where they land with all of them searched for, and from where rays meet the exact
/// surface. Over all vertices that both find, whether something hides them or not. Needs no graphics.
MirrorRows chromeShares(const ChromeStage& stage, const ChromeBenchOptions& options);

/// The search as published with 3, 5, 7 and 9 steps beside ours, as in figure 8. Needs no graphics.
MirrorRows publishedSearches(const ChromeStage& stage, const ChromeBenchOptions& options);

/// A still scene and an eye that moves by `steps` small steps: how much more a vertex moves than its
/// neighbours do. Needs no graphics.
MirrorRows chromeStills(const ChromeStage& stage, const ChromeBenchOptions& options);

/// How often the four below tell of their progress.
constexpr std::size_t chromePictureSteps = 13;

/// Whole frames by share. Needs a context, as the next two.
MirrorRows chromeFrames(const ChromeStage& stage, const ChromeBenchOptions& options);

/// Pictures by environment maps, by searched reflection points and by rays: error over the chrome's pixels,
/// and cost.
MirrorRows chromePictures(const ChromeStage& stage, const ChromeBenchOptions& options);

/// What chrome parts show of each other, by depth 1 (maps alone) to 4: error over the pixels in which rays
/// meet two and three mirrors, pictures planned, cost.
MirrorRows chromeBounces(const MirrorWorld& world, const ChromeBenchOptions& options);

/// What close chrome costs where there is none to see.
MirrorRows chromeNone(const ChromeStage& stage, const ChromeBenchOptions& options);

}  // namespace app
