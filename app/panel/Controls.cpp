#include "app/panel/Controls.h"

#include <GLFW/glfw3.h>

namespace app {

namespace {

/// Radians a pixel of mouse movement: a swing of the hand (300 pixels) turns by about 70 degrees.
constexpr double lookSpeed = 0.004;

}  // namespace

ControlResult Controls::update(std::span<const WindowEvent> events, bool mouseTaken, bool keysTaken) {
    ControlResult result;
    ControlActions& actions = result.actions;
    for (const WindowEvent& event : events) {
        switch (event.kind) {
            case WindowEventKind::key:
                if (!event.pressed) held_.erase(event.key);
                if (!event.pressed || keysTaken || event.repeated) break;
                held_.insert(event.key);
                switch (event.key) {
                    case GLFW_KEY_ESCAPE:
                        actions.quit = true;
                        break;
                    case GLFW_KEY_SPACE:
                        actions.pause = !actions.pause;
                        break;
                    case GLFW_KEY_F1:
                        actions.help = !actions.help;
                        break;
                    case GLFW_KEY_F2:
                        actions.panel = !actions.panel;
                        break;
                    case GLFW_KEY_F12:
                        actions.screenshot = true;
                        break;
                    case GLFW_KEY_C:
                        actions.nextCamera = true;
                        break;
                    case GLFW_KEY_M:
                        actions.nextMethod = true;
                        break;
                    case GLFW_KEY_TAB:
                        actions.nextVehicle += (event.modifiers & GLFW_MOD_SHIFT) != 0 ? -1 : 1;
                        break;
                    default:
                        break;
                }
                break;
            case WindowEventKind::mouseButton:
                if (event.button != GLFW_MOUSE_BUTTON_LEFT && event.button != GLFW_MOUSE_BUTTON_RIGHT) break;
                looking_ = event.pressed && !mouseTaken;
                cursorKnown_ = false;
                break;
            case WindowEventKind::mouseMove:
                if (looking_ && cursorKnown_) {
                    const glm::dvec2 moved = event.cursor - cursor_;
                    result.camera.look += lookSpeed * glm::dvec2(moved.x, -moved.y);
                }
                cursor_ = event.cursor;
                cursorKnown_ = true;
                break;
            case WindowEventKind::scroll:
                if (!mouseTaken) result.camera.wheel += event.scroll.y;
                break;
            case WindowEventKind::focus:
                // Keys that come up while another window listens are never told.
                if (!event.pressed) held_.clear();
                if (!event.pressed) looking_ = false;
                break;
            case WindowEventKind::character:
            case WindowEventKind::resize:
                break;
        }
    }
    const auto axis = [this](int plus, int minus) {
        return (held_.contains(plus) ? 1.0 : 0.0) - (held_.contains(minus) ? 1.0 : 0.0);
    };
    result.camera.move = {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_W, GLFW_KEY_S),
                          axis(GLFW_KEY_E, GLFW_KEY_Q)};
    result.camera.fast = held_.contains(GLFW_KEY_LEFT_SHIFT) || held_.contains(GLFW_KEY_RIGHT_SHIFT);
    result.looking = looking_;
    return result;
}

const std::vector<KeyHelp>& keyHelp() {
    static const std::vector<KeyHelp> help{
        {"F1", "this help"},
        {"F2", "panel on and off"},
        {"F12", "screenshot into the output folder"},
        {"Esc", "quit"},
        {"Space", "pause and go on"},
        {"C", "camera: shots, tour, follow, fly"},
        {"M", "reflection method: none, static, blend, box, mem, rerender"},
        {"Tab, Shift+Tab", "follow the next or the previous vehicle"},
        {"W A S D", "fly; circle and approach the followed vehicle"},
        {"E, Q", "fly up and down"},
        {"Shift", "four times as fast"},
        {"drag the mouse", "look around; circle the followed vehicle"},
        {"wheel", "speed of flight; distance to the followed vehicle"},
    };
    return help;
}

}  // namespace app
