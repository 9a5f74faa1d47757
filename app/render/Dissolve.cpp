#include "app/render/Dissolve.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

namespace app {

void Dissolve::start(glm::ivec2 size, int frames) {
    live_.clear();
    size_ = glm::max(size, glm::ivec2(1));
    tiles_ = (size_ + tile - 1) / tile;
    frame_ = 0;
    frames_ = std::max(frames, 1);
    replaced_ = 0;
    now_.assign(static_cast<std::size_t>(tiles_.x) * static_cast<std::size_t>(tiles_.y), 0);
}

void Dissolve::keepLive(std::uint64_t name, const glm::ivec4& pixels, int frames) {
    const glm::ivec2 low = glm::max(glm::ivec2(pixels), glm::ivec2(0));
    const glm::ivec2 high = glm::min(glm::ivec2(pixels.z, pixels.w), size_);
    if (!active() || low.x >= high.x || low.y >= high.y) return;
    const auto [found, isNew] = live_.try_emplace(name, Live{{low, high}, std::max(frames, 1), 0});
    if (isNew) return;
    glm::ivec4& all = found->second.pixels;
    all = {glm::min(glm::ivec2(all), low), glm::max(glm::ivec2(all.z, all.w), high)};
}

std::span<const glm::ivec4> Dissolve::advance() {
    const std::uint64_t count = now_.size();
    ++frame_;
    const std::uint64_t until =
        count * static_cast<std::uint64_t>(frame_) / static_cast<std::uint64_t>(frames_);
    std::ranges::fill(now_, std::uint8_t{0});
    // A step near the golden section of the whole, without a common divisor: neighbours in time are far apart
    // on the picture, and each tile has its turn.
    std::uint64_t step = std::max<std::uint64_t>(1, count * 618 / 1000);
    while (std::gcd(step, count) != 1) ++step;
    for (; replaced_ < until; ++replaced_) now_[replaced_ * step % count] = 1;

    rectangles_.clear();
    for (int y = 0; y < tiles_.y; ++y)
        for (int x = 0; x < tiles_.x;) {
            const std::uint8_t* row = now_.data() + static_cast<std::ptrdiff_t>(y) * tiles_.x;
            int end = x;
            while (end < tiles_.x && row[end] != 0) ++end;
            if (end > x)
                rectangles_.emplace_back(x * tile, y * tile, std::min(end * tile, size_.x),
                                         std::min((y + 1) * tile, size_.y));
            x = end + 1;
        }
    for (auto& [name, live] : live_) {
        live.frame = std::min(live.frame + 1, live.frames);
        addLive(live);
    }
    return rectangles_;
}

void Dissolve::addLive(const Live& live) {
    const glm::ivec4& pixels = live.pixels;
    if (live.frame >= live.frames) {
        rectangles_.push_back(pixels);
        return;
    }
    // The fractions of the golden section's multiples are scattered evenly, rows shifted against each other.
    const double until = static_cast<double>(live.frame) / live.frames;
    for (int y = pixels.y / tile; y * tile < pixels.w; ++y)
        for (int x = pixels.x / tile; x * tile < pixels.z; ++x) {
            const double turn = 0.6180339887 * x + 0.7548776662 * y;
            if (turn - std::floor(turn) >= until) continue;
            rectangles_.emplace_back(std::max(x * tile, pixels.x), std::max(y * tile, pixels.y),
                                     std::min((x + 1) * tile, pixels.z), std::min((y + 1) * tile, pixels.w));
        }
}

}  // namespace app
