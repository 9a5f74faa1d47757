#include "app/frame/DetailLadder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace app {

namespace {

double between(double a, double b, double t) {
    return a + (b - a) * t;
}

/// Where a value that goes from `a` to `b` in a step passes `x`, 0 .. 1.
double crossing(double a, double b, double x) {
    return a == b ? 0 : std::clamp((x - a) / (b - a), 0.0, 1.0);
}

}  // namespace

DetailLadder::DetailLadder(std::vector<Rung> measured) {
    std::erase_if(measured, [](const Rung& rung) {
        return !std::isfinite(rung.drawingMs) || !std::isfinite(rung.reflectionMs) ||
               !std::isfinite(rung.error) || !std::isfinite(rung.pictureError);
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
    return {blend(a.detail, b.detail, t), between(a.drawingMs, b.drawingMs, t),
            between(a.reflectionMs, b.reflectionMs, t), between(a.error, b.error, t),
            between(a.pictureError, b.pictureError, t)};
}

double DetailLadder::positionForError(double error) const {
    // Losses grow from rung to rung, but not each part of them: the last crossing counts.
    for (std::size_t i = rungs_.size(); i-- > 0;) {
        if (rungs_[i].error > error) continue;
        if (i + 1 == rungs_.size()) return static_cast<double>(i);
        return static_cast<double>(i) + crossing(rungs_[i].error, rungs_[i + 1].error, error);
    }
    return 0;
}

double DetailLadder::positionForMs(double ms) const {
    for (std::size_t i = 0; i < rungs_.size(); ++i) {
        if (rungs_[i].ms() > ms) continue;
        if (i == 0) return 0;
        return static_cast<double>(i - 1) + crossing(rungs_[i - 1].ms(), rungs_[i].ms(), ms);
    }
    return last();
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
            if (i < state.next || !(saves >= leastMs) || other) continue;
            other = true;
            const double rate = std::max(trials[i].lost - state.lost, 0.0) / saves;
            if (rate < least) {
                least = rate;
                best = i;
            }
        }
        if (best == trials.size()) return order;
        Detail next = order.back();
        valueOf(next, trials[best].knob) = trials[best].value;
        order.push_back(next);
        states[static_cast<std::size_t>(trials[best].knob)] = {trials[best].savedMs,
                                                               std::max(trials[best].lost, 0.0), best + 1};
    }
}

}  // namespace app
