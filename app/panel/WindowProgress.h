#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "app/display/OffscreenTarget.h"
#include "app/display/Window.h"
#include "app/panel/Panel.h"

namespace app {

/// Keeps a window alive while the program works between pictures: shows how far it has come and hears when
/// the user has had enough.
class WindowProgress {
  public:
    WindowProgress(Window& window, Panel& panel) : window_(window), panel_(panel) {}

    /// What lies behind the bar; nothing: a dark window.
    void setBackdrop(std::unique_ptr<OffscreenTarget> backdrop) { backdrop_ = std::move(backdrop); }

    /// Shows the work at most twenty times a second (a change of `what` at once). False once Esc was pressed
    /// or the window closed.
    bool show(const Waiting& waiting);
    /// Ready for other work: no Esc was pressed, nothing lies behind the bar. Tells which keys and buttons
    /// came up meanwhile: whoever follows what is held down must hear of them.
    std::vector<WindowEvent> finish();

  private:
    Window& window_;
    Panel& panel_;
    std::unique_ptr<OffscreenTarget> backdrop_;
    std::vector<WindowEvent> released_;
    std::string shown_;
    std::chrono::steady_clock::time_point lastShown_{};
    bool ended_ = false;
};

}  // namespace app
