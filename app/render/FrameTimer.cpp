#include "app/render/FrameTimer.h"

#include <algorithm>

#include "reflection/gl/SoftwareRenderer.h"

namespace app {

FrameTimer::FrameTimer() : FrameTimer(reflection::softwareRenderer()) {}

FrameTimer::FrameTimer(bool waits) : waits_(waits) {
    if (waits_) return;
    for (Query& query : queries_) query.query = reflection::gl::TimerQuery::create();
}

void FrameTimer::begin() {
    if (waits_) {
        glFinish();
    } else {
        // Oldest first, so that the newest result counts.
        for (std::size_t i = 0; i < queries_.size(); ++i) {
            Query& query = queries_[(next_ + i) % queries_.size()];
            if (!query.pending) continue;
            if (const auto ms = query.query.milliseconds()) {
                gpuMs_ = *ms;
                query.pending = false;
            }
        }
        // Where the card is four frames behind, one is not measured.
        open_ = !queries_[next_].pending;
        if (open_) queries_[next_].query.begin();
    }
    start_ = std::chrono::steady_clock::now();
}

double FrameTimer::end() {
    if (waits_) {
        glFinish();
    } else if (open_) {
        queries_[next_].query.end();
        queries_[next_].pending = true;
        next_ = (next_ + 1) % queries_.size();
        open_ = false;
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
    return waits_ ? elapsed.count() : std::max(elapsed.count(), gpuMs_);
}

}  // namespace app
