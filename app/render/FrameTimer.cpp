#include "app/render/FrameTimer.h"

#include <algorithm>

#include "reflection/gl/SoftwareRenderer.h"

namespace app {

FrameTimer::FrameTimer() : FrameTimer(reflection::softwareRenderer()) {}

FrameTimer::FrameTimer(bool waits) : waits_(waits) {
    if (waits_) return;
    for (reflection::gl::TimerQuery& query : queries_) query = reflection::gl::TimerQuery::create();
}

void FrameTimer::begin() {
    if (waits_) {
        glFinish();
    } else if (const auto slot = turns_.begin([&](std::size_t s) { return queries_[s].milliseconds(); })) {
        running_ = *slot;
        queries_[running_].begin();
    }
    start_ = std::chrono::steady_clock::now();
}

double FrameTimer::end() {
    if (waits_) {
        glFinish();
    } else if (turns_.end()) {
        queries_[running_].end();
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
    return waits_ ? elapsed.count() : std::max(elapsed.count(), turns_.milliseconds());
}

}  // namespace app
