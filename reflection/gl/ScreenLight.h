#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/gl/Texture.h"

namespace reflection {

/// What each pixel of a view mirrors, on the GPU: a GL_RGB9_E5 texture as large as the view (9 bits for the
/// brightest channel: within 0.2 %). Needs a current GL 4.5 context in every call and at destruction.
class ScreenLight {
  public:
    /// Replaces the pixels within [low, high) of a picture of linear radiance, top row first; negative or
    /// undefined values count as 0. Allocates when the size changed.
    void upload(std::span<const glm::vec3> radiance, glm::ivec2 size, glm::ivec2 low, glm::ivec2 high);

    /// GL name; texel (0, 0) is the lower left pixel, as gl_FragCoord counts. 0 before the first upload.
    std::uint32_t name() const { return texture_ ? texture_.name() : 0; }

  private:
    gl::Texture texture_;
    glm::ivec2 size_{0};
    std::vector<std::uint32_t> words_;
};

/// Red, green and blue of 9 bits with a common exponent of 5 (OpenGL 4.5, section 8.5.2), rounded to nearest.
std::uint32_t packSharedExponent(const glm::vec3& radiance);

}  // namespace reflection
