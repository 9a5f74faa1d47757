#include "app/render/StandingView.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace app {

namespace {

/// Pixels of motion below which a vehicle is left where it was while a picture dissolves: its surroundings
/// need not change.
constexpr double unnoticed = 1;
constexpr double unnoticedTurn = 0.02;  ///< radians
/// Pixels by which tiles of a vehicle may lag behind it, until all of it is of the new picture.
constexpr double lag = 8;
// Frames that this takes: what is fast by itself changes more than its detail does.
constexpr int leastFrames = 2, mostFrames = 32;
/// Frames that windows take: what they mirror may stand still for so long, but not change at once.
constexpr int windowFrames = 60;
/// Names of windows, after those of vehicles and signals.
constexpr std::uint64_t firstWindow = std::uint64_t{1} << 33;

}  // namespace

void StandingView::begin(const PassView& pass, glm::ivec2 size, const Lighting& lighting,
                         ViewTarget& target) {
    const int frames = std::exchange(frames_, 0);
    if (!drewLast(pass, size, lighting)) {
        target.endDissolving();
    } else if (frames > 1) {
        held_ = drawn_;
        target.dissolve(frames);
    }
    eye_ = pass.eye;
    clip_ = pass.clipFromRelative;
    size_ = size;
    lighting_ = lighting;
}

void StandingView::show(const PassView& pass, std::span<const vehicles::VehiclePose> poses,
                        std::span<const vehicles::SignalColour> colours,
                        const std::function<city::Aabb(const vehicles::VehiclePose&)>& boundsOf,
                        std::span<const city::Aabb> alwaysLive, ViewTarget& target) {
    if (target.dissolving()) {
        // In which those vehicles change over that are there and were there before.
        std::map<std::uint64_t, glm::dvec3> before;
        for (const vehicles::VehiclePose& was : drawn_.poses) before[was.id] = was.position;
        std::map<std::uint64_t, int> frames;
        for (const vehicles::VehiclePose& is : poses)
            if (const auto was = before.find(is.id); was != before.end()) {
                const double far = std::max(glm::distance(is.position, pass.eye), 1e-3);
                const double moved = glm::distance(was->second, is.position) * pass.pixelsPerRadian / far;
                int& most = frames.try_emplace(is.id, mostFrames).first->second;
                most = std::clamp(static_cast<int>(lag / std::max(moved, 1e-3)), leastFrames, most);
            }
        const auto keepLiveWithin = [&](int most, std::uint64_t name, const city::Aabb& box) {
            if (const auto pixels = pixelsOf(box, pass.eye, pass.clipFromRelative, size_))
                target.keepLive(name, *pixels, most);
        };
        const auto keepLive = [&](std::uint64_t name, const city::Aabb& box) {
            const auto found = frames.find(name);
            keepLiveWithin(found == frames.end() ? 1 : found->second, name, box);
        };
        findChanges(
            held_, poses, colours, heads_, lighting_.sunDirection, boundsOf,
            [&](const vehicles::VehiclePose& was, const vehicles::VehiclePose& is) {
                const double far = glm::distance(is.position, pass.eye);
                return glm::distance(was.position, is.position) * pass.pixelsPerRadian > unnoticed * far ||
                       std::abs(was.heading - is.heading) > unnoticedTurn || was.braking != is.braking;
            },
            keepLive);
        for (std::size_t i = 0; i < alwaysLive.size(); ++i)
            keepLiveWithin(windowFrames, firstWindow + i, alwaysLive[i]);
    }
    drawn_.poses.assign(poses.begin(), poses.end());
    drawn_.colours.assign(colours.begin(), colours.end());
}

}  // namespace app
