#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/commands/ChromeStage.h"
#include "app/commands/MirrorBench.h"

namespace app {

/// The parts of `bench chrome` that need no graphics: everything on the calling thread, seeded, what is
/// compared timed in turns.
struct ChromeBenchOptions {
    glm::ivec2 size{1280, 720};     ///< pixels in which displacements are measured
    int repeats = 7;                ///< timed rounds
    int steps = 1000;               ///< of the moving eye
    std::size_t vertices = 200000;  ///< searched for a shape
    std::uint64_t seed = 1;
    std::function<bool()> interrupted;
    std::function<void()> advance;  ///< told after each measurement
    bool stop() const { return interrupted && interrupted(); }
};

/// Searches on a ball, an ellipsoid, a rounded cylinder, a bowl and a saloon's chrome: how many a second, how
/// many lookups, what comes out, and the worst angle between bisector and normal of those found, computed
/// anew.
MirrorRows chromeSearches(const ChromeBenchOptions& options);

/// The share of vertices that is searched for, as in Estalella et al. 2005, figure 7: time, and how far
/// vertices land from where they land with all of them searched for, and from where rays meet the exact
/// surface. Over all vertices that both find, whether something hides them or not.
MirrorRows chromeShares(const ChromeStage& stage, const ChromeBenchOptions& options);

/// The search as published with 3, 5, 7 and 9 steps beside ours, on the first reflector of a scene.
MirrorRows publishedSearches(const ChromeStage& stage, const ChromeBenchOptions& options);

/// A still scene and an eye that moves by `steps` small steps: how much more a vertex moves than its
/// neighbours do.
MirrorRows chromeStills(const ChromeStage& stage, const ChromeBenchOptions& options);

}  // namespace app
