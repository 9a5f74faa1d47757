#include <cmath>

#include "app/render/SceneRendererImpl.h"

namespace app {

namespace {

/// Metres beyond which panes without a map are as they are painted: mean light is what they mirror either
/// way.
constexpr float glassReach = 300;

}  // namespace

class SceneRenderer::Impl::Mirrors final : public reflection::MirrorScene {
  public:
    Mirrors(Impl& impl, const PlanarReflections& planar, const PassView& view,
            const VehicleReflections& reflections)
        : my_(impl),
          plan_(*planar.plan),
          root_(planar.root),
          wet_(planar.wet),
          view_(view),
          reflections_(reflections) {}

    void drawNode(const reflection::ReflectionTree&, const reflection::ReflectionNode& node,
                  const reflection::MirrorTarget& target) override {
        setDrawState(target);
        // Each level of detail less doubles what may be off.
        const float share = std::ldexp(1.f, -static_cast<int>(node.coarser));
        PassView pass = passOf(node, share);
        pass.skyline = my_.skylines.through(node.view, &node.glass);
        setFrame(pass, &node);
        drawOnlyWhereShown(node);
        my_.chosen.clear();
        for (const VisibleVehicle& v : my_.visible(pass)) my_.chosen.push_back(v.index);
        // A coarse body's normals bend what its paint mirrors, which shows where its shape does not:
        // vehicles are as fine in a mirror as outside it, and coarser only in mirrors in a row.
        PassView fine = pass;
        // Nor does it where it is blurred.
        if (node.coarser > 0 && node.roughness <= 0) fine.pixelsPerRadian *= 2;
        const VehiclePass::Counts vehicles =
            my_.vehiclePass.draw(fine, PassTarget::cube, my_.poses, my_.chosen,
                                 {&reflections_.textures, reflections_.slots, 0, 0, 0, {}},
                                 static_cast<float>(my_.detail.vehicleTolerance));
        const CityPass::Counts city = my_.cityPass.draw(pass, PassTarget::cube, foliageTolerance);
        // In the road's own image, from below, that is the sides of kerbs.
        if (wet_ && !roadBelow(node))
            triangles += my_.cityPass.drawWet(pass, PassTarget::cube, nullptr).triangles;
        const GlassPass::Counts glass = my_.drawPlainGlass(pass, PassTarget::cube, {&plan_, root_}, &node);
        my_.signalLamps.draw(pass, PassTarget::cube, my_.signalColours);
        // On a wet road shadows lie over what it mirrors: they follow it.
        if (my_.options.shadows && !roadBelow(node))
            my_.vehicleShadows.draw(pass, my_.vehiclePass.geometry(), my_.poses, my_.chosen, 8,
                                    PassTarget::cube);
        // The near plane that leans does not bear being turned round: the sky has none.
        my_.drawSky(PassView(node.view.eye, clipFromRelative(node.clipFromView, node.view.viewFromWorld), 1),
                    PassTarget::cube);
        triangles += vehicles.triangles + city.triangles + glass.triangles;
    }

    void applyNode(const reflection::ReflectionTree&, const reflection::ReflectionNode& node,
                   const reflection::MirrorMap& map, const reflection::ReflectionNode* parent,
                   const reflection::MirrorTarget& target) override {
        setDrawState(target);
        const PassView pass = parent != nullptr ? passOf(*parent, 1) : view_;
        setFrame(pass, parent);
        if (isRoad(node)) {
            drawRoad(node, map, parent, pass, target);
            return;
        }
        my_.cityPass.bindMaterials();
        my_.fronts.clear();
        for (const std::uint32_t m : plan_.tree.mirrorsOf(node)) my_.fronts.push_back(plan_.fronts[m]);
        if (!my_.glassPass) return;
        GlassPass::Mirrored mirrored;
        mirrored.map = map;
        const reflection::EyeView& view = parent != nullptr ? parent->view : plan_.tree.roots[node.root].view;
        const glm::dmat4& clip = parent != nullptr ? parent->clipFromView : view.clipFromView;
        mirrored.viewFromRelative = glm::mat3(view.viewFromWorld);
        mirrored.uvPerTangent = 0.5f * glm::vec2(target.viewport.size()) *
                                glm::vec2(map.uvFromFragment.x * static_cast<float>(clip[0][0]),
                                          map.uvFromFragment.y * static_cast<float>(clip[1][1]));
        my_.glassPass->draw(parent != nullptr ? PassTarget::cube : PassTarget::view, my_.fronts, &mirrored);
    }

    std::uint64_t triangles = 0;

