#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "reflection/gl/MirrorScene.h"

namespace app {

/// Draws a MirrorWorld with OpenGL 4.5, its reflections by a ReflectionTree and a MirrorPass. Colours are
/// linear, as they are; the caller encodes them. Mirrors without a map (where the recursion ends, or left
/// out) show MirrorWorld::beyond.
class MirrorWorldRenderer final : public reflection::MirrorScene {
  public:
    /// `curved`: how curved reflectors mirror; paraboloids need finer triangles. `parallax`: environment maps
    /// keep distances (MirrorPassOptions::nearness) and are looked up where a ray ends.
    MirrorWorldRenderer(const MirrorWorld& world, reflection::CurvedMaps curved, bool parallax = false);
    ~MirrorWorldRenderer() override;
    /// Whether the driver lets it draw into the layers that targets name.
    static bool canDrawLayers();

    /// Everything but the sky and mirrors of which the tree has reflections in one of its roots; the target
    /// is bound, its depth cleared. When the reflections are drawn: `finishRoot`.
    void drawRoot(const reflection::ReflectionTree& tree, std::uint32_t root,
                  const reflection::MirrorTarget& target);

    void drawNode(const reflection::ReflectionTree& tree, const reflection::ReflectionNode& node,
                  const reflection::MirrorTarget& target) override;
    void applyNode(const reflection::ReflectionTree& tree, const reflection::ReflectionNode& node,
                   const reflection::MirrorMap& map, const reflection::ReflectionNode* parent,
                   const reflection::MirrorTarget& target) override;
    void drawFace(const reflection::ReflectionTree& tree, const reflection::ReflectionRoot& face,
                  const reflection::MirrorTarget& target) override;
    void finishRoot(const reflection::ReflectionTree& tree, std::uint32_t root);
    void finishNode(const reflection::ReflectionTree& tree, const reflection::ReflectionNode& node,
                    const reflection::MirrorTarget& target) override;
    void finishFace(const reflection::ReflectionTree& tree, const reflection::ReflectionRoot& face,
                    const reflection::MirrorTarget& target) override;
    void publish(const reflection::EnvironmentJob& job, std::uint32_t texture) override;

    /// Clusters of triangles that an image does not see are left out of it, where it has a frustum
    /// (Economies::offScreen); true from the beginning.
    void setClusters(bool clusters);

    /// Objects that the environment map of a curved reflector does not hold, because it shows them otherwise,
    /// and other curved reflectors: one flag for each. Empty: it holds all.
    void setLeftOut(std::size_t curved, std::vector<bool> objects, std::vector<bool> others = {});
    /// GL names of the curved reflectors' view-independent maps; 0: none yet.
    std::span<const std::uint32_t> environments() const;

    /// Mirrors by oblique near planes in place of clip distances.
    void setOblique(bool oblique);

    /// The polygon of a mirror by itself, in one colour: for stencils. Sets no state but the program.
    void drawMirrorShape(std::uint32_t mirror, const reflection::EyeView& view,
                         const glm::dmat4& clipFromView, const reflection::HalfSpace& glass,
                         const glm::vec3& colour);

    std::uint64_t trianglesDrawn() const;  ///< since the beginning

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
