#include "app/frame/DetailLadder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace app {

namespace {

/// Mean FLIP that nobody sees.
constexpr double negligible = 3e-4;

double between(double a, double b, double t) {
    return a + (b - a) * t;
}

/// Where a value that goes from `a` to `b` in a step passes `x`, 0 .. 1.
double crossing(double a, double b, double x) {
    return a == b ? 0 : std::clamp((x - a) / (b - a), 0.0, 1.0);
}

}  // namespace

DetailLadder::DetailLadder(std::vector<Rung> measured, VehicleCost vehicles) : vehicles_(vehicles) {
    std::erase_if(measured, [](const Rung& rung) {
        return !std::isfinite(rung.drawingMs) || !std::isfinite(rung.reflectionMs) ||
               !std::isfinite(rung.error) || !std::isfinite(rung.pictureError) || !std::isfinite(rung.jump);
    });
    std::stable_sort(measured.begin(), measured.end(), [](const Rung& a, const Rung& b) {
        return a.loss() != b.loss() ? a.loss() < b.loss() : a.ms() < b.ms();
    });
    for (const Rung& rung : measured)
        if (rungs_.empty() || rung.ms() < rungs_.back().ms()) rungs_.push_back(rung);
}

Rung DetailLadder::at(double position) const {
    const double p = std::clamp(position, 0.0, last());
    const auto lower = static_cast<std::size_t>(p);
    if (lower + 1 >= rungs_.size()) return rungs_.back();
    const Rung &a = rungs_[lower], &b = rungs_[lower + 1];
    const double t = p - static_cast<double>(lower);
    if (resizes(lower)) return t < 0.5 ? a : b;
    return {blend(a.detail, b.detail, t),
            between(a.drawingMs, b.drawingMs, t),
            between(a.reflectionMs, b.reflectionMs, t),
            between(a.error, b.error, t),
            between(a.pictureError, b.pictureError, t),
            t * b.jump};
}

bool DetailLadder::resizes(std::size_t i) const {
    return i + 1 < rungs_.size() && rungs_[i].detail.drawing.scale != rungs_[i + 1].detail.drawing.scale;
}

std::pair<double, double> DetailLadder::sameSize(double position) const {
    if (rungs_.empty()) return {0, 0};
    const double p = std::clamp(position, 0.0, last());
    auto first = static_cast<std::size_t>(p);
    if (resizes(first) && p - static_cast<double>(first) >= 0.5) ++first;
    std::size_t end = first;
    while (first > 0 && !resizes(first - 1)) --first;
    while (end + 1 < rungs_.size() && !resizes(end)) ++end;
    return {static_cast<double>(first), static_cast<double>(end)};
}

double DetailLadder::jumpBetween(double a, double b) const {
    const double low = std::clamp(std::min(a, b), 0.0, last()),
                 high = std::clamp(std::max(a, b), 0.0, last());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < rungs_.size(); ++i) {
        const auto x = static_cast<double>(i);
        double from = std::clamp(low - x, 0.0, 1.0), to = std::clamp(high - x, 0.0, 1.0);
        if (resizes(i)) {
            from = from < 0.5 ? 0 : 1;
            to = to < 0.5 ? 0 : 1;
        }
        sum += (to - from) * rungs_[i + 1].jump;
    }
    return sum;
}

double DetailLadder::positionForError(double error) const {
    // Losses grow from rung to rung, but not each part of them: the last crossing counts.
    for (std::size_t i = rungs_.size(); i-- > 0;) {
        if (rungs_[i].error > error) continue;
        if (i + 1 == rungs_.size() || resizes(i)) return static_cast<double>(i);
        return static_cast<double>(i) + crossing(rungs_[i].error, rungs_[i + 1].error, error);
    }
    return 0;
}

double& valueOf(Detail& detail, Knob knob) {
    switch (knob) {
        case Knob::texelBudget:
            return detail.reflection.texelBudget;
        case Knob::texelsPerPixel:
            return detail.reflection.texelsPerPixel;
        case Knob::errorThreshold:
            return detail.reflection.errorThreshold;
        case Knob::candidates:
            return detail.reflection.candidates;
        case Knob::lookups:
            return detail.reflection.lookups;
        case Knob::scale:
            return detail.drawing.scale;
        case Knob::antialiasing:
            return detail.drawing.antialiasing;
        case Knob::mirrorTexels:
            return detail.mirrors.texels;
        case Knob::mirrorMaps:
            return detail.mirrors.maps;
        case Knob::mirrorDepth:
            return detail.mirrors.depth;
        case Knob::chromePixels:
            return detail.chrome.leastPixels;
        case Knob::bouncePixels:
            return detail.chrome.bouncePixels;
        case Knob::vehicleTolerance:
            break;
    }
    return detail.drawing.vehicleTolerance;
}

std::vector<Detail> orderOfGivingUp(const Detail& finest, std::span<const Trial> trials, double leastMs) {
    std::vector<Detail> order{finest};
    struct State {
        double savedMs = 0, lost = 0;
        std::size_t next = 0;  ///< first trial not yet passed
    };
    std::array<State, knobNames.size()> states{};
    while (true) {
        std::size_t best = trials.size();
        double least = std::numeric_limits<double>::infinity();
        std::array<bool, knobNames.size()> met{};
        for (std::size_t i = 0; i < trials.size(); ++i) {
            const State& state = states[static_cast<std::size_t>(trials[i].knob)];
            const double saves = trials[i].savedMs - state.savedMs;
            bool& other = met[static_cast<std::size_t>(trials[i].knob)];
            const double loses = std::max(trials[i].lost - state.lost, 0.0);
            if (i < state.next || !(saves >= leastMs || loses <= negligible) || other) continue;
            other = true;
            const double rate = loses / std::max(saves, leastMs);
            if (rate < least) {
                least = rate;
                best = i;
            }
        }
        if (best == trials.size()) return order;
        Detail next = order.back();
        valueOf(next, trials[best].knob) = trials[best].value;
        std::array<State, knobNames.size()> kept{};
        states[static_cast<std::size_t>(trials[best].knob)] = {trials[best].savedMs,
                                                               std::max(trials[best].lost, 0.0), best + 1};
        if (trials[best].knob == Knob::scale) {
            const double scale = next.drawing.scale, edges = next.drawing.antialiasing;
            next = finest;
            next.drawing.scale = scale;
            next.drawing.antialiasing = edges;
            for (const Knob knob : {Knob::scale, Knob::antialiasing})
                kept[static_cast<std::size_t>(knob)] = states[static_cast<std::size_t>(knob)];
            states = kept;
        }
        order.push_back(next);
    }
}

}  // namespace app
