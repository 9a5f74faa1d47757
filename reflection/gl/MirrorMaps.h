#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflection/gl/MirrorBlur.h"
#include "reflection/gl/MirrorLevel.h"
#include "reflection/gl/MirrorPass.h"
#include "reflection/planar/MapAtlas.h"

namespace reflection::gl {

/// An image that reflections are met in: a node's, or a root's.
struct MirrorImage {
    const ReflectionNode* node = nullptr;  ///< null: a root's
    NdcRect crop;
    MirrorTarget target;
};

GLenum glFormat(MirrorFormat format);
std::uint64_t bytesOf(MirrorFormat format);

/// Binds an image, with viewport, scissor and winding.
void bind(const MirrorTarget& target);

/// The maps of all levels, and what makes single images in them and shows them.
class MirrorMaps {
  public:
    explicit MirrorMaps(const MirrorPassOptions& options) : options_(options) {}

    /// To be told of each tree before its images are drawn.
    void look(const ReflectionTree& tree);
    /// Makes room for so many texels in a level's map.
    void require(std::uint32_t level, const glm::ivec2& texels);
    /// Nothing drawn in all of a level's map.
    void clear(std::uint32_t level);

    /// Draws a node's image with its lower left texel at `origin`. `cleared`: the whole map is, see `clear`.
    MirrorImage draw(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene,
                     const glm::ivec2& origin, bool cleared);
    /// Blurs those finished images of a level whose mirrors are rough, all together.
    void filter(const ReflectionTree& tree, std::span<const AtlasGroup::Place> places);
    /// Shows a finished and filtered image in its parent's.
    void apply(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene,
               const glm::ivec2& origin, const MirrorImage& parent);

    /// Frees levels beyond so many.
    void keep(std::size_t levels);
    /// Adds up what is held.
    void count(MirrorPassCounters& held) const;
    MirrorPassCounters drawn;  ///< images, filtered, texels

  private:
    bool rough(const ReflectionNode& node) const;
    double widestBlur(const ReflectionNode& node) const;
    bool withDistance(const ReflectionTree& tree, const ReflectionNode& node) const;

    MirrorPassOptions options_;
    std::vector<MirrorLevel> levels_;
    MirrorBlur blur_;
    bool withDistance_ = false;  ///< some node has distance
    /// Of each node of the tree looked at: it is rough, or met in one that is: way lengths add up.
    std::vector<bool> nodeWithDistance_;
};

}  // namespace reflection::gl
