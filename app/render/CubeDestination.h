#pragma once

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/SceneDrawer.h"
#include "reflection/gl/Texture.h"

namespace app {

/// The six faces of one cube as something to draw into. Where vertex shaders may choose the layer, all six
/// are one target and one `begin` serves all (a software rasteriser then bins and rasterises them as one
/// scene); elsewhere each face is bound in turn.
class CubeDestination {
  public:
    CubeDestination();

    bool layered() const { return layered_; }
    /// Binds the target, clears its depth.
    void begin(const reflection::CubeTarget& target);
    /// What follows goes to this face. With layers, the caller tells its shaders the layer besides.
    void selectFace(int face);

  private:
    void requireDepth(int faceSize);

    bool layered_;
    reflection::CubeTarget target_;
    reflection::gl::Framebuffer framebuffer_;
    reflection::gl::Texture depth_;
    int depthSize_ = 0;
    reflection::gl::Texture colourView_;
    reflection::gl::Texture distanceView_;
};

}  // namespace app
