#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <map>
#include <vector>

#include "reflection/gl/Buffer.h"
#include "reflection/local_map/LocalMap.h"

namespace reflection {

/// Skies for local maps (LookupOptions::sky) on the GPU, 16 bytes a texel: one for each face size as long as
/// the light lasts. Needs a current GL 4.5 context in every call and at destruction.
class SkyBuffer {
  public:
    static constexpr std::uint32_t none = 0xffffffffu;

    SkyBuffer() : buffer_(gl::Buffer::create()) { upload(); }

    /// Index of the first texel of a sky, copied when it is seen for the first time; `none` for null.
    std::uint32_t firstTexelOf(const LocalMap* sky);
    /// Skies may have changed, or be gone.
    void forget();

    /// GL name, for binding as a shader storage buffer.
    std::uint32_t name() const { return buffer_.name(); }
    std::size_t bytes() const { return texels_.size() * sizeof(glm::vec4); }

  private:
    void upload();

    std::map<const LocalMap*, std::uint32_t> first_;
    std::vector<glm::vec4> texels_;
    gl::Buffer buffer_;
};

}  // namespace reflection
