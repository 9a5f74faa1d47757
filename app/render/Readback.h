#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "reflection/gl/Buffer.h"

namespace app {

/// An 8 bit image as stills and video want it: RGBA, row 0 at the top.
struct Image8 {
    glm::ivec2 size{0};
    std::vector<std::uint8_t> rgba;
};

/// The colours of a framebuffer (0: the window's back buffer), after everything drawn so far. Waits for the
/// GPU.
Image8 readPixels(std::uint32_t framebuffer, glm::ivec2 size);

/// Reads frames back one call late, so that the GPU is not waited for: while it draws frame n, frame n - 1 is
/// copied out.
class DelayedReadback {
  public:
    DelayedReadback();

    /// Asks for this framebuffer's colours and gives those asked for by the call before; nothing on the first
    /// call.
    std::optional<Image8> exchange(std::uint32_t framebuffer, glm::ivec2 size);
    /// The last frame asked for; nothing when there is none.
    std::optional<Image8> finish();

  private:
    std::array<reflection::gl::Buffer, 2> buffers_;
    std::array<glm::ivec2, 2> sizes_{glm::ivec2(0), glm::ivec2(0)};
    std::array<bool, 2> pending_{false, false};
    std::size_t next_ = 0;
    std::optional<Image8> take(std::size_t slot);
};

}  // namespace app
