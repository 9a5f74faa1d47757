#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "reflection/chrome/ChromeTree.h"
#include "reflection/chrome/VirtualMesh.h"
#include "reflection/planar/EyeView.h"

namespace app {

/// What one frame of close chrome took.
struct ChromeFrame {
    std::size_t jobs = 0;  ///< pieces drawn into
    std::size_t meshes = 0, vertices = 0, searched = 0, lookups = 0, triangles = 0;
    double searchMilliseconds = 0;
    std::size_t pictures = 0, pictureTexels = 0;  ///< of chrome seen in chrome
    double planMilliseconds = 0;                  ///< of its tree
};

/// The cube maps of a world's curved reflectors, GL names; 0: none.
struct ChromeEnvironments {
    std::span<const std::uint32_t> maps;
    bool nearness = false;  ///< alpha is the reciprocal of the depth: see MirrorPassOptions
};

/// Close chrome in a MirrorWorld: curved reflectors without roughness show the objects near them where they
/// truly appear (reflection/chrome), over what their environment maps show of everything else.
class MirrorWorldChrome {
  public:
    /// Cuts the reflectors into pieces and makes their maps (of their finest triangles where they
    /// are one piece). Needs no context.
    /// `concave`: also of concave pieces, where searches look for all reflection points and take a hundred
    /// times as long; else environment maps go on showing them.
    /// `bounces`: what reflectors show of each other. With a depth of 2 or more each is a virtual object in
    /// those close to it, with what it mirrors itself as a picture from the eye that it seems to be looked at
    /// from (reflection/chrome/ChromeTree.h); else environment maps show it, and its own map in it.
    MirrorWorldChrome(const MirrorWorld& world, const reflection::VirtualMeshOptions& options,
                      bool concave = true, const reflection::ChromeTreeOptions& bounces = {.depth = 1});
    ~MirrorWorldChrome();

    /// Before the first frame: the graphics card searches for what convex pieces show, for every vertex of
    /// objects cut finely beforehand (reflection::ChromeSearchMesh), and draws it without anything being read
    /// back; `searchMilliseconds` is then what asking for it takes.
    void searchOnGpu();

    /// Which objects a reflector shows as virtual objects, so that its environment map need not hold them;
    /// and which other reflectors (none at a depth of 1). Empty where the map should hold all: a hollow
    /// reflector shows itself, too, and what is seen in that is the map's.
    std::vector<bool> leftToChrome(std::size_t curved) const;
    std::vector<bool> reflectorsLeftToChrome(std::size_t curved) const;
    /// Of the last frame.
    const reflection::ChromeTree& tree() const;

    /// Over a finished image of the world with its depth: searches, draws, blends. Binds `framebuffer` again
    /// at the end.
    ChromeFrame draw(const reflection::EyeView& view, const glm::ivec2& size, std::uint32_t framebuffer,
                     const ChromeEnvironments& environments = {});

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
