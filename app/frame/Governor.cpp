#include "app/frame/Governor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace app {

namespace {

// Shares of the budget: aimed a little below it, since frames scatter upwards; let stand from 8% below the
// budget to 1% above.
constexpr double aimed = 0.97;
constexpr double bandBelow = 0.92;
constexpr double bandAbove = 1.01;
// Change of the predicted time in a second at most, as a logarithm: halved in 0.28 s, doubled in 1.2 s.
constexpr double fastestDown = 2.5;
constexpr double fastestUp = 0.6;
/// Longest frame that counts as time in which to move: after a stall nothing jumps.
constexpr double longestStep = 0.05;
/// For a reflection's load, milliseconds: below this the share of planning alone would decide.
constexpr double leastReflectionMs = 0.05;
constexpr double secondsBeforeNews = 1;
constexpr double leastBudgetMs = 1e-3;

std::string milliseconds(double ms) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f ms", ms);
    return text;
}

}  // namespace

double Governor::Recent::median(double without) const {
    const std::size_t n = std::min(count, window);
    if (n == 0) return without;
    std::array<double, window> sorted = values;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((n - 1) / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(n));
    return *middle;
}

Governor::Governor(DetailLadder ladder, double budgetMs)
    : ladder_(std::move(ladder)), budget_(std::max(budgetMs, leastBudgetMs)) {
    position_ = positionFor(aimed * budget_);
}

double Governor::actualMs() const {
    return frames_.median(0);
}

double Governor::predictedAt(double position) const {
    const Rung rung = ladder_.at(position);
    return drawing_.median(1) * rung.drawingMs +
           reflections_.median(1) * std::max(rung.reflectionMs, leastReflectionMs);
}

double Governor::positionFor(double ms) const {
    // Under another load than the measured one the prediction need not fall everywhere: the first position
    // from the fine end.
    double before = predictedAt(0);
    if (before <= ms) return 0;
    for (std::size_t i = 1; i < ladder_.rungs().size(); ++i) {
        const double here = predictedAt(static_cast<double>(i));
        if (here <= ms) return static_cast<double>(i) - (ms - here) / (before - here);
        before = here;
    }
    return ladder_.last();
}

void Governor::observe(const FrameCost& cost) {
    if (!std::isfinite(cost.frameMs) || !(cost.frameMs > 0) || !std::isfinite(cost.reflectionMs)) return;
    const Rung rung = ladder_.at(position_);
    const double reflecting = std::clamp(cost.reflectionMs, 0.0, cost.frameMs);
    drawing_.add((cost.frameMs - reflecting) / std::max(rung.drawingMs, leastBudgetMs));
    // With nothing to reflect, frames say nothing of the reflections' cost, and there is none.
    reflections_.add(cost.reflecting == 0 ? 0 : reflecting / std::max(rung.reflectionMs, leastReflectionMs));
    frames_.add(cost.frameMs);
    const double seconds = std::min(cost.frameMs / 1000, longestStep);
    move(seconds);
    tooDear_ = position_ >= ladder_.last() && predictedMs() > bandAbove * budget_ ? tooDear_ + seconds : 0;
    tooCheap_ = position_ <= 0 && predictedMs() < bandBelow * budget_ ? tooCheap_ + seconds : 0;
}

void Governor::move(double seconds) {
    const double now = predictedMs();
    if (now > bandAbove * budget_ || now < bandBelow * budget_) moving_ = true;
    if (!moving_) return;
    const double wanted = positionFor(aimed * budget_);
    const bool down = wanted > position_;
    // As far towards it as the rate allows: the prediction between two rungs is straight, so halving the
    // interval finds the place.
    const double limit = now * std::exp(seconds * (down ? -fastestDown : fastestUp));
    double reached = wanted;
    const auto tooFar = [&](double position) {
        return down ? predictedAt(position) < limit : predictedAt(position) > limit;
    };
    if (tooFar(wanted)) {
        double near = position_, far = wanted;
        for (int i = 0; i < 24; ++i) (tooFar(0.5 * (near + far)) ? far : near) = 0.5 * (near + far);
        reached = near;
    }
    position_ = std::clamp(reached, 0.0, ladder_.last());
    if (position_ == wanted) moving_ = false;
}

std::string Governor::givenUp() const {
    return app::givenUp(ladder_.rungs().front().detail, detail());
}

std::optional<std::string> Governor::news() {
    if (tooDear_ >= secondsBeforeNews && !saidTooDear_) {
        saidTooDear_ = true;
        return "even the lowest settings take " + milliseconds(actualMs()) +
               " a frame, more than the budget of " + milliseconds(budget_);
    }
    if (tooCheap_ >= secondsBeforeNews && !saidTooCheap_) {
        saidTooCheap_ = true;
        return "the highest settings take " + milliseconds(actualMs()) + " a frame: the budget of " +
               milliseconds(budget_) + " is not filled";
    }
    return std::nullopt;
}

}  // namespace app
