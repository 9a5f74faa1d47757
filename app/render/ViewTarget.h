#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "app/render/SceneRenderer.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"

namespace app {

/// What a view is drawn into before it is antialiased and handed on: colour (RGBA8, display values) and
/// depth.
class ViewTarget {
  public:
    explicit ViewTarget(Antialiasing antialiasing);

    /// Makes the target current with depth cleared, at a size; allocates when the size changed. Of it, the
    /// share `scale` a side (0..1) is drawn, one pixel at least: see `drawn`.
    void begin(glm::ivec2 size, double scale = 1);
    /// Pixels drawn since the last `begin`.
    glm::ivec2 drawn() const { return drawn_; }
    /// GL name of the framebuffer that is drawn into between `begin` and `finish`.
    std::uint32_t framebuffer() const { return target_.name(); }
    /// Antialiases into the caller's framebuffer, stretched to the view's size; it is current afterwards.
    /// `antialiasing`: see DrawingDetail.
    void finish(std::uint32_t framebuffer, double antialiasing = 1);

  private:
    /// In so many rows of pixels, the middle ones.
    void mendEdges(int rows);

    Antialiasing antialiasing_;
    glm::ivec2 size_{0};
    glm::ivec2 drawn_{0};
    reflection::gl::Texture colour_;
    reflection::gl::Texture depth_;
    reflection::gl::Framebuffer target_;
    reflection::gl::Texture smooth_;  ///< fxaa: the image with its edges mended; msaa: with one sample,
                                      ///< to be stretched
    reflection::gl::Framebuffer smoothTarget_;
    reflection::gl::Program findEdges_;
    reflection::gl::Program fxaa_;
    reflection::gl::VertexArray nothing_;
};

}  // namespace app
