#pragma once

#include <array>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands/Options.h"
#include "app/commands/PreparedScene.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/ChromeDrawing.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "app/raytrace/RayTracer.h"
#include "app/report/Picture.h"
#include "app/report/ResultFile.h"

namespace app {

class ReflectionSource;

/// Draws close-up views of things that mirror by several methods and measures them against the truth. A
/// method is named as everywhere; "truth": many rays through each pixel; "chrome": `mem`, and chrome parts
/// near the viewer show close things themselves. While it lives its renderer knows what is close.
class CloseViews {
  public:
    CloseViews(const Scene& scene, const PreparedReflections& prepared, SceneRenderer& renderer,
               glm::ivec2 resolution, Quality quality, const ChromeDrawing& drawing = {});
    ~CloseViews();
    CloseViews(const CloseViews&) = delete;
    CloseViews& operator=(const CloseViews&) = delete;

    /// Which pixels of a traced picture (of first hits) count.
    using Counts = std::function<bool(const TracedPicture&, std::size_t pixel)>;
    /// One byte a pixel of the frame's first view.
    std::vector<unsigned char> pixelsOf(const FrameScene& frame, const Counts& counts);

    struct Drawn {
        std::string method;
        Picture picture;
        double psnr = 0, flip = 0;  ///< over the mask, against the truth
        ChromePlan plan;            ///< of chrome
        ChromeCounts counts;
    };
    /// The frame's first view by each method, maps made for this frame. The first method must be the truth.
    /// Cut short by an interrupt.
    std::vector<Drawn> draw(const FrameScene& frame, std::span<const std::string_view> methods,
                            std::span<const unsigned char> mask);

    /// Whole frames by each method, in turn, as the program draws them (maps as old as they get): times[m][k]
    /// milliseconds of method m.
    std::vector<std::vector<double>> time(const FrameScene& frame, std::span<const std::string_view> methods,
                                          std::uint32_t frames);

    /// How pictures change from one frame to the next, over pixels that count in both.
    struct Motion {
        std::string method;
        std::uint32_t frames = 0;  ///< pairs of them
        double change = 0;         ///< mean FLIP of a frame against the one before
        double flip = 0;           ///< mean FLIP of frames against the truth
        double flicker = 0;        ///< mean of reflection::flicker: change that the truth's has not
        double worst = 0;          ///< the greatest of a pair
        std::uint32_t mostJobs = 0, leastJobs = 0;  ///< of chrome
    };
    /// Draws frames 0 .. count-1 as the program does. The first method must be the truth.
    std::vector<Motion> move(const std::function<FrameScene(std::uint32_t)>& frameAt, std::uint32_t count,
                             std::span<const std::string_view> methods, const Counts& counts);

    const CloseScene& close() const { return close_; }

  private:
    std::unique_ptr<ReflectionSource> sourceOf(std::string_view method, bool everyFrame);
    Picture shown(const FrameScene& frame, std::string_view method, ReflectionSource& source, Drawn* told,
                  ChromeFades* fades = nullptr);
    void drawFrame(const FrameScene& frame, std::string_view method, ReflectionSource& source, Drawn* told,
                   ChromeFades* fades = nullptr);

    const Scene& scene_;
    const PreparedReflections& prepared_;
    SceneRenderer& renderer_;
    Quality quality_;
    ChromeDrawing drawing_;
    OffscreenTarget target_;
    RayTracer rays_;
    CloseScene close_;
};

/// What a close-up is called, and what its rows hold beside what is measured.
struct CloseUp {
    std::string name;    ///< of the rows
    std::string prefix;  ///< of its pictures' files
    const FrameScene& frame;
    std::span<const std::string_view> methods;
    CloseViews::Counts counts;
    nlohmann::ordered_json more = nlohmann::ordered_json::object();
};

/// Rows, a line of the table and a picture of each method, and one picture with mem, chrome and the truth
/// side by side, in `--out`. Nothing but a warning where no pixel counts.
void measureCloseUp(const Options& options, CloseViews& views, const CloseUp& what, ResultFile& results,
                    std::vector<std::vector<std::string>>& table);

/// The same view in motion: rows and lines of truth, mem, chrome and rerender.
void measureMotion(const Options& options, CloseViews& views, const std::string& name,
                   const std::function<FrameScene(std::uint32_t)>& frameAt, std::uint32_t count,
                   const CloseViews::Counts& counts, ResultFile& results,
                   std::vector<std::vector<std::string>>& table);

/// Pictures of one height side by side, four grey pixels between them.
Picture beside(std::span<const Picture> pictures);

}  // namespace app
