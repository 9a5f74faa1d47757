#include "app/render/MirrorStencil.h"

#include <epoxy/gl.h>

#include <vector>

namespace app {

using reflection::EyeView;
using reflection::HalfSpace;
using reflection::MirrorTarget;
using reflection::ReflectionNode;
using reflection::ReflectionTree;

namespace {

class Stencil {
  public:
    Stencil(const ReflectionTree& tree, const MirrorWorld& world, MirrorWorldRenderer& renderer,
            const MirrorTarget& target)
        : tree_(tree), world_(world), renderer_(renderer), target_(target), below_(tree.nodes.size()) {
        // Reflections are drawn over the whole image.
        for (ReflectionNode& n : tree_.nodes) n.clipFromView = n.obliqueClipFromView = n.view.clipFromView;
        for (std::uint32_t n = 0; n < tree.nodes.size(); ++n)
            if (tree.nodes[n].parent != ReflectionNode::none) below_[tree.nodes[n].parent].push_back(n);
    }

    /// A reflection seen from `from` (whose glass is `glass`), where the stencil holds `value`.
    void draw(std::uint32_t index, const EyeView& from, const HalfSpace& glass, int value) {
        const ReflectionNode& node = tree_.nodes[index];
        if (!node.planar()) return;
        const auto shapes = [&](bool light) {
            glEnable(GL_DEPTH_TEST);
            glEnable(GL_CULL_FACE);
            glEnable(GL_CLIP_DISTANCE0);
            glFrontFace(from.mirrored() ? GL_CW : GL_CCW);
            for (std::uint32_t m : tree_.mirrorsOf(node)) {
                const glm::vec3 share = world_.mirrors[m].mirror.plane.surface().reflectance;
                const glm::vec3 own = world_.mirrors[m].tint * (1.f - share);
                if (light) glBlendColor(share.r, share.g, share.b, 1);
                renderer_.drawMirrorShape(m, from, from.clipFromView, glass, own);
            }
        };
        // Where the mirror is seen, one more.
        glEnable(GL_STENCIL_TEST);
        glDisable(GL_BLEND);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_GEQUAL);
        glStencilFunc(GL_EQUAL, value, 0xff);
        glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
        shapes(false);
        // There, everything is infinitely far.
        glStencilFunc(GL_EQUAL, value + 1, 0xff);
        glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
        glDepthMask(GL_TRUE);
        glDepthFunc(GL_ALWAYS);
        glDepthRange(0, 0);
        shapes(false);
        glDepthRange(0, 1);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glFrontFace(node.view.mirrored() ? GL_CW : GL_CCW);
        renderer_.drawNode(tree_, node, target_);
        renderer_.finishNode(tree_, node, target_);
        for (std::uint32_t child : below_[index]) draw(child, node.view, node.glass, value + 1);
        // The mirror's share of it, and its depth for what is drawn later.
        glStencilFunc(GL_EQUAL, value + 1, 0xff);
        glStencilOp(GL_KEEP, GL_KEEP, GL_DECR);
        glDepthFunc(GL_ALWAYS);
        glDepthMask(GL_TRUE);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_CONSTANT_COLOR);
        shapes(true);
        glDisable(GL_BLEND);
        glDepthFunc(GL_GEQUAL);
    }

  private:
    ReflectionTree tree_;
    const MirrorWorld& world_;
    MirrorWorldRenderer& renderer_;
    const MirrorTarget& target_;
    std::vector<std::vector<std::uint32_t>> below_;
};

}  // namespace

void drawByStencil(const ReflectionTree& tree, std::uint32_t root, const MirrorWorld& world,
                   MirrorWorldRenderer& renderer, const MirrorTarget& target) {
    renderer.finishRoot(tree, root);
    Stencil stencil(tree, world, renderer, target);
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n)
        if (tree.nodes[n].root == root && tree.nodes[n].parent == ReflectionNode::none)
            stencil.draw(n, tree.roots[root].view, {0, 0, 0, 1}, 0);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace app
