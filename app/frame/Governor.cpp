#include "app/frame/Governor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace app {

namespace {

// Shares of the budget. Aimed below it, since frames scatter upwards: where one in twenty takes a quarter
// more than the median, it is still within a quarter of the budget.
constexpr double aimed = 0.96;
// Within these nothing moves.
constexpr double bandBelow = 0.92;
constexpr double bandAbove = 1.0;
// Beyond these it goes in one step.
constexpr double muchRoom = 0.9;
constexpr double tooMuch = 1.08;
/// Where the next detail would be a smaller picture, this much is let stand.
constexpr double beforeResizing = 1.05;
// Mean FLIP of a picture from frame to frame that is let happen: in a view that stands, a quarter of what far
// traffic in a street does (0.0002, measured); else much less than what moving by a pixel does.
constexpr double unseen = 0.00004;
constexpr double unseenMoving = 0.003;
constexpr int longestDissolve = 1200;
/// Frames over which windows' reflections come or go, at least: how much of a picture they are differs from
/// view to view (mean FLIP 0.0003 where a ladder was measured, 0.012 along a front of shops), and what a
/// sixtieth of the latter changes is less than traffic does.
constexpr int leastMirrorDissolve = 60;
/// Before the picture is made smaller, all else is given up and looked at, unless even so it would take more
/// than this.
constexpr double worthTrying = 1.15;
constexpr double farTooMuch = 1.5;
/// By how much numbers that follow may change in a frame, as a ratio: fourfold takes a second.
constexpr double followed = 1.03;
/// Frames from one step to the next, at least: so many tell what the last one brought.
constexpr int framesBetweenSteps = 8;
// Seconds of room for more before it is taken, at first and at most: doubled each time that it was taken
// back within `regret` seconds, halved after so many quiet ones.
constexpr double patienceAtFirst = 0.3;
constexpr double patienceAtMost = 8;
constexpr double regret = 3;
constexpr double quietSeconds = 20;
/// The first frames make what later ones find, and tell nothing; nothing moves before so many more.
constexpr std::size_t framesIgnored = 2, framesKnown = 3;
/// Vehicles that come or go at once and change the prediction by so much (a share of the budget) are no
/// noise: what they ask for is done at once.
constexpr double foreseen = 0.08;
/// Seconds in which what was learned of a picture's size is half forgotten elsewhere: it is tried again.
constexpr double bendHalfLife = 4;
/// Share of the budget that maps may take in a frame, whatever the ladder says: what it says holds for the
/// vehicles that were there, and maps that come due together are no worse for being built one after the
/// other.
constexpr double shareOfMaps = 0.1;
constexpr double leastTexels = 10e3;
/// Longest frame that counts as time: after a stall nothing jumps.
constexpr double longestStep = 0.05;
/// By how much a smaller picture may take more or less than the ladder makes of a larger one.
constexpr double mostBend = 2;
constexpr double leastLoad = 1e-6;
/// Least share of a rung's drawing that remains without vehicles.
constexpr double leastDrawing = 0.3;
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
    : ladder_(std::move(ladder)),
      budget_(std::max(budgetMs, leastBudgetMs)),
      vehicles_(ladder_.vehicles().vehicles),
      bends_(ladder_.rungs().size(), 1.0),
      patience_(patienceAtFirst) {
    resized_.count = window;  // not
    position_ = positionFor(aimed * budget_, aimed * budget_);
}

double Governor::actualMs() const {
    return frames_.median(0);
}

double Governor::drawingMs(const Rung& rung, double vehicles) const {
    // What a vehicle costs was measured with the finest detail; it falls as all does.
    const VehicleCost& more = ladder_.vehicles();
    const double finest = std::max(ladder_.rungs().front().drawingMs, leastBudgetMs);
    return rung.drawingMs * std::max(1 + (vehicles - more.vehicles) * more.ms / finest, leastDrawing);
}

double Governor::bendAt(double position) const {
    return bends_[static_cast<std::size_t>(ladder_.sameSize(position).first)];
}

double Governor::predictedAt(double position) const {
    const Rung rung = ladder_.at(position);
    const double reflecting = vehicles_ > 0 ? std::max(rung.reflectionMs, leastReflectionMs) : 0;
    return drawing_.median(1) * bendAt(position) * drawingMs(rung, vehicles_) +
           reflections_.median(1) * reflecting;
}

double Governor::positionFor(double ms, double atEnds) const {
    // Under another load than the measured one the prediction need not fall everywhere: the first position
    // from the fine end.
    double before = predictedAt(0);
    if (before <= ms) return 0;
    for (std::size_t i = 1; i < ladder_.rungs().size(); ++i) {
        const double here = predictedAt(static_cast<double>(i));
        if (ladder_.resizes(i - 1)) {
            if (before <= atEnds) return static_cast<double>(i - 1);
            if (here <= ms) return static_cast<double>(i);
        } else if (here <= ms) {
            return static_cast<double>(i) - (ms - here) / (before - here);
        }
        before = here;
    }
    return ladder_.last();
}

void Governor::observe(const FrameCost& cost) {
    if (!std::isfinite(cost.frameMs) || !(cost.frameMs > 0) || !std::isfinite(cost.reflectionMs)) return;
    if (++framesSeen_ <= framesIgnored) return;
    const Rung rung = ladder_.at(position_);
    const double reflecting = std::clamp(cost.reflectionMs, 0.0, cost.frameMs);
    learn((cost.frameMs - reflecting) /
          std::max(drawingMs(rung, static_cast<double>(cost.reflecting)), leastBudgetMs));
    // With nothing to reflect, frames say nothing of the reflections' cost.
    if (cost.reflecting > 0) reflections_.add(reflecting / std::max(rung.reflectionMs, leastReflectionMs));
    forgetBends(std::min(cost.frameMs / 1000, longestStep));
    if (cost.texels > 0) perTexel_.add(reflecting / static_cast<double>(cost.texels));
    frames_.add(cost.frameMs);
    vehicles_ = static_cast<double>(cost.reflecting);
    const double seconds = std::min(cost.frameMs / 1000, longestStep);
    seconds_ += seconds;
    sinceRoom_ = predictedMs() < muchRoom * budget_ ? sinceRoom_ + seconds : 0;
    tooDear_ = position_ >= ladder_.last() && predictedMs() > tooMuch * budget_ ? tooDear_ + seconds : 0;
    tooCheap_ = position_ <= 0 && predictedMs() < bandBelow * budget_ ? tooCheap_ + seconds : 0;
}

void Governor::forgetBends(double seconds) {
    const auto here = static_cast<std::size_t>(ladder_.sameSize(position_).first);
    const double kept = std::exp2(-seconds / bendHalfLife);
    for (std::size_t i = 0; i < bends_.size(); ++i)
        if (i != here) bends_[i] = bends_[here] * std::pow(bends_[i] / bends_[here], kept);
}

void Governor::learn(double drawing) {
    double& bend = bends_[static_cast<std::size_t>(ladder_.sameSize(position_).first)];
    if (resized_.count < window) {
        resized_.add(drawing);
        if (resized_.count < window) return;
        // The load is taken for what it was.
        bend =
            std::clamp(resized_.median(1) / std::max(drawing_.median(1), leastLoad), 1 / mostBend, mostBend);
        drawing_ = {};
        for (const double value : resized_.values) drawing_.add(value / bend);
    } else {
        drawing_.add(drawing / bend);
    }
}

void Governor::expect(const FrameOutlook& outlook) {
    const double before = predictedMs();
    vehicles_ = static_cast<double>(outlook.reflecting);
    const bool sudden = std::abs(predictedMs() - before) > foreseen * budget_;
    dissolveFrames_ = 0;
    const MirrorDetail mirrors = ladder_.at(position_).detail.mirrors;
    decide(outlook.still, sudden);
    if (outlook.still) dissolveMirrors(mirrors);
    follow(outlook.still && !sudden);
}

void Governor::decide(bool still, bool sudden) {
    dissolving_ = still ? std::max(dissolving_ - 1, 0) : 0;
    const double aim = aimed * budget_;
    if (frames_.count == 0) position_ = positionFor(aim, beforeResizing * budget_);
    if (frames_.count < framesKnown) return;
    const double now = predictedMs();
    if (++sinceStep_ < framesBetweenSteps && !sudden) return;
    if (now > tooMuch * budget_) {
        if (seconds_ < lastStepUp_ + regret) {
            patience_ = std::min(2 * patience_, patienceAtMost);
            lastStepUp_ = -regret;
            calmSince_ = seconds_;
        }
        double wanted = positionFor(aim, beforeResizing * budget_);
        const double end = ladder_.sameSize(position_).second;
        if (wanted > end && position_ < end && predictedAt(end) <= worthTrying * budget_) wanted = end;
        // One size at a time, as the next may save more than was measured elsewhere.
        const double next = ladder_.sameSize(std::min(end + 1, ladder_.last())).second;
        if (wanted > next && predictedAt(next) <= farTooMuch * budget_) wanted = next;
        stepTo(wanted, still);
    } else if (sinceRoom_ >= patience_ || (sudden && now < muchRoom * budget_)) {
        const double wanted = positionFor(aim, budget_);
        if (wanted < position_) {
            stepTo(wanted, still);
            lastStepUp_ = seconds_;
        }
        sinceRoom_ = 0;
    } else if (dissolving_ == 0) {
        creep(still);
    }
    if (seconds_ > calmSince_ + quietSeconds) {
        patience_ = std::max(patience_ / 2, patienceAtFirst);
        calmSince_ = seconds_;
    }
}

void Governor::dissolveMirrors(const MirrorDetail& before) {
    if (ladder_.at(position_).detail.mirrors.drawsAsMany(before)) return;
    dissolveFrames_ = dissolving_ = std::max({dissolveFrames_, dissolving_, leastMirrorDissolve});
}

void Governor::follow(bool noticed) {
    const Detail wanted = ladder_.at(position_).detail;
    if (!followed_ || !noticed) {
        followed_ = wanted;
        return;
    }
    const auto near = [](double before, double now) {
        return before > 0 ? std::clamp(now, before / followed, before * followed) : now;
    };
    const Detail before = *followed_;
    followed_ = wanted;
    ReflectionDetail& maps = followed_->reflection;
    maps.texelsPerPixel = near(before.reflection.texelsPerPixel, maps.texelsPerPixel);
    maps.errorThreshold = near(before.reflection.errorThreshold, maps.errorThreshold);
    double& levels = followed_->drawing.vehicleTolerance;
    levels = near(before.drawing.vehicleTolerance, levels);
}

void Governor::stepTo(double position, bool still) {
    const double jump = ladder_.jumpBetween(position_, position);
    if (ladder_.sameSize(position_) != ladder_.sameSize(position)) resized_ = {};
    position_ = position;
    sinceRoom_ = 0;
    sinceStep_ = 0;
    if (!still) return;
    // What is going on already has to be seen to its end as well.
    const double frames = std::min(jump / unseen + dissolving_, static_cast<double>(longestDissolve));
    dissolveFrames_ = dissolving_ = static_cast<int>(std::ceil(frames));
}

void Governor::creep(bool still) {
    const double now = predictedMs();
    if (now <= bandAbove * budget_ && now >= bandBelow * budget_) return;
    const auto [first, last] = ladder_.sameSize(position_);
    const double wanted = std::clamp(positionFor(aimed * budget_, aimed * budget_), first, last);
    const double seen = ladder_.jumpBetween(position_, wanted);
    const double let = still ? unseen : unseenMoving;
    // As far as is let happen: jumps grow along the way, so halving the interval finds the place.
    if (!(seen > let)) {
        position_ = wanted;
        return;
    }
    double near = position_, far = wanted;
    for (int i = 0; i < 24; ++i) {
        const double middle = 0.5 * (near + far);
        (ladder_.jumpBetween(position_, middle) > let ? far : near) = middle;
    }
    position_ = near;
}

Detail Governor::detail() const {
    Detail detail = followed_ ? *followed_ : ladder_.at(position_).detail;
    const double perTexel = perTexel_.median(0);
    if (perTexel > 0) {
        const double texels = shareOfMaps * budget_ / perTexel;
        detail.reflection.texelBudget =
            std::min(detail.reflection.texelBudget, std::max(texels, leastTexels));
    }
    return detail;
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
