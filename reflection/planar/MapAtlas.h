#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "reflection/planar/ReflectionTree.h"

namespace reflection {

/// Reflections that are drawn together, level by level, the deepest first: all images of a level lie side by
/// side in its map. What the paper draws one after the other, to hold one image a level, costs a change of
/// target twice an image; this costs one a level, and holds all images.
struct AtlasGroup {
    struct Place {
        std::uint32_t node = 0;
        glm::ivec2 origin{0};  ///< of its lower left texel
    };
    struct Level {
        std::vector<Place> places;  ///< in the tree's order
        glm::ivec2 size{0};         ///< texels
    };
    std::vector<std::uint32_t> tops;  ///< met in the same image, or in images that are drawn later
    std::vector<Level> levels;        ///< from the tops' own down; everything below them
    /// False: a single reflection that does not fit with what is below it. It is to be drawn by itself, and
    /// what is met in it as groups of its own; `levels` is empty.
    bool fits = true;
};

struct AtlasLimits {
    glm::ivec2 most{4096, 4096};  ///< texels of a level's map
    /// Origins are multiples of this where a mirror of the level is rough, so that a pyramid's texels do not
    /// straddle two images.
    int roughAlignment = 64;
};

/// Groups `tops` (nodes of one level) so that each group fits; their order is kept. Deterministic. Cost:
/// nodes times the logarithm of their number for each of few halvings.
std::vector<AtlasGroup> atlasGroups(const ReflectionTree& tree, const ReflectionChildren& children,
                                    std::span<const std::uint32_t> tops, const AtlasLimits& limits = {});

}  // namespace reflection
