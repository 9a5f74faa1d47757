#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>

#include "app/commands/CityMirrors.h"
#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/frame/DetailLadder.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/SceneRenderer.h"

namespace app {

struct CloseScene;

struct CalibrationOptions {
    glm::ivec2 resolution{1280, 720};
    std::uint64_t seed = 1;
    Antialiasing antialiasing = Antialiasing::fxaa;  ///< what the renderer was made with
    MapsOn mapsOn = MapsOn::automatic;
    std::size_t gpuMapBytes = ReflectionSettings{}.gpuMapBytes;
    /// Windows and wet streets are drawn and go up and down the ladder; null, or where there are none: not.
    CityMirrors* mirrors = nullptr;
    /// Close chrome is drawn and goes up and down the ladder; null: not. The renderer has it.
    const CloseScene* close = nullptr;
    int chromeBounces = 1;  ///< see ChromeDrawing; more go up and down the ladder, too
    std::string renderer;  ///< GL_RENDERER: what is measured holds for it alone
    bool useCache = true;
    std::filesystem::path cache;  ///< empty: the user's cache folder
    bool quiet = false;
    CarryOn carryOn;  ///< may be empty
};

struct Calibration {
    DetailLadder ladder;
    bool complete = true;        ///< false: ended by `carryOn` or an interrupt, and there is no ladder
    bool fromCache = false;      ///< else measured now
    double scatter = 0;          ///< of like frames while it was measured; see DetailBench::scatter
    std::filesystem::path file;  ///< where it is kept; empty: nowhere
};

/// What details of `mem` cost on this machine, and what they lose: the ladder that a Governor goes up and
/// down.
///
/// Two clips of traffic (beside a car, and along the tour) are drawn by many details, interleaved frame by
/// frame: first each knob turned down alone, from which follows the order of giving things up; then the rungs
/// of that order, whose Pareto front is the ladder. Errors are mean FLIP against re-rendering every car,
/// drawn in full. Some ten seconds where OpenGL is software; kept in the cache by renderer, processor, city,
/// size and antialiasing. Needs a current OpenGL context; leaves the renderer at full detail.
Calibration calibrate(const Scene& scene, const Lighting& lighting, const PreparedReflections& prepared,
                      SceneRenderer& renderer, const CalibrationOptions& options);

/// The ladder as a table, for people.
std::string describe(const DetailLadder& ladder);

/// As text and back; nothing where it is not a ladder of this version and key.
std::string ladderToText(const DetailLadder& ladder, const std::string& key);
std::optional<DetailLadder> ladderFromText(const std::string& text, const std::string& key);

}  // namespace app
