#include "app/panel/WindowProgress.h"

#include <epoxy/gl.h>
// GLFW must find the GL declarations already there.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

namespace app {

namespace {

using namespace std::chrono_literals;

constexpr auto betweenPictures = 50ms;

}  // namespace

bool WindowProgress::show(const Waiting& waiting) {
    for (const WindowEvent& event : window_.pollEvents()) {
        if (event.kind == WindowEventKind::key && event.key == GLFW_KEY_ESCAPE && event.pressed)
            ended_ = true;
        const bool cameUp =
            (event.kind == WindowEventKind::key || event.kind == WindowEventKind::mouseButton ||
             event.kind == WindowEventKind::focus) &&
            !event.pressed;
        if (cameUp) released_.push_back(event);
    }
    const auto now = std::chrono::steady_clock::now();
    const bool due = waiting.what != shown_ || now - lastShown_ >= betweenPictures;
    const glm::ivec2 size = window_.framebufferSize();
    if (due && size.x > 0 && size.y > 0) {
        shown_ = waiting.what;
        lastShown_ = now;
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glClearColor(0.09f, 0.1f, 0.12f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        if (backdrop_) backdrop_->copyTo(0, size);
        panel_.drawWaiting(waiting);
        window_.present();
    }
    return !ended_ && !window_.closeRequested();
}

std::vector<WindowEvent> WindowProgress::finish() {
    ended_ = false;
    backdrop_.reset();
    shown_.clear();
    return std::exchange(released_, {});
}

}  // namespace app
