#include "app/render/SceneRenderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "app/render/CityPass.h"
#include "app/render/CubeDestination.h"
#include "app/render/CubeFaces.h"
#include "app/render/FrameUniforms.h"
#include "app/render/GlassPass.h"
#include "app/render/NodeView.h"
#include "app/render/ShadowMap.h"
#include "app/render/SignalLamps.h"
#include "app/render/StandingView.h"
#include "app/render/VehiclePass.h"
#include "app/render/VehicleShadows.h"
#include "app/render/ViewTarget.h"
#include "reflection/gl/MirrorPass.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

namespace {

/// Beams around the eye by which hidden things are left out: 0.35 and 0.7 degrees wide.
constexpr int viewBeams = 1024;
constexpr int cubeBeams = 512;
/// Cubes are seen from inside vehicles, close to the road.
constexpr float cubeNear = 0.05f;
/// Texels by which a vehicle's level of detail may be off in a cube.
constexpr float cubeVehicleTolerance = 2.5f;
/// Pixels for plants: where a leaf sits does not show, only how dense and how wide they are.
constexpr float foliageTolerance = 10;
/// Metres beyond which panes without a map are as they are painted: mean light is what they mirror either
/// way.
constexpr float glassReach = 300;

float pixelsPerRadian(const View& view) {
    return 0.5f * static_cast<float>(view.size.y) * std::abs(view.clipFromView[1][1]);
}

/// Texels of about 0.12 m, as far as memory allows (8192: 128 MB).
int shadowSize(const city::Aabb& bounds) {
    if (bounds.empty()) return 1;
    const glm::vec3 size = bounds.size();
    int texels = 1024;
    while (texels < 8192 && static_cast<float>(texels) * 0.12f < std::max(size.x, size.y)) texels *= 2;
    return texels;
}

}  // namespace

struct SceneRenderer::Impl {
    /// Draws reflections as the mirror pass asks for them.
    class Mirrors;
    friend class Mirrors;

    Impl(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
         const RenderOptions& renderOptions)
        : options(renderOptions),
          skyline(city),
          cityPass(city),
          shadow(cityPass.geometry().bounds(), shadowSize(cityPass.geometry().bounds())),
          vehiclePass(models),
          signalLamps(city.signalHeads),
          frameUniforms(gl::Buffer::create()),
          emptyArray(gl::VertexArray::create()),
          viewTarget(renderOptions.antialiasing),
          standing(city.signalHeads) {
        for (std::size_t target = 0; target < 2; ++target)
            skyPrograms[target] =
                gl::Program::fromFiles({"sky.vert", "sky.frag"}, definesFor(static_cast<PassTarget>(target)));
    }

