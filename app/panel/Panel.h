#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/display/Window.h"
#include "app/frame/DetailLadder.h"
#include "app/frame/DriveSettings.h"
#include "app/frame/ReflectionEngine.h"
#include "app/panel/MapView.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// Cameras that the panel offers: shots in turn, and the rig's modes.
enum class CameraChoice : std::uint8_t { shots, tour, follow, fly };

/// What the panel lets the user choose. Plain data: the panel changes it, the program obeys.
struct PanelChoices {
    DriveSettings settings;
    CameraChoice camera = CameraChoice::shots;
    bool paused = false;
    bool showPanel = true;
    bool showHelp = false;
    bool showMap = false;
    bool showMesh = true;
    int nextVehicle = 0;      ///< asked for in this frame
    bool screenshot = false;  ///< asked for in this frame
};

/// What the panel tells.
struct PanelNews {
    std::string renderer;
    std::span<const float> frameMs;  ///< oldest first
    ReflectionCounters reflections;
    RenderCounters drawn;
    MirrorCounters mirrors;
    std::uint32_t chromeParts = 0, chromeLeftOut = 0, chromeMaking = 0;
    std::size_t chromeBytes = 0;  ///< of reflectors
    std::size_t vehicles = 0;
    std::span<const Rung> ladder;  ///< what a budget is held with; empty: there is none
    double position = 0;           ///< on it
    double predictedMs = 0, actualMs = 0;
    double predictedError = 0;     ///< mean FLIP on mirrors, as calibrated
    std::string givenUp;           ///< empty: nothing
    std::string followed;          ///< name of the followed vehicle; empty: none
    std::uint32_t mapTexture = 0;  ///< from MapView; 0: nothing to show
    std::span<const MapLine> mesh;
    int mapFaceSize = 0;  ///< texels
};

/// Work that the user waits for.
struct Waiting {
    std::string what;
    std::size_t done = 0;
    std::size_t total = 0;  ///< 0: nobody knows how much it is
    std::string remark;     ///< how to end it; may be empty
};

/// The Dear ImGui panel over a window. The window's OpenGL context must be current from construction to
/// destruction.
class Panel {
  public:
    explicit Panel(Window& window);
    ~Panel();
    Panel(const Panel&) = delete;
    Panel& operator=(const Panel&) = delete;

    bool takesMouse() const;  ///< the pointer is over the panel, or drags something of it
    bool takesKeys() const;   ///< a field is being typed into

    /// Draws into the bound framebuffer 0 and changes the choices by what was clicked.
    void draw(const PanelNews& news, PanelChoices& choices);
    /// Draws, instead of the panel, how far some work has come.
    void drawWaiting(const Waiting& waiting);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
