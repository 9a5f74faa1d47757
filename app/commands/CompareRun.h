#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/compare/CompareRow.h"
#include "app/compare/PictureStrip.h"
#include "app/render/SceneRenderer.h"

namespace app {

struct CompareOptions {
    std::vector<std::uint32_t> cars{10, 30, 100};  ///< on screen
    std::uint32_t frames = 6;                      ///< measured, at each number of cars
    std::uint32_t warmUp = 2;                      ///< before them, after maps were brought to their age
    double frameStep = 1.0 / 30;                   ///< seconds of traffic from frame to frame
    glm::ivec2 resolution{1280, 720};
    std::uint64_t seed = 1;
    bool pictures = false;  ///< keep strips of the last frame
    bool quiet = false;
};

struct Comparison {
    std::vector<CompareRow> rows;      ///< fronts marked
    std::vector<PictureStrip> strips;  ///< one for each number of cars
    std::string truth;                 ///< what errors are against, for people
};

/// Measures every point of the sweep on the same frames, interleaved frame by frame in an order that turns,
/// at each number of cars; then the points that ask for it for two eyes and for four displays. Errors are
/// over the first view's mirroring pixels, against the truth and against re-rendering every car every frame.
/// An interrupt ends it; what was measured until then is returned. The camera looks down a street as in
/// `bench cars`.
Comparison runComparison(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                         const CompareOptions& options);

}  // namespace app
