#pragma once

#include <array>
#include <chrono>

#include "app/render/QueryTurns.h"
#include "reflection/gl/TimerQuery.h"

namespace app {

/// How long frames take. Where OpenGL is software, waits for it before and after, which costs nothing there,
/// and knows the very frame's time. A graphics card must not be waited for, as it works on one frame while
/// the next is prepared: there, timer queries tell some frames later what a frame took, and a frame's time is
/// what the processor or the card took, whichever was more. Where the card's queries do not answer, the
/// processor's time is all that is known.
class FrameTimer {
  public:
    /// Needs a current context. `waits`: as if OpenGL were software, or not; for tests.
    FrameTimer();
    explicit FrameTimer(bool waits);

    void begin();
    /// Milliseconds. Of a graphics card the last frame that it has finished counts.
    double end();

  private:
    bool waits_;
    std::chrono::steady_clock::time_point start_;
    std::array<reflection::gl::TimerQuery, QueryTurns::slots> queries_;
    QueryTurns turns_;
    std::size_t running_ = 0;
};

}  // namespace app
