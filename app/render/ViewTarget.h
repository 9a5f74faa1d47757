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

    /// Makes the target current with depth cleared, at a size; allocates when the size changed.
    void begin(glm::ivec2 size);
    /// Antialiases into the caller's framebuffer, which is current afterwards.
    void finish(std::uint32_t framebuffer);

  private:
    void mendEdges();

    Antialiasing antialiasing_;
    glm::ivec2 size_{0};
    reflection::gl::Texture colour_;
    reflection::gl::Texture depth_;
    reflection::gl::Framebuffer target_;
    reflection::gl::Texture smooth_;  ///< fxaa: the image with its edges mended
    reflection::gl::Framebuffer smoothTarget_;
    reflection::gl::Program findEdges_;
    reflection::gl::Program fxaa_;
    reflection::gl::VertexArray nothing_;
};

}  // namespace app
