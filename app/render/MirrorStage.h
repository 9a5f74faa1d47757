#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "app/render/MirrorWorldChrome.h"
#include "reflection/gl/MirrorPass.h"

namespace app {

/// A MirrorWorld and what draws it off screen: for measurements and tests. Needs the same context in every
/// call.
class MirrorStage {
  public:
    /// The picture has bytes where the maps do, as the paper's 32 bit pixels; else half floats.
    MirrorStage(const MirrorWorld& world, glm::ivec2 size, reflection::CurvedMaps curved,
                const reflection::MirrorPassOptions& options = {});
    ~MirrorStage();

    /// One frame: tree, environment maps, the scene, its reflections. The tree stays until the next frame.
    /// `settings.curved` is the stage's. Curved reflectors have maps from the second frame on.
    const reflection::ReflectionTree& draw(reflection::TreeSettings settings);
    /// The same picture without maps: see drawByStencil.
    const reflection::ReflectionTree& drawWithStencil(reflection::TreeSettings settings);

    /// From now on curved reflectors show what is close by searched reflection points. Environment maps then
    /// leave it out. `concave`: see MirrorWorldChrome.
    /// `bounces`: what they show of each other, with cube maps; by default nothing but maps.
    void setChrome(const reflection::VirtualMeshOptions& options, bool concave = true,
                   reflection::ChromeTreeOptions bounces = {.depth = 1});
    /// After setChrome, before a frame: see MirrorWorldChrome.
    void searchChromeOnGpu();
    const ChromeFrame& chromeFrame() const;  ///< of the last frame
    const reflection::ChromeTree& chromeTree() const;

    /// Linear radiance, row 0 at the top. Waits.
    std::vector<glm::vec3> read() const;
    glm::ivec2 size() const;
    /// See MirrorWorldRenderer::setClusters.
    void setClusters(bool clusters);
    /// By oblique near planes instead of clip distances.
    void setOblique(bool oblique);

    reflection::MirrorPass& pass();
    std::uint64_t trianglesDrawn() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
