#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/frame/DetailLadder.h"

namespace app {

/// What is known of a frame before it is drawn.
struct FrameOutlook {
    std::size_t reflecting = 0;  ///< vehicles with reflections: those in view
    /// The view and the light are those of the frame before: what changes is seen.
    bool still = false;
};

/// What a frame took.
struct FrameCost {
    double frameMs = 0;          ///< whole frame
    double reflectionMs = 0;     ///< the reflections' share of it
    std::size_t reflecting = 0;  ///< vehicles with reflections
    std::uint64_t texels = 0;    ///< of maps that were built
};

/// Holds the time of a frame at a budget by going up and down a ladder of details.
///
/// The ladder says what its rungs took at the load at which it was measured, and what a vehicle more costs.
/// What frames take now, over what the ladder says of the detail and the vehicles that they had, is the load:
/// one factor for drawing and one for reflections, each the median of the last frames, so that three slow
/// frames in seven do nothing. With these factors the ladder predicts every rung for the coming frame's
/// vehicles:
///
///     predicted(p) = drawing load x drawing(p) x (1 + vehicles more x a vehicle's) + reflection load x
///                    reflections(p)
///
/// In another view than that in which the ladder was measured, a smaller picture saves more or less: when the
/// picture's size has changed, the difference between what came and what was predicted is kept for that size.
///
/// Two ways of moving:
/// - A prediction that is well above the budget, at once, or well below it, for some time, makes the governor
///   go to where it meets its aim in one step. In a view that stands that would be seen: `dissolveFrames`
///   says over how many frames the picture is to change over, part by part; the time of a frame changes at
///   once.
/// - Nearer to the budget it creeps, by less than is seen in a frame, and never to another size of the
///   picture.
/// Sizes of maps, the shift that they may have and levels of vehicles follow in a view that stands at a rate:
/// vehicles differ in size, so each changes in another frame.
///
/// Deterministic: the same outlooks and costs, the same details.
class Governor {
  public:
    /// Precondition: the ladder has a rung. Budgets that are not positive are taken for a microsecond.
    Governor(DetailLadder ladder, double budgetMs);

    /// Chooses the detail of the coming frame.
    void expect(const FrameOutlook& outlook);
    /// What was chosen: the ladder's, with no more texels of maps than a share of the budget pays for.
    Detail detail() const;
    /// 0: the finest rung; ladder().rungs().size() - 1: the cheapest.
    double position() const { return position_; }
    /// Frames over which a picture of the detail before is to go over into one of this detail, as chosen for
    /// the coming frame; 0: there is nothing to be seen.
    int dissolveFrames() const { return dissolveFrames_; }

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
    static constexpr std::size_t window = 7;
    struct Recent {
        std::array<double, window> values{};
        std::size_t count = 0;

        void add(double value) { values[count++ % window] = value; }
        double median(double without) const;
    };

    /// Of drawing, as measured, with other vehicles.
    double drawingMs(const Rung& rung, double vehicles) const;
    /// See bends_.
    double bendAt(double position) const;
    double predictedAt(double position) const;
    /// What drawing took, over what the ladder says.
    void learn(double drawing);
    void forgetBends(double seconds);
    /// The finest position that takes no more than this, at which one may rest; the last where none does.
    /// Between two sizes of the picture the finer one's end does where it takes no more than `atEnds`.
    double positionFor(double ms, double atEnds) const;
    void stepTo(double position, bool still);
    void creep(bool still);
    void decide(bool still, bool sudden);
    /// Reflections in windows that come or go dissolve, whatever the ladder says of them.
    void dissolveMirrors(const MirrorDetail& before);
    /// Numbers of the coming detail that follow at a rate. `noticed`: in a view that stands, where nothing
    /// else changes much.
    void follow(bool noticed);

    DetailLadder ladder_;
    double budget_;
    double position_ = 0;
    double vehicles_ = 0;  ///< of the coming frame
    Recent drawing_, reflections_, frames_;
    Recent perTexel_;  ///< milliseconds
    /// Where the picture's size changed: drawing of the frames since, until the window is full.
    Recent resized_;
    /// By the first rung of a picture's size: the load there over that at the other sizes. In another view
    /// than the ladder's, a smaller picture saves another share.
    std::vector<double> bends_;
    std::size_t framesSeen_ = 0;
    int dissolveFrames_ = 0;
    std::optional<Detail> followed_;
    int sinceStep_ = 1 << 20;  ///< frames
    int dissolving_ = 0;       ///< frames left
    double seconds_ = 0;       ///< since the start, in frames
    double sinceRoom_ = 0;     ///< seconds for which there has been room for more
    double patience_ = 0;      ///< seconds for which there has to be
    double lastStepUp_ = -60;  ///< when, in `seconds_`
    double calmSince_ = 0;
    double tooDear_ = 0, tooCheap_ = 0;  ///< seconds for which it has been so
    bool saidTooDear_ = false, saidTooCheap_ = false;
};

}  // namespace app
