#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/frame/DetailLadder.h"

namespace app {

/// What a frame took.
struct FrameCost {
    double frameMs = 0;          ///< whole frame
    double reflectionMs = 0;     ///< the reflections' share of it
    std::size_t reflecting = 0;  ///< vehicles with reflections
};

/// Holds the time of a frame at a budget by going up and down a ladder of details.
///
/// The ladder says what its rungs took at the load at which it was measured. What frames take now, over what
/// the ladder says of the detail that they had, is the load: one factor for drawing and one for reflections,
/// each the median of the last five frames, so that two slow frames in five do nothing. With these factors
/// the ladder predicts every rung, and the governor goes to where the prediction meets the budget:
///
///     predicted(p) = drawing load x drawing(p) + reflection load x reflections(p)
///
/// It stays where it is while the prediction is within a band around its aim, and moves at a limited rate
/// otherwise: down fast enough to halve a frame's time in about 0.3 s, up several times as slowly, so that
/// nothing pops and what was gained is not lost again at once. Deterministic: the same costs, the same
/// details.
class Governor {
  public:
    /// Precondition: the ladder has a rung. Budgets that are not positive are taken for a microsecond.
    Governor(DetailLadder ladder, double budgetMs);

    /// The detail for the next frame.
    Detail detail() const { return ladder_.at(position_).detail; }
    /// 0: the finest rung; ladder().rungs().size() - 1: the cheapest.
    double position() const { return position_; }

    /// What the frame drawn with `detail()` took. Costs that are not finite or not positive are left out.
    void observe(const FrameCost& cost);

    double budgetMs() const { return budget_; }
    const DetailLadder& ladder() const { return ladder_; }
    /// A frame's time at the present position and load.
    double predictedMs() const { return predictedAt(position_); }
    /// Median time of the last frames; 0 before the first.
    double actualMs() const;
    /// Error of the present position as the ladder has it.
    double predictedError() const { return ladder_.at(position_).error; }
    /// See app::givenUp.
    std::string givenUp() const;
    /// Something to tell the user, each thing once: the cheapest rung is still too dear, or the finest does
    /// not fill the budget. Nothing until it has been so for a second.
    std::optional<std::string> news();

  private:
    static constexpr std::size_t window = 5;
    struct Recent {
        std::array<double, window> values{};
        std::size_t count = 0;

        void add(double value) { values[count++ % window] = value; }
        double median(double without) const;
    };

    double predictedAt(double position) const;
    /// The finest position that takes no more than this; the last where none does.
    double positionFor(double ms) const;
    void move(double seconds);

    DetailLadder ladder_;
    double budget_;
    double position_ = 0;
    bool moving_ = true;
    Recent drawing_, reflections_, frames_;
    double tooDear_ = 0, tooCheap_ = 0;  ///< seconds for which it has been so
    bool saidTooDear_ = false, saidTooCheap_ = false;
};

}  // namespace app
