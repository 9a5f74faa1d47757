#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "reflection/chrome/VirtualMesh.h"
#include "reflection/planar/EyeView.h"

namespace app {

/// What one frame of close chrome took.
struct ChromeFrame {
    std::size_t jobs = 0;  ///< pieces drawn into
    std::size_t meshes = 0, vertices = 0, searched = 0, lookups = 0, triangles = 0;
    double searchMilliseconds = 0;
};

/// Close chrome in a MirrorWorld: curved reflectors without roughness show the objects near them where they
/// truly appear (reflection/chrome), over what their environment maps show of everything else.
class MirrorWorldChrome {
  public:
    /// Cuts the reflectors into pieces and makes their maps (of their finest triangles where they
    /// are one piece). Needs no context.
    /// `concave`: also of concave pieces, where searches look for all reflection points and take a hundred
    /// times as long; else environment maps go on showing them.
    MirrorWorldChrome(const MirrorWorld& world, const reflection::VirtualMeshOptions& options,
                      bool concave = true);
    ~MirrorWorldChrome();

    /// Before the first frame: the graphics card searches for what convex pieces show, for every vertex of
    /// objects cut finely beforehand (reflection::ChromeSearchMesh), and draws it without anything being read
    /// back; `searchMilliseconds` is then what asking for it takes.
    void searchOnGpu();

    /// Which objects a reflector shows as virtual objects; its environment map need not hold them.
    const std::vector<bool>& closeTo(std::size_t curved) const;

    /// Over a finished image of the world with its depth: searches, draws, blends. Binds `framebuffer` again
    /// at the end.
    ChromeFrame draw(const reflection::EyeView& view, const glm::ivec2& size, std::uint32_t framebuffer);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
