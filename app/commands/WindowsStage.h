#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/commands/CarsStage.h"
#include "app/commands/PreparedReflections.h"
#include "app/compare/CompareRow.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/MirrorPlan.h"
#include "app/frame/ReflectionEngine.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "app/report/Progress.h"
#include "reflection/truth/ImageError.h"

namespace app {

/// One way of drawing a city's windows.
struct WindowsCase {
    std::string name;
    bool glass = true;  ///< panes are drawn; false: as they are painted
    MirrorSettings settings;
    std::uint32_t frames = 12;  ///< measured
};

/// A case with what it keeps from frame to frame, and what was measured.
struct WindowsRun {
    WindowsCase what;
    std::unique_ptr<ReflectionEngine> engine;
    std::vector<double> ms, ratio;  ///< of frames; to the first case's frame
    MirrorCounters planned;
    RenderCounters drawn;
    std::vector<double> awayMs, awayRatio;  ///< no window in view
    std::uint32_t awayPasses = 0;
    std::uint64_t awayBytes = 0;

    /// Errors on the pixels that show glass, and on those of wet ground, but for outlines.
    struct Errors {
        double psnr = PictureErrors::unknown, flip = PictureErrors::unknown;
        double waterPsnr = PictureErrors::unknown, waterFlip = PictureErrors::unknown;
        double psnrToBefore = 0;  ///< of all pixels, to the case before
    };
};

/// What one case is beside the truth of a view.
struct WindowsPicture {
    WindowsRun::Errors errors;
    Image8 seen;  ///< antialiased, for people; empty where not asked for
};

/// The view's truth, and which pixels count.
struct WindowsTruth {
    std::vector<glm::vec3> display;
    std::vector<unsigned char> glass, water;
};

/// Measures cases interleaved on the same frames of the same traffic, and compares them with ray traced
/// pictures. The first case is what the others are measured by.
class WindowsStage {
  public:
    /// Frames before the measured ones: shaders are compiled, local maps made.
    static constexpr std::uint32_t framesBefore = 3;

    WindowsStage(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
                 glm::ivec2 resolution, const std::vector<WindowsCase>& cases,
                 const ReflectionSettings& reflections = {});

    /// All cases in turn on `frames` frames, those with less on the first of them; ends at an interrupt.
    void measure(CarsStage& set, std::uint32_t frames, Progress& progress);
    /// The same looking up at the sky, for the case of that name beside the first.
    void measureAway(const CarsStage& set, const std::string& name, std::uint32_t frames);

    WindowsTruth truthOf(const FrameScene& frame, bool wet = false);
    /// `truthFor`: the dry or the wet one; null: no errors. `wanted`: of which cases a picture is to be kept;
    /// `done` gets each case in turn.
    void compare(const FrameScene& frame,
                 const std::function<const WindowsTruth*(const WindowsRun&)>& truthFor,
                 const std::function<bool(const WindowsRun&)>& wanted,
                 const std::function<void(WindowsRun&, WindowsPicture&&)>& done);

    std::vector<WindowsRun>& runs() { return runs_; }
    glm::ivec2 resolution() const { return target_.size(); }
    FrameScene frameOf(const CarsStage& set) const;
    /// A case's picture of a frame after it was drawn so many times, at least once.
    Image8 picture(WindowsRun& run, const FrameScene& frame, int times);

  private:
    double draw(WindowsRun& run, const FrameScene& frame);
    MirrorPlan planOf(const WindowsCase& what, const FrameScene& frame) const;
    std::vector<SeenVehicle> seenBy(const FrameScene& frame, const PlanarReflections& planar) const;

    const Scene& scene_;
    SceneRenderer& renderer_;
    MirrorPlanner planner_;
    OffscreenTarget target_;
    std::vector<WindowsRun> runs_;
};

}  // namespace app
