#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "app/frame/Detail.h"

namespace app {

/// A detail, and what it was measured to cost and to lose.
struct Rung {
    Detail detail;
    double drawingMs = 0;     ///< frame without reflections
    double reflectionMs = 0;  ///< planning, building, uploading
    double error = 0;         ///< mean FLIP over mirroring pixels, against re-rendering drawn in full
    double pictureError = 0;  ///< mean FLIP over all others
    double jump = 0;          ///< mean FLIP of a whole picture from the rung before to this one

    double ms() const { return drawingMs + reflectionMs; }
    /// What is to be kept small: a mirroring pixel in the mean counts as one of the street.
    double loss() const { return error + pictureError; }
};

/// What vehicles cost, so that a frame with more of them is foreseen.
struct VehicleCost {
    double vehicles = 0;  ///< in view when the rungs were measured, in the mean
    double ms = 0;        ///< of drawing one more, of the smaller ones

    bool operator==(const VehicleCost&) const = default;
};

/// Rungs from the finest to the cheapest: each costs less and loses more than the one before. In between,
/// everything is blended, but for the picture's size: a picture of another size is another one everywhere, so
/// it changes at rungs alone.
class DetailLadder {
  public:
    DetailLadder() = default;
    /// Keeps the Pareto front of what was measured: a rung that costs no less than one that loses no more is
    /// left out. Rungs with numbers that are not finite too.
    explicit DetailLadder(std::vector<Rung> measured, VehicleCost vehicles = {});

    std::span<const Rung> rungs() const { return rungs_; }
    VehicleCost vehicles() const { return vehicles_; }
    bool empty() const { return rungs_.empty(); }
    /// The rung at a position 0 .. size - 1, clamped; between two of different picture sizes the nearer one.
    /// Precondition: not empty.
    Rung at(double position) const;
    double last() const { return rungs_.empty() ? 0 : static_cast<double>(rungs_.size() - 1); }
    /// Whether the picture's size changes between rung i and the next.
    bool resizes(std::size_t i) const;
    /// The stretch around a position (first and last rung) in which the picture keeps its size.
    std::pair<double, double> sameSize(double position) const;
    /// Mean FLIP of a picture from one position to another, at most: the sum of the jumps on the way.
    double jumpBetween(double a, double b) const;
    /// The cheapest position whose error is at most this; the finest where none is.
    double positionForError(double error) const;

  private:
    std::vector<Rung> rungs_;
    VehicleCost vehicles_;
};

/// One number of a detail.
enum class Knob : std::uint8_t {
    texelBudget,
    texelsPerPixel,
    errorThreshold,
    candidates,
    lookups,
    scale,
    antialiasing,
    vehicleTolerance,
    mirrorTexels,
    mirrorMaps,
    mirrorDepth,
    chromePixels,
    bouncePixels,
};
inline constexpr std::array<std::string_view, 13> knobNames{
    "texel budget", "texels a pixel", "error threshold",   "candidates",    "lookups",
    "scale",        "antialiasing",   "vehicle tolerance", "mirror texels", "mirror maps",
    "mirror depth", "chrome pixels",  "bounce pixels"};
double& valueOf(Detail& detail, Knob knob);

/// A knob turned down alone, from the finest detail, and what that was measured to save and to lose.
struct Trial {
    Knob knob = Knob::scale;
    double value = 0;
    double savedMs = 0;
    double lost = 0;
};

/// The order in which to give things up: from the finest detail on, always that next step of a knob which
/// loses least for each millisecond that it saves. Trials of one knob come from fine to coarse, and none is
/// passed over, so that what is blended in between stays near to what was measured; but what saves less than
/// `leastMs` more than the step before is not worth a rung, as noise would decide, unless it loses nothing to
/// speak of: in another view it may save more. The finest comes first. With
/// a smaller picture, which saves much at once, all else comes back, to be given up again; but not
/// antialiasing, which does little for a picture that is stretched.
std::vector<Detail> orderOfGivingUp(const Detail& finest, std::span<const Trial> trials, double leastMs);

}  // namespace app
