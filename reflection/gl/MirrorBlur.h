#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/MirrorLevel.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/ReflectionTree.h"

namespace reflection::gl {

/// Blurs a mirror's finished map into a pyramid of smooth images (data/shaders/mirror_blur.frag), once for
/// all roughnesses: `mirror_map.glsl` mixes levels. One pyramid serves all recursion levels, as it is used
/// before the next one is made.
class MirrorBlur {
  public:
    /// `sigma`: of the widest blur that will be asked for, in texels. Changes framebuffer, viewport, scissor,
    /// depth test and blending. Returns the number of levels.
    int blur(const MirrorLevel& map, const ReflectionNode& node, double sigma);
    const Texture& pyramid() const { return pyramid_; }
    const glm::ivec2& size() const { return size_; }  ///< texels, of its finest level
    std::uint64_t bytes() const;
    void release();

  private:
    void require(const glm::ivec2& size);

    Texture pyramid_;
    glm::ivec2 size_{0};
    std::vector<Framebuffer> levels_;
    Program first_, next_;
    VertexArray nothing_;
};

}  // namespace reflection::gl
