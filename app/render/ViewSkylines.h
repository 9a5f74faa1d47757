#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/render/PassTarget.h"
#include "app/render/Skyline.h"
#include "reflection/planar/EyeView.h"
#include "reflection/planar/Portal.h"

namespace app {

/// What buildings hide from a frame's eyes, before mirrors and behind them; answers are kept while they are
/// right, as a view is asked for its vehicles and planned before it is drawn.
class ViewSkylines {
  public:
    /// `cull` false: nothing is hidden, all answers are null.
    ViewSkylines(const city::CityModel& city, bool cull) : skyline_(city), cull_(cull) {}

    const Skyline& skyline() const { return skyline_; }

    /// Forgets the eyes behind mirrors.
    void beginFrame() { behindMirrors_.clear(); }

    /// What a view cannot see: valid until the next call with another view.
    const SkylineView* of(const PassView& view);

    /// The same for an eye that may look through a mirror (null: through none); kept for the frame.
    const SkylineView* through(const reflection::EyeView& from, const reflection::HalfSpace* glass);

  private:
    Skyline skyline_;
    bool cull_;
    std::optional<SkylineView> last_;
    glm::dvec3 lastEye_{0};
    glm::mat4 lastClip_{0};
    std::vector<std::pair<glm::dvec3, std::unique_ptr<SkylineView>>> behindMirrors_;
};

}  // namespace app
