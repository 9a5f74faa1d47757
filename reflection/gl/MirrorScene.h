#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "reflection/planar/ReflectionTree.h"

namespace reflection {

/// An image to draw into: bound, with viewport and scissor set, when the scene is asked to draw.
struct MirrorTarget {
    std::uint32_t framebuffer = 0;  ///< GL name. Attachment 0: colour; 1, where `withDistance`: distance
    PixelRect viewport;             ///< of the framebuffer, that shows the node's `crop`
    PixelRect scissor;              ///< of the framebuffer
    bool withDistance = false;      ///< the target wants metres from the node's eye too, +infinity for sky
    bool mirrored = false;          ///< glFrontFace is already set so: GL_CW where true
    int layer = none;  ///< to be written to gl_Layer, where not `none`: MirrorPassOptions::layered
    static constexpr int none = -1;
};

/// A node's finished image as its mirrors' shader samples it.
struct MirrorMap {
    std::uint32_t colour = 0;  ///< GL_TEXTURE_2D, linear filter, clamped. Radiance as the scene drew it
    /// GL_TEXTURE_2D RGBA16F with `blurLevels` mipmap levels of smooth blur, each of half the texels:
    /// radiance, and in alpha the share of the way that lies behind the glass (see glossAngle). 0: the
    /// mirrors are smooth. Sampled by `mirrorGloss` of data/shaders/mirror_map.glsl.
    std::uint32_t blurred = 0;
    /// GL_TEXTURE_2D of `blurred`'s coordinates, linear filter: what the mirrors show, where their roughness
    /// is the node's; 0: not made (MirrorPassOptions::glossPerTexel).
    std::uint32_t glossed = 0;
    std::uint32_t distance = 0;  ///< GL_TEXTURE_2D R32F, metres from the node's eye; 0: the target wants none
    int blurLevels = 0;
    /// Of planar nodes: texture coordinates from gl_FragCoord in the parent's target, xy * scale + offset.
    glm::vec4 uvFromFragment{1, 1, 0, 0};  ///< scale xy, offset zw
    /// Texture coordinates of the middles of the map's outermost texels: clamp to them.
    glm::vec4 uvLimits{0, 0, 1, 1};  ///< low xy, high zw
    glm::vec2 blurredScale{1};       ///< from these coordinates to those of `blurred`, which is larger
    glm::vec2 texels{1};             ///< size of the textures
    float texelsPerPixel = 1;        ///< of the map for one pixel of the parent's target
};

/// The caller's scene as planar and view-dependent reflections see it: what a host engine implements. A
/// GL 4.5 context is current in every call; clip control is the caller's, depth is reversed and cleared to 0.
/// The implementation may change any GL state but the framebuffer's attachments.
class MirrorScene {
  public:
    virtual ~MirrorScene() = default;

    /// Draws a node's image: the world seen by `node.view`, cut to `node.crop` (node.clipFromView with clip
    /// distances by `node.glass`, or node.obliqueClipFromView without), nothing outside `node.frustum`, not
    /// the curved reflector `node.hiddenCurved`, at `node.coarser` levels of detail less, all but the mirrors
    /// of the node's children. Colour needs clearing, or a sky.
    virtual void drawNode(const ReflectionTree& tree, const ReflectionNode& node,
                          const MirrorTarget& target) = 0;

    /// Draws the node's mirrors (or its curved reflector) into its parent's image, which holds everything
    /// drawn so far with its depth. `parent`: null where that is a root's image.
    virtual void applyNode(const ReflectionTree& tree, const ReflectionNode& node, const MirrorMap& map,
                           const ReflectionNode* parent, const MirrorTarget& target) = 0;

    /// The node's reflections have been drawn into its image: what is to be drawn last, a sky, where it would
    /// otherwise be drawn behind mirrors in vain.
    virtual void finishNode(const ReflectionTree& tree, const ReflectionNode& node,
                            const MirrorTarget& target) {
        (void)tree, (void)node, (void)target;
    }

    /// Draws a face of an environment map, all but the mirrors met in it. Only with view-independent maps.
    virtual void drawFace(const ReflectionTree& tree, const ReflectionRoot& face,
                          const MirrorTarget& target) {
        (void)tree, (void)face, (void)target;
    }
    virtual void finishFace(const ReflectionTree& tree, const ReflectionRoot& face,
                            const MirrorTarget& target) {
        (void)tree, (void)face, (void)target;
    }
    /// The map of a curved reflector is complete: from now on this texture is to be sampled for it.
    virtual void publish(const EnvironmentJob& job, std::uint32_t texture) { (void)job, (void)texture; }
};

}  // namespace reflection
