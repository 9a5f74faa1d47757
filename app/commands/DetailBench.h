#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "app/commands/CityMirrors.h"
#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/DetailLadder.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

struct CloseScene;

/// Draws details over clips of traffic, interleaved frame by frame, times them and compares them with
/// re-rendering every car, drawn in full.
class DetailBench {
  public:
    using Clip = std::vector<FrameScene>;
    /// Frames of a clip in which maps settle, and those that are timed.
    static constexpr std::size_t framesBefore = 2, framesMeasured = 4;

    struct Measured {
        Rung rung;                     ///< without its jump
        std::vector<Image8> pictures;  ///< of the last frame of each clip
    };

    /// Keeps references to everything. Each clip has framesBefore + framesMeasured frames.
    /// `mirrors`: what windows and wet streets show; may be null. `close`: what chrome shows of close things,
    /// which the renderer has; may be null.
    DetailBench(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                const ReflectionSettings& settings, std::span<const Clip> clips,
                CityMirrors* mirrors = nullptr, const CloseScene* close = nullptr, int chromeBounces = 1);

    /// Units of work of a call of `measure`, for `goOn`, which is called after each and
    /// ends all by false.
    static std::size_t steps(std::size_t clips, std::size_t details) {
        return clips * (framesBefore + framesMeasured) + details;
    }
    /// What details take and lose; empty where ended early. While the fastest times scatter more than
    /// `steadyWithin` (shares), frames are drawn again, up to `mostRounds` times; `scatter` says what
    /// remained.
    std::vector<Measured> measure(std::span<const Detail> details, const std::function<bool()>& goOn);
    /// Mean FLIP from a picture of the one to that of the other, of the last clip.
    double jump(const Measured& from, const Measured& to) const;
    /// What one vehicle more costs, a small one, drawn in full, without reflections.
    VehicleCost vehicleCost();

    /// Of the last `measure`: by how much the second fastest time of a detail is above the fastest, in the
    /// middle of all details. On an idle machine 0.01 to 0.03.
    double scatter() const { return scatter_; }
    static constexpr double steadyWithin = 0.04;
    static constexpr int mostRounds = 2;

  private:
    struct Part {
        glm::ivec2 corner{0}, size{0};
    };
    struct Truth {
        reflection::FlipImage whole, mirrors;
        std::vector<unsigned char> mask;  ///< of the whole picture: mirrors
        Part part;                        ///< that holds them all, with as much around as FLIP reaches
    };

    /// Milliseconds of drawing and of reflecting. Without an engine, nothing reflects.
    std::pair<double, double> draw(const FrameScene& frame, ReflectionEngine* engine, const Detail& detail);
    void compare(Measured& measured) const;
    Part partOf(const std::vector<unsigned char>& mask) const;
    template <typename T>
    std::vector<T> cut(const std::vector<T>& picture, const Part& part) const;

    const Scene& scene_;
    const PreparedReflections& prepared_;
    SceneRenderer& renderer_;
    ReflectionSettings settings_;
    CityMirrors* mirrors_;
    const CloseScene* close_;
    int chromeBounces_;
    Detail full_;  ///< what is measured against
    std::span<const Clip> clips_;
    OffscreenTarget target_;
    std::vector<Truth> truths_;
    double scatter_ = 0;
};

}  // namespace app
