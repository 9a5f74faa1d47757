#include "app/panel/Controls.h"

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <cmath>

namespace app {
namespace {

WindowEvent key(int code, bool pressed = true, int modifiers = 0) {
    WindowEvent event;
    event.kind = WindowEventKind::key;
    event.key = code;
    event.pressed = pressed;
    event.modifiers = modifiers;
    return event;
}
WindowEvent button(bool pressed) {
    WindowEvent event;
    event.kind = WindowEventKind::mouseButton;
    event.pressed = pressed;
    return event;
}
WindowEvent moveTo(double x, double y) {
    WindowEvent event;
    event.kind = WindowEventKind::mouseMove;
    event.cursor = {x, y};
    return event;
}
WindowEvent wheel(double notches) {
    WindowEvent event;
    event.kind = WindowEventKind::scroll;
    event.scroll = {0, notches};
    return event;
}
WindowEvent focus(bool gained) {
    WindowEvent event;
    event.kind = WindowEventKind::focus;
    event.pressed = gained;
    return event;
}

ControlResult update(Controls& controls, std::vector<WindowEvent> events, bool mouseTaken = false,
                     bool keysTaken = false) {
    return controls.update(events, mouseTaken, keysTaken);
}

TEST(ControlsTest, aHeldKeyMovesUntilItComesUp) {
    Controls controls;
    EXPECT_EQ(update(controls, {key(GLFW_KEY_W)}).camera.move, glm::dvec3(0, 1, 0));
    EXPECT_EQ(update(controls, {}).camera.move, glm::dvec3(0, 1, 0));
    EXPECT_EQ(update(controls, {key(GLFW_KEY_D), key(GLFW_KEY_E)}).camera.move, glm::dvec3(1, 1, 1));
    EXPECT_EQ(update(controls, {key(GLFW_KEY_W, false), key(GLFW_KEY_A)}).camera.move, glm::dvec3(0, 0, 1));
    EXPECT_EQ(update(controls, {key(GLFW_KEY_LEFT_SHIFT)}).camera.fast, true);
}

TEST(ControlsTest, keysThatCameUpElsewhereDoNotStick) {
    Controls controls;
    update(controls, {key(GLFW_KEY_W), button(true)});
    const ControlResult away = update(controls, {focus(false)});
    EXPECT_EQ(away.camera.move, glm::dvec3(0));
    EXPECT_FALSE(away.looking);
}

TEST(ControlsTest, actionsComeOnceAPressAndNotOfRepeats) {
    Controls controls;
    EXPECT_TRUE(update(controls, {key(GLFW_KEY_M)}).actions.nextMethod);
    WindowEvent repeat = key(GLFW_KEY_M);
    repeat.repeated = true;
    EXPECT_FALSE(update(controls, {repeat}).actions.nextMethod);
    EXPECT_FALSE(update(controls, {}).actions.nextMethod);
    EXPECT_TRUE(update(controls, {key(GLFW_KEY_ESCAPE)}).actions.quit);
    EXPECT_TRUE(update(controls, {key(GLFW_KEY_SPACE)}).actions.pause);
    EXPECT_FALSE(update(controls, {key(GLFW_KEY_SPACE), key(GLFW_KEY_SPACE, false), key(GLFW_KEY_SPACE)})
                     .actions.pause);
    EXPECT_EQ(update(controls, {key(GLFW_KEY_TAB)}).actions.nextVehicle, 1);
    EXPECT_EQ(update(controls, {key(GLFW_KEY_TAB, true, GLFW_MOD_SHIFT)}).actions.nextVehicle, -1);
}

TEST(ControlsTest, draggingLooksAndTheFirstMoveOfADragDoesNotJump) {
    Controls controls;
    update(controls, {moveTo(500, 500)});
    EXPECT_EQ(update(controls, {moveTo(600, 500)}).camera.look, glm::dvec2(0));
    const ControlResult start = update(controls, {button(true), moveTo(0, 0)});
    EXPECT_TRUE(start.looking);
    EXPECT_EQ(start.camera.look, glm::dvec2(0));
    const ControlResult drag = update(controls, {moveTo(10, 0), moveTo(10, 20)});
    EXPECT_GT(drag.camera.look.x, 0);
    EXPECT_NEAR(drag.camera.look.y, -2 * drag.camera.look.x, 1e-12);
    EXPECT_FALSE(update(controls, {button(false), moveTo(90, 90)}).looking);
}

TEST(ControlsTest, whatThePanelTakesMovesNothingButReleasesCount) {
    Controls controls;
    update(controls, {key(GLFW_KEY_W)});
    const ControlResult typed =
        update(controls, {key(GLFW_KEY_D), key(GLFW_KEY_ESCAPE), key(GLFW_KEY_W, false)}, false, true);
    EXPECT_EQ(typed.camera.move, glm::dvec3(0));
    EXPECT_FALSE(typed.actions.quit);
    const ControlResult clicked =
        update(controls, {button(true), moveTo(1, 1), moveTo(9, 9), wheel(2)}, true);
    EXPECT_FALSE(clicked.looking);
    EXPECT_EQ(clicked.camera.look, glm::dvec2(0));
    EXPECT_EQ(clicked.camera.wheel, 0);
    EXPECT_EQ(update(controls, {wheel(2), wheel(-0.5)}).camera.wheel, 1.5);
}

TEST(ControlsTest, theHelpNamesEveryActionsKey) {
    std::string all;
    for (const KeyHelp& help : keyHelp()) all += help.key + " ";
    for (const char* name : {"F1", "F2", "F12", "Esc", "Space", "C", "M", "Tab", "W A S D", "mouse", "wheel"})
        EXPECT_NE(all.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace app
