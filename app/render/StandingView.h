#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/frame/Lighting.h"
#include "app/render/ChangedParts.h"
#include "app/render/PassTarget.h"
#include "app/render/ViewTarget.h"

namespace app {

/// A view that is drawn again and again from the same place, and what dissolves in it: tells a ViewTarget
/// when a change of detail may do so, and which parts move and are new from the start.
class StandingView {
  public:
    explicit StandingView(std::vector<city::SignalHead> heads) : heads_(std::move(heads)) {}

    /// The next view's detail is another one: see SceneRenderer::setDetail.
    void dissolveNext(int frames) { frames_ = frames; }
    /// Another picture comes first.
    void forget() { size_ = {}; }
    bool drewLast(const PassView& pass, glm::ivec2 size, const Lighting& lighting) const {
        return eye_ == pass.eye && clip_ == pass.clipFromRelative && size_ == size && lighting_ == lighting;
    }

    /// Before a view is drawn: what dissolves goes on where the last view is drawn again, and ends elsewhere.
    void begin(const PassView& pass, glm::ivec2 size, const Lighting& lighting, ViewTarget& target);
    /// Then, what the view shows. `alwaysLive`: boxes (world) of what changes as a whole: windows that
    /// mirror. They are live within two seconds, tile by tile.
    void show(const PassView& pass, std::span<const vehicles::VehiclePose> poses,
              std::span<const vehicles::SignalColour> colours,
              const std::function<city::Aabb(const vehicles::VehiclePose&)>& boundsOf,
              std::span<const city::Aabb> alwaysLive, ViewTarget& target);

  private:
    std::vector<city::SignalHead> heads_;
    int frames_ = 0;
    MovingParts drawn_;  ///< with the last view
    MovingParts held_;   ///< with the picture that dissolves
    glm::dvec3 eye_{0};  ///< the last view's
    glm::mat4 clip_{0};
    glm::ivec2 size_{0};
    Lighting lighting_;
};

}  // namespace app