  private:
    /// Of an image that is looked up where its panes are and nowhere else, the rest need not be drawn:
    /// between panes, below a row of them that runs away from the eye. Rough ones look around; the road is
    /// all there is.
    void drawOnlyWhereShown(const reflection::ReflectionNode& node) {
        if (node.roughness > 0 || !my_.paneMask || isRoad(node)) return;
        my_.fronts.clear();
        for (const std::uint32_t m : plan_.tree.mirrorsOf(node)) my_.fronts.push_back(plan_.fronts[m]);
        my_.paneMask->draw(node, my_.fronts);
    }
    /// Each mirror on the way fades all that it shows, what other mirrors show in it included.
    void setFrame(const PassView& pass, const reflection::ReflectionNode* node) {
        if (node == nullptr || plan_.fade <= 0) {
            my_.setFrame(pass);
            return;
        }
        int mirrors = 1;
        for (const reflection::ReflectionNode* n = node; n->parent != reflection::ReflectionNode::none;
             ++mirrors)
            n = &plan_.tree.nodes[n->parent];
        my_.setFrame(pass, 0, static_cast<float>(mirrors / plan_.fade), glm::vec4(node->glass));
    }
    bool isRoad(const reflection::ReflectionNode& node) const {
        const auto mirrors = plan_.tree.mirrorsOf(node);
        return !mirrors.empty() && plan_.fronts[mirrors.front()] == MirrorPlan::road;
    }
    bool roadBelow(const reflection::ReflectionNode& node) const {
        return std::ranges::any_of(plan_.tree.nodes, [&](const reflection::ReflectionNode& n) {
            return n.parent != reflection::ReflectionNode::none && &plan_.tree.nodes[n.parent] == &node &&
                   isRoad(n);
        });
    }
    void drawRoad(const reflection::ReflectionNode& node, const reflection::MirrorMap& map,
                  const reflection::ReflectionNode* parent, const PassView& pass,
                  const reflection::MirrorTarget& into) {
        CityPass::Wet wet;
        wet.map = map;
        const glm::vec2 used = glm::vec2(node.resolution) / map.texels;
        wet.uvPerRadian =
            0.5f * used * glm::vec2(glm::abs(node.clipFromView[0][0]), glm::abs(node.clipFromView[1][1]));
        wet.uvPerNdc = 0.5f * glm::vec2(map.uvFromFragment) * glm::vec2(into.viewport.size());
        // The glass's distance from the eye behind it is that of the eye before it.
        wet.height = node.view.eye.z - node.glass.w / node.glass.z;
        const PassTarget target = parent != nullptr ? PassTarget::cube : PassTarget::view;
        triangles += my_.cityPass.drawWet(pass, target, &wet).triangles;
        if (parent == nullptr || !my_.options.shadows) return;
        my_.chosen.clear();
        for (const VisibleVehicle& v : my_.visible(pass)) my_.chosen.push_back(v.index);
        my_.vehicleShadows.draw(pass, my_.vehiclePass.geometry(), my_.poses, my_.chosen, 8, target);
    }

    Impl& my_;
    const MirrorPlan& plan_;
    std::uint32_t root_;
    bool wet_;
    const PassView& view_;
    const VehicleReflections& reflections_;
};

const std::vector<bool>& SceneRenderer::Impl::frontsBelow(const MirrorPlan& plan, std::uint32_t root,
                                                          const reflection::ReflectionNode* parent) {
    mapped.assign(glassPass ? glassPass->size() : 0, false);
    for (const reflection::ReflectionNode& node : plan.tree.nodes) {
        const bool child = parent != nullptr ? node.parent != reflection::ReflectionNode::none &&
                                                   &plan.tree.nodes[node.parent] == parent
                                             : node.parent == reflection::ReflectionNode::none;
        if (!child || node.root != root) continue;
        for (const std::uint32_t m : plan.tree.mirrorsOf(node))
            if (plan.fronts[m] < mapped.size()) mapped[plan.fronts[m]] = true;
    }
    return mapped;
}

GlassPass::Counts SceneRenderer::Impl::drawPlainGlass(const PassView& pass, PassTarget target,
                                                      const PlanarReflections& planar,
                                                      const reflection::ReflectionNode* node) {
    if (!glassPass) return {};
    glassPass->seenBy(pass, glassReach, frontsBelow(*planar.plan, planar.root, node), fronts);
    return glassPass->draw(target, fronts, nullptr);
}

void SceneRenderer::Impl::drawGlass(const PassView& pass, const VehicleReflections& reflections,
                                    const PlanarReflections& planar) {
    const bool mirrorsRoad =
        planar.plan != nullptr &&
        std::ranges::any_of(planar.plan->tree.nodes, [&](const reflection::ReflectionNode& n) {
            const auto mirrors = planar.plan->tree.mirrorsOf(n);
            return n.root == planar.root && n.parent == reflection::ReflectionNode::none &&
                   !mirrors.empty() && planar.plan->fronts[mirrors.front()] == MirrorPlan::road;
        });
    if (planar.wet && !mirrorsRoad) {
        const CityPass::Counts ground = cityPass.drawWet(pass, PassTarget::view, nullptr);
        counters.drawCalls += ground.drawCalls;
        counters.triangles += ground.triangles;
    }
    if (planar.plan == nullptr) {
        mirrorPass.reset();
        return;
    }
    const GlassPass::Counts plain = drawPlainGlass(pass, PassTarget::view, planar, nullptr);
    counters.drawCalls += plain.drawCalls;
    counters.triangles += plain.triangles;
    if (planar.plan->empty()) {
        mirrorPass.reset();
        return;
    }
    if (!mirrorPass) mirrorPass = std::make_unique<reflection::MirrorPass>();
    mirrorPass->trim(planar.plan->tree);
    mirrorPass->resetCounters();
    Mirrors mirrors(*this, planar, pass, reflections);
    reflection::MirrorTarget target;
    target.framebuffer = viewTarget.framebuffer();
    target.viewport = target.scissor = {glm::ivec2(0), viewTarget.drawn()};
    mirrorPass->drawReflections(planar.plan->tree, planar.root, mirrors, target);
    const reflection::MirrorPassCounters& made = mirrorPass->counters();
    counters.mirrorPasses = static_cast<std::uint32_t>(made.images);
    counters.mirrorTriangles = mirrors.triangles;
    counters.mirrorTextureBytes = made.mapBytes + made.depthBytes + made.blurBytes;
    setDrawState();
    setFrame(pass);
    // Whom the view itself shows: the mirrors chose others.
    chosen.clear();
    for (const VisibleVehicle& v : visible(pass)) chosen.push_back(v.index);
}

}  // namespace app
