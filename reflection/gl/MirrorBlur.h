#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/MirrorLevel.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/ReflectionTree.h"

namespace reflection::gl {

/// Blurs mirrors' finished maps into a pyramid of smooth images (data/shaders/mirror_blur.frag), once for
/// all roughnesses: `mirror_map.glsl` mixes levels. One pyramid serves all recursion levels, as it is used
/// before the next one is made.
///
/// `gloss` goes on to what each mirror shows, a value a texel (data/shaders/mirror_gloss.frag): where a map
/// has fewer texels than its mirror covers pixels, or several images show it, that is less work than a filter
/// for each of these.
class MirrorBlur {
  public:
    /// One of the images in a map.
    struct Item {
        const ReflectionNode* node = nullptr;
        glm::ivec2 origin{0};  ///< multiples of 64
        double sigma = 0;      ///< of the widest blur that will be asked for, in texels
        double angle = 0;      ///< of Gloss.h, of its mirrors
    };
    /// Levels of the pyramid that a blur of so many texels needs.
    static int levelsFor(double sigma);
    /// All at once: a level of the pyramid is one change of target. Changes framebuffer, viewport, scissor,
    /// depth test and blending.
    void blur(const MirrorLevel& map, std::span<const Item> items);
    /// After `blur` of the same images: what their mirrors show, all of one roughness. `format`: GL's.
    void gloss(std::span<const Item> items, GLenum format);
    const Texture& glossed() const { return glossed_; }  ///< as large as the pyramid's finest level
    const Texture& pyramid() const { return pyramid_; }
    const glm::ivec2& size() const { return size_; }  ///< texels, of its finest level
    std::uint64_t bytes() const;
    void release();

  private:
    void require(const glm::ivec2& size);
    void setRays(const Program& program, const Item& item) const;

    Texture pyramid_, glossed_;
    glm::ivec2 size_{0};
    std::vector<Framebuffer> levels_;
    Framebuffer glossTarget_;
    GLenum glossFormat_ = 0;
    Program first_, next_, gloss_;
    VertexArray nothing_;
};

}  // namespace reflection::gl
