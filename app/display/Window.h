#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace app {

struct WindowOptions {
    std::string title = "mirrorstreet";
    glm::ivec2 size{1280, 720};  ///< in screen coordinates
    bool vsync = true;
    bool fullscreen = false;  ///< on the primary monitor, at its own resolution
};

enum class WindowEventKind : std::uint8_t { key, character, mouseButton, mouseMove, scroll, resize, focus };

/// What the user did. Fields that do not belong to the kind are zero.
struct WindowEvent {
    WindowEventKind kind = WindowEventKind::key;
    int key = 0;                  ///< GLFW_KEY_*: printable keys are their upper-case ASCII character
    bool pressed = false;         ///< key or button went down, or focus came; false: up, or gone
    bool repeated = false;        ///< a held key speaking again
    int modifiers = 0;            ///< GLFW_MOD_*: 1 shift, 2 control, 4 alt
    int button = 0;               ///< 0 left, 1 right, 2 middle
    std::uint32_t character = 0;  ///< Unicode code point
    glm::dvec2 cursor{0};         ///< screen coordinates from the top left
    glm::dvec2 scroll{0};
};

/// A window with an OpenGL 4.5 core context, which is current on the constructing thread from construction to
/// destruction. One at a time. Throws std::runtime_error when there is no display or no OpenGL 4.5, naming
/// what to install or to do.
class Window {
  public:
    explicit Window(const WindowOptions& options);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Whether a display server is there to ask (DISPLAY or WAYLAND_DISPLAY): otherwise draw offscreen.
    static bool possible();

    /// Collects what happened since the last call. Never waits.
    std::vector<WindowEvent> pollEvents();
    /// Shows what was drawn into framebuffer 0; waits for the display when vsync is on.
    void present();

    bool closeRequested() const;
    void requestClose();
    glm::ivec2 framebufferSize() const;  ///< pixels; may be (0, 0) while minimised
    bool minimised() const;              ///< nobody sees what is drawn
    glm::dvec2 cursor() const;           ///< screen coordinates from the top left
    bool keyDown(int key) const;
    bool buttonDown(int button) const;
    void setTitle(const std::string& title);
    void setVsync(bool on);
    /// Hides the cursor and lets it move without bounds, for looking around.
    void captureCursor(bool on);

    const std::string& renderer() const;  ///< GL_RENDERER
    const std::string& version() const;   ///< GL_VERSION
    bool software() const;

    /// For a panel library that brings its own GLFW binding. It must install its callbacks chained to those
    /// that are there.
    GLFWwindow* handle() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