    void setFrame(const PassView& view, int layer = 0) {
        FrameUniforms uniforms;
        uniforms.clipFromRelative = view.clipFromRelative;
        uniforms.setEye(view.eye);
        uniforms.eyeLow.w = static_cast<float>(layer);
        uniforms.setLighting(lighting);
        uniforms.setShadow(shadow.shadowFromWorld(), shadow.normalOffset());
        frameUniforms.replaceWith(uniforms);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameUniforms.name());
        shadow.texture().bind(1);
    }

    void updateShadow() {
        if (!options.shadows) return;
        setDrawState();
        shadow.update(lighting.sunDirection, [&](const PassView& view) {
            setFrame(view);
            cityPass.draw(view, PassTarget::depth, foliageTolerance);
        });
    }

    /// The city's glass in a view whose city and vehicles are drawn.
    void drawGlass(const PassView& pass, const VehicleReflections& reflections,
                   const PlanarReflections& planar);

    void drawSky(const PassView& view, PassTarget target) {
        gl::Program& program = skyPrograms[static_cast<std::size_t>(target)];
        program.set("relativeFromClip", glm::inverse(view.clipFromRelative));
        program.use();
        emptyArray.bind();
        glDisable(GL_CULL_FACE);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    /// What a view cannot see; the last answer is kept, as one view is asked for its vehicles before it is
    /// drawn.
    const SkylineView* skylineFor(const PassView& view) const {
        if (!options.occlusionCulling) return nullptr;
        if (!lastSkyline || lastEye != view.eye || lastClip != view.clipFromRelative) {
            lastEye = view.eye;
            lastClip = view.clipFromRelative;
            lastSkyline.emplace(skyline, view.eye, viewBeams, SkylineView::sectorOf(view.clipFromRelative));
        }
        return &*lastSkyline;
    }

    /// The same for an eye that may look through a mirror, for all of this frame's.
    const SkylineView* skylineFor(const reflection::EyeView& from, const reflection::HalfSpace* glass) const {
        if (!options.occlusionCulling) return nullptr;
        for (const auto& [eye, view] : mirrorSkylines)
            if (eye == from.eye) return view.get();
        // A front's image may be seen in all of the whole image.
        const auto sector = SkylineView::sectorOf(clipFromRelative(from.clipFromView, from.viewFromWorld));
        auto made = std::make_unique<SkylineView>(skyline, from.eye, viewBeams, sector,
                                                  glass != nullptr ? *glass : glm::dvec4(0));
        return mirrorSkylines.emplace_back(from.eye, std::move(made)).second.get();
    }

    /// Which fronts the images below one show, by front.
    const std::vector<bool>& frontsBelow(const MirrorPlan& plan, std::uint32_t root,
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

    /// Glass that no map serves in an image: a root's, or a node's.
    GlassPass::Counts drawPlainGlass(const PassView& pass, PassTarget target, const PlanarReflections& planar,
                                     const reflection::ReflectionNode* node) {
        if (!glassPass) return {};
        glassPass->seenBy(pass, glassReach, frontsBelow(*planar.plan, planar.root, node), fronts);
        return glassPass->draw(target, fronts, nullptr);
    }

    std::vector<VisibleVehicle> visible(const PassView& pass) const {
        std::vector<VisibleVehicle> found;
        for (std::uint32_t i = 0; i < poses.size(); ++i) {
            const vehicles::VehiclePose& pose = poses[i];
            if (pose.model >= vehiclePass.geometry().models().size() ||
                !pass.sees(vehiclePass.boundsOf(pose)))
                continue;
            const float radius = vehiclePass.geometry().models()[pose.model].radius;
            const float distance = std::max(glm::length(vehiclePass.centreOf(pose, pass.eye)), 0.5f * radius);
            found.push_back({i, 2 * radius / distance * pass.pixelsPerRadian});
        }
        return found;
    }

    RenderOptions options;
    Skyline skyline;
    mutable std::optional<SkylineView> lastSkyline;
    mutable glm::dvec3 lastEye{0};
    mutable glm::mat4 lastClip{0};
    CityPass cityPass;
    ShadowMap shadow;
    VehiclePass vehiclePass;
    VehicleShadows vehicleShadows;
    SignalLamps signalLamps;
    gl::Buffer frameUniforms;
    gl::VertexArray emptyArray;
    std::array<gl::Program, 2> skyPrograms;

    ViewTarget viewTarget;
    StandingView standing;
    std::vector<city::Aabb> frontBounds, liveFronts;  ///< of the glass: all, and those that mirror now

    std::unique_ptr<GlassPass> glassPass;
    std::unique_ptr<reflection::MirrorPass> mirrorPass;  ///< while plans need it
    mutable std::vector<std::pair<glm::dvec3, std::unique_ptr<SkylineView>>>
        mirrorSkylines;  ///< of this frame
    std::vector<bool> mapped;
    std::vector<std::uint32_t> fronts;

    CubeDestination cube;

    Lighting lighting;
    std::vector<vehicles::VehiclePose> poses;
    std::vector<vehicles::SignalColour> signalColours;
    std::vector<std::uint32_t> chosen;
    RenderCounters counters;
    DrawingDetail detail;
};

class SceneRenderer::Impl::Mirrors final : public reflection::MirrorScene {
  public:
    Mirrors(Impl& impl, const MirrorPlan& plan, std::uint32_t root, const PassView& view,
            const VehicleReflections& reflections)
        : my_(impl), plan_(plan), root_(root), view_(view), reflections_(reflections) {}

    void drawNode(const reflection::ReflectionTree&, const reflection::ReflectionNode& node,
                  const reflection::MirrorTarget& target) override {
        setDrawState(target);
        // Each level of detail less doubles what may be off.
        const float share = std::ldexp(1.f, -static_cast<int>(node.coarser));
        PassView pass = passOf(node, share);
        pass.skyline = my_.skylineFor(node.view, &node.glass);
        my_.setFrame(pass);
        my_.chosen.clear();
        for (const VisibleVehicle& v : my_.visible(pass)) my_.chosen.push_back(v.index);
        const VehiclePass::Counts vehicles = my_.vehiclePass.draw(
            pass, PassTarget::cube, my_.poses, my_.chosen, {&reflections_.textures, reflections_.slots, 0},
            static_cast<float>(my_.detail.vehicleTolerance));
        const CityPass::Counts city = my_.cityPass.draw(pass, PassTarget::cube, foliageTolerance);
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
        my_.setFrame(pass);
        if (isRoad(node)) {
            drawRoad(node, map, parent, pass);
            return;
        }
        my_.cityPass.bindMaterials();
        my_.fronts.clear();
        for (const std::uint32_t m : plan_.tree.mirrorsOf(node)) my_.fronts.push_back(plan_.fronts[m]);
        if (my_.glassPass)
            my_.glassPass->draw(parent != nullptr ? PassTarget::cube : PassTarget::view, my_.fronts, &map);
    }

    std::uint64_t triangles = 0;

  private:
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
                  const reflection::ReflectionNode* parent, const PassView& pass) {
        CityPass::Wet wet;
        wet.map = map;
        const glm::vec2 used = glm::vec2(node.resolution) / map.texels;
        wet.uvPerRadian =
            0.5f * used * glm::vec2(glm::abs(node.clipFromView[0][0]), glm::abs(node.clipFromView[1][1]));
        // The glass's distance from the eye behind it is that of the eye before it.
        wet.height = node.view.eye.z - node.glass.w / node.glass.z;
        const PassTarget target = parent != nullptr ? PassTarget::cube : PassTarget::view;
        triangles += my_.cityPass.drawWet(pass, target, wet).triangles;
        if (parent == nullptr || !my_.options.shadows) return;
        my_.chosen.clear();
        for (const VisibleVehicle& v : my_.visible(pass)) my_.chosen.push_back(v.index);
        my_.vehicleShadows.draw(pass, my_.vehiclePass.geometry(), my_.poses, my_.chosen, 8, target);
    }

    Impl& my_;
    const MirrorPlan& plan_;
    std::uint32_t root_;
    const PassView& view_;
    const VehicleReflections& reflections_;
};

