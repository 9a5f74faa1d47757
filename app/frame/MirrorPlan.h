#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/frame/Detail.h"
#include "app/frame/View.h"
#include "app/frame/WetGround.h"
#include "city/model/GlassFronts.h"
#include "reflection/planar/ReflectionTree.h"

namespace app {

/// How a city's flat mirrors are drawn.
struct MirrorSettings {
    bool on = true;
    int depth = 2;           ///< mirrors in a row, 0 (none) to 8
    std::uint32_t maps = 8;  ///< reflections drawn a frame and view at most, the least visible left out
    double reach = 220;      ///< metres from the eye beyond which glass is drawn without a map
    double leastPixels =
        250;  ///< of its glass, seen from the eye, below which a front is drawn without a map
    /// The same of rough glass and stone. Those known to other mirrors alone are always drawn without.
    double leastRoughPixels = 3000;
    std::uint32_t mostFronts = 48;  ///< given to the tree: the most visible of those that are near
    double texels = 1;              ///< of a reflection's side a pixel
    double levelScale = 0.5;        ///< texels a pixel for each further mirror in a row
    double fade = 0;  ///< metres behind a mirror on which what it shows fades to 1/e; 0: it does not
    reflection::Economies economies;
    /// World z of the road after rain, see roadHeightNear: one level mirror for all wet ground. Nothing: dry.
    std::optional<double> wetRoad = std::nullopt;

    bool operator==(const MirrorSettings& b) const {
        return on == b.on && depth == b.depth && maps == b.maps && texels == b.texels && fade == b.fade;
    }

    /// No more than a detail allows.
    void limit(const Detail& detail);
};

/// What was planned and what was left out.
struct MirrorCounters {
    std::uint32_t inCity = 0;   ///< fronts
    std::uint32_t inReach = 0;  ///< within `reach`
    std::uint32_t inView = 0;   ///< of these, seen from the front and large enough, before occlusion
    std::uint32_t shown = 0;    ///< fronts that some map serves
    std::uint32_t windows = 0;  ///< their panes
    std::uint32_t rough = 0;    ///< of those fronts: polished stone and frosted glass
    bool road = false;          ///< the wet road mirrors
    std::uint32_t passes = 0;   ///< reflections drawn
    std::uint32_t levels = 0;   ///< maps kept: one for each mirror in a row
    std::uint64_t texels = 0;   ///< drawn
    std::uint32_t shared = 0, occluded = 0, backFacing = 0, offScreen = 0, belowCutOff = 0, overCap = 0;
    double milliseconds = 0;  ///< of planning
};

/// Texels of what wet ground mirrors for each pixel: films blur it over tens of pixels, ripples shake it in
/// puddles.
inline constexpr double wetTexels = 0.5;
/// Share of the light below which reflections in a row with wet ground among them are left out: a wet road in
/// a shop window is 0.024. Where it is left out, ground is wet without an image.
inline constexpr double wetCutOff = 0.03;

/// Pixels times the share of their light below which a reflection is left out: what the smallest window has
/// that mirrors, or one of 3,100 pixels in a window.
inline constexpr double leastLight = 20;
/// Texels of what polished stone and frosted glass mirror for each pixel: they blur over ten pixels and more
/// what is not just before them.
inline constexpr double roughTexels = 1.0 / 6;
/// With them in view: a shop window in frosted glass is 0.0048, and blurred.
inline constexpr double roughCutOff = 0.0049;

/// What the flat mirrors of one frame need: plain data.
struct MirrorPlan {
    /// In `fronts`: the wet road.
    static constexpr std::uint32_t road = 0xffffffffu;

    reflection::ReflectionTree tree;    ///< roots: the frame's views
    std::vector<std::uint32_t> fronts;  ///< of each mirror of the tree: index of its GlassFront
    MirrorCounters counters;
    double fade = 0;  ///< of the settings
    bool empty() const { return tree.empty(); }
};

/// The reflection module's idea of a view.
reflection::EyeView eyeViewOf(const View& view);

/// Decides which of a city's windows mirror in a frame. Deterministic; no graphics API.
class MirrorPlanner {
  public:
    /// The fronts are read, not kept, but for what planning needs of them.
    explicit MirrorPlanner(std::span<const city::GlassFront> fronts);

    /// Whether a box is surely hidden from an eye; `glass`: the mirror through which it looks, null before
    /// all mirrors.
    using Hidden = std::function<bool(const reflection::EyeView& from, const reflection::HalfSpace* glass,
                                      const city::Aabb& box)>;

    /// An empty tree where no window is in view, or none is to mirror. `maps` counts for all views together.
    /// Cost: fronts of the city; besides, reflections times `mostFronts`.
    MirrorPlan plan(std::span<const View> views, const MirrorSettings& settings,
                    const Hidden& hidden = {}) const;

    std::size_t size() const { return fronts_.size(); }

  private:
    struct Front {
        std::uint32_t index;
        std::uint32_t panes;
        double area;
        city::Aabb bounds;
        reflection::MirrorPlane plane;
        bool rough() const { return plane.surface().roughness > 0; }
    };
    std::vector<Front> fronts_;
};

}  // namespace app
