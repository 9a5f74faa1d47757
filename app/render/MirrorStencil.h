#pragma once

#include "app/render/MirrorWorldRenderer.h"

namespace app {

/// The textbook's way (Real-Time Rendering 9.3.1), kept as the reference for maps: reflections are drawn into
/// the picture itself, each within the pixels where its mirror is seen, told by the stencil; mirrors in
/// mirrors by counting up. No maps, no gloss; flat mirrors alone.
///
/// The target has everything of the root drawn, with depth, and eight stencil bits that are 0; afterwards
/// they are 0 again.
void drawByStencil(const reflection::ReflectionTree& tree, std::uint32_t root, const MirrorWorld& world,
                   MirrorWorldRenderer& renderer, const reflection::MirrorTarget& target);

}  // namespace app