void SceneRenderer::Impl::drawGlass(const PassView& pass, const VehicleReflections& reflections,
                                    const PlanarReflections& planar) {
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
    Mirrors mirrors(*this, *planar.plan, planar.root, pass, reflections);
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

SceneRenderer::SceneRenderer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models,
                             const RenderOptions& options)
    : impl_(std::make_unique<Impl>(city, models, options)) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::prepare(const FrameScene& scene) {
    impl_->lighting = scene.lighting;
    const float length = glm::length(scene.lighting.sunDirection);
    impl_->lighting.sunDirection = length > 0 ? scene.lighting.sunDirection / length : glm::vec3(0, 0, 1);
    impl_->poses = scene.vehicles;
    impl_->signalColours = scene.signalColours;
    impl_->mirrorSkylines.clear();
}

void SceneRenderer::setGlass(std::span<const city::GlassFront> fronts) {
    impl_->glassPass = fronts.empty() ? nullptr : std::make_unique<GlassPass>(fronts);
    impl_->frontBounds.clear();
    for (const city::GlassFront& front : fronts) impl_->frontBounds.push_back(front.bounds);
}

bool SceneRenderer::hides(const reflection::EyeView& from, const reflection::HalfSpace* glass,
                          const city::Aabb& box) const {
    const SkylineView* skyline = impl_->skylineFor(from, glass);
    return skyline != nullptr && skyline->hides(box);
}

void SceneRenderer::setDetail(const DrawingDetail& detail, int dissolveFrames) {
    impl_->detail = detail;
    impl_->standing.dissolveNext(dissolveFrames);
}

void SceneRenderer::prepareForChanges(glm::ivec2 size) {
    setDrawState();
    impl_->viewTarget.prepareDissolving(size);
    impl_->standing.forget();
}

bool SceneRenderer::drewLast(const View& view) const {
    return impl_->standing.drewLast({view.eye, view.clipFromView * view.viewFromWorld, 1}, view.size,
                                    impl_->lighting);
}

void SceneRenderer::drawView(const View& view, const VehicleReflections& reflections,
                             std::uint32_t framebuffer, const PlanarReflections& planar) {
    Impl& my = *impl_;
    my.counters = {};
    if (view.size.x <= 0 || view.size.y <= 0) return;
    my.updateShadow();
    setDrawState();
    my.standing.begin({view.eye, view.clipFromView * view.viewFromWorld, 1}, view.size, my.lighting,
                      my.viewTarget);
    my.viewTarget.begin(view.size, my.detail.scale);
    const float drawnShare = static_cast<float>(my.viewTarget.drawn().y) / static_cast<float>(view.size.y);
    PassView pass(view.eye, view.clipFromView * view.viewFromWorld, drawnShare * pixelsPerRadian(view));
    pass.skyline = my.skylineFor(pass);
    my.liveFronts.clear();
    if (planar.plan != nullptr) {
        const std::vector<bool>& mirrors = my.frontsBelow(*planar.plan, planar.root, nullptr);
        for (std::size_t i = 0; i < std::min(mirrors.size(), my.frontBounds.size()); ++i)
            if (mirrors[i]) my.liveFronts.push_back(my.frontBounds[i]);
    }
    my.standing.show(
        pass, my.poses, my.signalColours,
        [&](const vehicles::VehiclePose& pose) { return my.vehiclePass.boundsOf(pose); }, my.liveFronts,
        my.viewTarget);
    my.setFrame(pass);

    my.chosen.clear();
    for (const VisibleVehicle& v : my.visible(pass)) my.chosen.push_back(v.index);
    const VehiclePass::Counts vehicles =
        my.vehiclePass.draw(pass, PassTarget::view, my.poses, my.chosen,
                            {&reflections.textures, reflections.slots, reflections.mirrored},
                            static_cast<float>(my.detail.vehicleTolerance));
    const CityPass::Counts city = my.cityPass.draw(pass, PassTarget::view, foliageTolerance);
    const std::uint32_t lampCalls = my.signalLamps.draw(pass, PassTarget::view, my.signalColours);
    my.drawGlass(pass, reflections, planar);
    const std::uint32_t shadowCalls =
        my.options.shadows ? my.vehicleShadows.draw(pass, my.vehiclePass.geometry(), my.poses, my.chosen) : 0;
    my.drawSky(pass, PassTarget::view);

    my.viewTarget.finish(framebuffer, my.detail.antialiasing);

    my.counters.drawCalls += vehicles.drawCalls + city.drawCalls + lampCalls + shadowCalls + 1;
    my.counters.triangles += vehicles.triangles + city.triangles;
    my.counters.chunksDrawn = city.chunksDrawn;
    my.counters.chunksCulled = city.chunksCulled;
    my.counters.vehiclesDrawn = vehicles.vehicles;
}

