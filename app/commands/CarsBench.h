#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/SceneRenderer.h"
#include "app/report/Timing.h"

namespace app {

struct CarsBenchOptions {
    std::vector<std::uint32_t> cars{10, 30, 100};  ///< on screen
    std::uint32_t frames = 8;                      ///< measured frames at each number of cars
    std::uint32_t warmUp = 4;                      ///< frames before them
    double frameStep = 1.0 / 30;                   ///< seconds of traffic from frame to frame
    glm::ivec2 resolution{1280, 720};
    std::uint64_t seed = 1;
    Quality quality = Quality::medium;
    MapsOn mapsOn =
        MapsOn::automatic;  ///< gpu, or automatic on a graphics card: a row `mem gpu` beside `mem`
    std::size_t gpuMapBytes = ReflectionSettings{}.gpuMapBytes;
    bool quiet = false;
};

struct CarsRow {
    std::string method;
    std::uint32_t cars = 0;      ///< asked for
    std::uint32_t visible = 0;   ///< on screen, each with a map of its own (but `none` and `static`)
    Timing frame;                ///< whole frame, until OpenGL had finished
    Timing reflection;           ///< frame minus the same frame of `none`
    double ratioToNone = 0;      ///< median over frames
    double rerenderRatio = NAN;  ///< reflection time of re-rendering over this one's, median over frames; not
                                 ///< a number for `none`
    double psnr = 0,
           flip = 0;  ///< over the cars' mirroring pixels, against re-rendering every car every frame
    double mapsPerFrame = 0;
    std::size_t textureBytes = 0;  ///< local maps, and reference maps where they are there, on the GPU
};

/// All reflection methods on the same frames, interleaved frame by frame: `none static blend box mem-paper
/// mem raytrace rerender`. The camera looks down a street; traffic is put before it until that many cars are
/// on screen, and cars off screen or beyond the number are taken away. `none` is the same frame with plain
/// paint, drawn as fast as the renderer can.
std::vector<CarsRow> runCarsBench(const Scene& scene, const PreparedReflections& prepared,
                                  SceneRenderer& renderer, const CarsBenchOptions& options);

}  // namespace app
