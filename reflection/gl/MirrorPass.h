#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "reflection/gl/MirrorScene.h"

namespace reflection {

enum class MirrorFormat : std::uint8_t {
    rgba8,       ///< the paper's 32 bit pixels: values 0 .. 1 as the scene writes them
    r11g11b10f,  ///< the same bytes for linear HDR radiance; no alpha
    rgba16f
};

struct MirrorPassOptions {
    MirrorFormat format = MirrorFormat::r11g11b10f;
    /// Rough mirrors are filtered once for each texel of their maps and then looked up like smooth ones
    /// (MirrorMap::glossed), planar ones; false: for each of the pixels that they cover. Coarser where a map
    /// has fewer texels.
    bool glossPerTexel = false;
    /// Maps of a level side by side in one texture, the deepest level first (AtlasGroup): a change of target
    /// a level in place of two a map, for the memory of all maps of a frame. False: the paper's order.
    bool together = false;
    int largestAtlas = 4096;  ///< texels of that texture's side; what does not fit is drawn in turn
    /// With `together`: all faces of an environment map in one framebuffer. The scene's vertex shaders write
    /// MirrorTarget::layer to gl_Layer (GL_ARB_shader_viewport_layer_array); costs depth for all faces.
    bool layered = false;
    /// Environment maps have an alpha channel of half floats in which the scene keeps 1 / depth (along the
    /// greatest axis; 0: infinitely far), and mirrors' maps have distances, so that a curved mirror can be
    /// looked up where a ray ends. False: the paper's, for which all lies infinitely far.
    bool nearness = false;
    bool distances = false;  ///< all mirrors' maps have them: for bumped ones, and those that fade
    bool prefilter =
        false;  ///< complete environment maps have all their mip levels: for rough curved mirrors
    CurvedMaps environments =
        CurvedMaps::cube;  ///< what `publish` hands out: cube maps or pairs of paraboloids
};

/// Since the last `resetCounters`, and what is held now.
struct MirrorPassCounters {
    std::uint64_t images = 0;  ///< nodes drawn
    std::uint64_t faces = 0;
    std::uint64_t filtered = 0;          ///< of the images, those blurred
    std::uint64_t texels = 0;            ///< inside scissors
    std::uint64_t mapBytes = 0;          ///< colour of the levels' maps, held now
    std::uint64_t depthBytes = 0;        ///< their depth and distance, held now
    std::uint64_t blurBytes = 0;         ///< one pyramid for all levels, and what is glossed; held now
    std::uint64_t environmentBytes = 0;  ///< complete environment maps, held now
    std::uint64_t spareBytes = 0;        ///< the one environment map that is being drawn, and its depth
};

/// Executes a ReflectionTree with OpenGL 4.5: one map for each recursion level, made when met, used and
/// reused, after Nielsen & Christensen 2002, figures 4 to 6; blurred for rough mirrors at every level. Owns
/// the maps; draws the caller's scene through MirrorScene. Needs the context of its making in every call.
class MirrorPass {
  public:
    explicit MirrorPass(const MirrorPassOptions& options = {});
    ~MirrorPass();
    MirrorPass(MirrorPass&&) noexcept;
    MirrorPass& operator=(MirrorPass&&) noexcept;

    /// Environment maps of the tree's jobs; `curved`: number of curved reflectors, for which maps are kept. A
    /// map replaces its reflector's only when it is complete.
    void drawEnvironments(const ReflectionTree& tree, MirrorScene& scene, std::size_t curved);

    /// With `together`, and where they fit: the maps of what is met in one view, before the view's own scene
    /// is drawn, so that its image is not put aside for them; `drawReflections` of the same tree and root,
    /// next, only shows them. Else without effect: it then draws them.
    void makeReflections(const ReflectionTree& tree, std::uint32_t root, MirrorScene& scene);

    /// The reflections met in one view, whose own scene is drawn already, with depth: `target` is its image
    /// and has the whole view in its viewport. Leaves the target bound.
    void drawReflections(const ReflectionTree& tree, std::uint32_t root, MirrorScene& scene,
                         const MirrorTarget& target);

    /// Frees levels that the tree does not use; an empty tree keeps no texture but environment maps.
    void trim(const ReflectionTree& tree);

    const MirrorPassCounters& counters() const;
    void resetCounters();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