void SceneRenderer::drawCube(const glm::dvec3& centre, const reflection::CubeTarget& target,
                             const reflection::CubeContent& content) {
    Impl& my = *impl_;
    if (target.colour == 0 || target.faceSize <= 0) return;
    my.updateShadow();
    setDrawState();
    my.cube.begin(target);
    std::optional<SkylineView> skyline;
    if (my.options.occlusionCulling) skyline.emplace(my.skyline, centre, cubeBeams, SkylineView::Sector{});
    for (int face = 0; face < 6; ++face) {
        my.cube.selectFace(face);
        PassView pass(centre, clipFromCubeFace(face, cubeNear), 0.5f * static_cast<float>(target.faceSize));
        pass.skyline = skyline ? &*skyline : nullptr;
        my.setFrame(pass, face);
        if (content.vehicles) {
            my.chosen.clear();
            for (std::uint32_t i = 0; i < my.poses.size(); ++i) {
                const vehicles::VehiclePose& pose = my.poses[i];
                if (pose.id == content.excludedVehicle ||
                    pose.model >= my.vehiclePass.geometry().models().size())
                    continue;
                if (pass.sees(my.vehiclePass.boundsOf(pose))) my.chosen.push_back(i);
            }
            my.vehiclePass.draw(pass, PassTarget::cube, my.poses, my.chosen, {}, cubeVehicleTolerance);
        }
        if (content.city) my.cityPass.draw(pass, PassTarget::cube, foliageTolerance);
        if (content.vehicles) my.signalLamps.draw(pass, PassTarget::cube, my.signalColours);
        my.drawSky(pass, PassTarget::cube);
    }
}

std::shared_ptr<const SunMap> SceneRenderer::sunMap() {
    impl_->updateShadow();
    return impl_->options.shadows ? impl_->shadow.read() : std::make_shared<const SunMap>();
}

const RenderCounters& SceneRenderer::counters() const {
    return impl_->counters;
}

std::vector<SceneRenderer::VisibleVehicle> SceneRenderer::visibleVehicles(const View& view) const {
    const Impl& my = *impl_;
    PassView pass(view.eye, view.clipFromView * view.viewFromWorld, pixelsPerRadian(view));
    pass.skyline = my.skylineFor(pass);
    return my.visible(pass);
}

std::vector<SceneRenderer::VisibleVehicle> SceneRenderer::visibleVehicles(
    const View& view, const PlanarReflections& planar) const {
    const Impl& my = *impl_;
    std::vector<VisibleVehicle> found = visibleVehicles(view);
    if (planar.plan == nullptr) return found;
    constexpr std::uint32_t unseen = 0xffffffffu;
    std::vector<std::uint32_t> place(my.poses.size(), unseen);
    for (std::uint32_t i = 0; i < found.size(); ++i) place[found[i].index] = i;
    for (const reflection::ReflectionNode& node : planar.plan->tree.nodes) {
        if (node.root != planar.root) continue;
        PassView pass = passOf(node, 0.5f);
        pass.skyline = my.skylineFor(node.view, &node.glass);
        for (const VisibleVehicle& v : my.visible(pass)) {
            if (place[v.index] == unseen) {
                place[v.index] = static_cast<std::uint32_t>(found.size());
                found.push_back(v);
            } else {
                float& most = found[place[v.index]].diameterPixels;
                most = std::max(most, v.diameterPixels);
            }
        }
    }
    return found;
}

}  // namespace app
