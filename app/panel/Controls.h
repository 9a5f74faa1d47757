#pragma once

#include <glm/vec2.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "app/display/Window.h"
#include "app/frame/CameraRig.h"

namespace app {

/// What keys and mouse asked for since the last frame, beside moving the camera.
struct ControlActions {
    bool quit = false;
    bool pause = false;  ///< toggle
    bool help = false;   ///< toggle
    bool panel = false;  ///< toggle
    bool screenshot = false;
    bool nextCamera = false;
    bool nextMethod = false;
    int nextVehicle = 0;  ///< 1: the next one, -1: the one before
};

struct ControlResult {
    ControlActions actions;
    CameraInput camera;
    bool looking = false;  ///< the mouse turns the camera: the cursor should be hidden
};

/// Turns a window's events into actions and camera input. Knows no window: events are plain data.
class Controls {
  public:
    /// Events since the last call. `mouseTaken`, `keysTaken`: a panel uses them; they then move nothing here,
    /// but a button or key that comes up always counts.
    ControlResult update(std::span<const WindowEvent> events, bool mouseTaken, bool keysTaken);

  private:
    std::set<int> held_;
    bool looking_ = false;
    glm::dvec2 cursor_{0};
    bool cursorKnown_ = false;
};

/// A key and what it does, for the help text; in the order of the help.
struct KeyHelp {
    std::string key;
    std::string what;
};
const std::vector<KeyHelp>& keyHelp();

}  // namespace app
