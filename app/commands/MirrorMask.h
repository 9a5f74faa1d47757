#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "app/display/OffscreenTarget.h"
#include "app/frame/FrameScene.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/LocalMapAtlas.h"

namespace app {

/// Finds the pixels of a view in which a vehicle mirrors something: those that differ between a black and a
/// white surrounding. Needs a current OpenGL context.
class MirrorMask {
  public:
    MirrorMask();

    /// One byte a pixel of the scene's first view, 1: mirrors. `renderer` must be prepared with the scene.
    std::vector<unsigned char> of(SceneRenderer& renderer, const FrameScene& scene,
                                  const OffscreenTarget& target);

  private:
    reflection::LocalMapAtlas atlas_;
};

/// sRGB-encoded colours 0..1, as the image errors take them.
std::vector<glm::vec3> toFloat(const Image8& image);
/// And back: values beyond 0..1 are cut.
Image8 toImage(const std::vector<glm::vec3>& pixels, glm::ivec2 size);

}  // namespace app
