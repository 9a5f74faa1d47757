#include "app/render/MirrorWorldRenderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <glm/mat3x3.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "app/render/MirrorWorldGeometry.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/Gloss.h"

namespace app {

namespace gl = reflection::gl;
using reflection::CurvedMaps;
using reflection::EyeView;
using reflection::HalfSpace;
using reflection::MirrorTarget;
using reflection::Projection;
using reflection::ReflectionNode;
using reflection::ReflectionRoot;
using reflection::ReflectionTree;

namespace {

/// What draws one kind of surface, for straight and for bent projections, seen plainly or in mirrors that
/// fade. Compiled when first asked for: a rasteriser in software pays for a branch's lookups on both its
/// sides, so there are many and a scene needs few.
class Kind {
  public:
    explicit Kind(std::vector<std::string> defines, std::string_view vertices = "mirror_world.vert",
                  std::string_view fragments = "mirror_world.frag")
        : defines_(std::move(defines)), vertices_(vertices), fragments_(fragments) {}
    const gl::Program& of(Projection p, bool faded, bool layered, bool nearness) const {
        const bool bent = p != Projection::perspective;
        gl::Program& program =
            programs_[(bent ? 1u : 0u) + (faded ? 2u : 0u) + (layered ? 4u : 0u) + (nearness ? 8u : 0u)];
        if (!program) {
            std::vector<std::string> all = defines_;
            if (bent) all.emplace_back("PARABOLOID");
            if (faded) all.emplace_back("FADED");
            if (layered) all.emplace_back("LAYERED");
            if (nearness) all.emplace_back("NEARNESS");
            program = gl::Program::fromFiles({vertices_, fragments_}, all);
        }
        return program;
    }

  private:
    std::vector<std::string> defines_;
    std::string_view vertices_, fragments_;
    mutable std::array<gl::Program, 16> programs_;
};

/// How mirrors on the way to an image fade what it shows: from its glass on, all of them.
struct Fading {
    double perMetre = 0;
    HalfSpace from{0, 0, 0, 1};
};

}  // namespace

struct MirrorWorldRenderer::Impl {
    Impl(const MirrorWorld& w, CurvedMaps c, bool p) : world(w), curvedMaps(c), parallax(p), plain(w, 0) {
        if (c == CurvedMaps::dualParaboloid) {
            // An edge may bend by some hundredths of its length at a distance of as much.
            fine.emplace(w, 0.25f);
        }
        environment.resize(w.curved.size(), 0);
    }

    /// The objects of a list that a reflector's environment map holds.
    std::span<const std::uint32_t> heldBy(std::uint32_t curvedIndex, std::span<const std::uint32_t> objects) {
        if (curvedIndex >= leftOut.size() || leftOut[curvedIndex].empty()) return objects;
        held.clear();
        for (const std::uint32_t o : objects)
            if (!leftOut[curvedIndex][o]) held.push_back(o);
        return held;
    }

    bool leftOutOfFace(std::uint32_t ofMap, std::uint32_t c) const {
        return face && ofMap < curvedLeftOut.size() && !curvedLeftOut[ofMap].empty() &&
               curvedLeftOut[ofMap][c];
    }

    const MirrorWorldGeometry& geometry(const EyeView& view) const {
        return view.projection == Projection::paraboloid && fine ? *fine : plain;
    }

    void setState() const {
        glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
        glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GEQUAL);
        glDepthMask(GL_TRUE);
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
        glDisable(GL_BLEND);
        glEnable(GL_CLIP_DISTANCE0);
        glEnable(GL_CLIP_DISTANCE1);
    }

    void into(bool environmentFace, int targetLayer) {
        face = environmentFace;
        layer = targetLayer;
    }

    /// The program of a kind, ready to draw into an image.
    const gl::Program& use(const Kind& kind, const EyeView& view, const glm::dmat4& clipFromView,
                           const HalfSpace& glass, const Fading& fading) const {
        const gl::Program& p =
            kind.of(view.projection, fading.perMetre > 0, layer != MirrorTarget::none, parallax && face);
        p.set("layer", layer);
        if (fading.perMetre > 0) {
            p.set("fading", static_cast<float>(fading.perMetre));
            p.set("fadeFrom", glm::vec4(fading.from));
        }
        p.set("eye", glm::vec3(view.eye));
        p.set("clipFromRelative", glm::mat4(clipFromView * glm::dmat4(view.viewFromWorld)));
        p.set("viewFromRelative", glm::mat3(view.viewFromWorld));
        p.set("nearPlane", static_cast<float>(clipFromView[3][2]));
        p.set("glass", oblique ? glm::vec4(0, 0, 0, 1) : glm::vec4(glass));
        p.use();
        return p;
    }

    /// What an eye sees of a range; all of it where nothing is culled.
    void listSeen(const MirrorWorldGeometry::Range& r, const glm::dvec3& eye,
                  const reflection::HalfSpaces& frustum) {
        if (clusters)
            list.addSeen(r, eye, frustum);
        else
            list.add(r);
    }
    void draw(const MirrorWorldGeometry::Range& range) {
        list.add(range);
        list.draw();
    }

    /// Each mirror on the way fades all that it shows, what other mirrors show in it included.
    Fading fadingOf(const ReflectionTree& tree, const ReflectionNode* node) const {
        Fading fading;
        if (node == nullptr) return fading;
        if (node->planar()) fading.from = node->glass;
        for (;;) {
            double own = 0;
            for (const std::uint32_t m : tree.mirrorsOf(*node))
                if (world.mirrors[m].fade > 0) own = std::max(own, 1 / world.mirrors[m].fade);
            fading.perMetre += own;
            if (node->parent == ReflectionNode::none) return fading;
            node = &tree.nodes[node->parent];
        }
    }

    /// Marks what is drawn from a map later: the reflectors of those nodes that are met in the image.
    template <class IsMet>
    void markApplied(const ReflectionTree& tree, IsMet&& isMet) {
        flatApplied.assign(world.mirrors.size(), false);
        curvedApplied.assign(world.curved.size(), false);
        for (const ReflectionNode& n : tree.nodes) {
            if (!isMet(n)) continue;
            for (const std::uint32_t m : tree.mirrorsOf(n)) flatApplied[m] = true;
            if (!n.planar()) curvedApplied[n.curved] = true;
        }
    }
    void markRoot(const ReflectionTree& tree, const ReflectionRoot& root) {
        const auto index = static_cast<std::uint32_t>(&root - tree.roots.data());
        markApplied(tree, [&](const ReflectionNode& n) {
            return n.root == index && n.parent == ReflectionNode::none;
        });
    }

    void drawImage(const EyeView& view, const glm::dmat4& clipFromView, const HalfSpace& glass,
                   const Fading& fading, std::span<const std::uint32_t> objects,
                   const reflection::HalfSpaces& frustum, std::uint32_t hidden) {
        setState();
        const MirrorWorldGeometry& g = geometry(view);
        g.bind();
        use(matte, view, clipFromView, glass, fading);
        const auto show = [&](const MirrorWorldGeometry::Range& r) { listSeen(r, view.eye, frustum); };
        for (std::uint32_t o : objects) show(g.objects[o]);
        for (std::size_t m = 0; m < g.mirrors.size(); ++m) {
            const reflection::MirrorPlane& plane = world.mirrors[m].mirror.plane;
            if (!flatApplied[m] && plane.signedDistance(view.eye) > 0 &&
                reflection::touches(frustum, plane.point() - view.eye, plane.radius()))
                show(g.mirrors[m]);
        }
        std::vector<std::uint32_t> shown;
        for (std::uint32_t c = 0; c < g.curved.size(); ++c) {
            const reflection::CurvedReflector& r = world.curved[c].reflector;
            if (c == hidden || curvedApplied[c] || leftOutOfFace(hidden, c) ||
                !reflection::touches(frustum, r.centre - view.eye, r.radius))
                continue;
            if (environment[c] != 0)
                shown.push_back(c);
            else
                show(g.curved[c]);
        }
        list.draw();
        if (!shown.empty()) {
            for (std::uint32_t c : shown) {
                const reflection::MirrorSurface& surface = world.curved[c].reflector.surface;
                const gl::Program& p =
                    use(surface.roughness > 0 ? roughCurved : curved, view, clipFromView, glass, fading);
                glBindTextureUnit(8, environment[c]);
                p.set("reflectance", surface.reflectance);
                p.set("tint", world.curved[c].tint);
                p.set("glossAngle",
                      static_cast<float>(reflection::glossAngle(static_cast<double>(surface.roughness))));
                p.set("mapCentre", glm::vec3(world.curved[c].reflector.centre - view.eye));
                show(g.curved[c]);
                list.draw();
            }
        }
    }

    static std::vector<std::string> curvedDefines(CurvedMaps maps, bool parallax, bool rough) {
        std::vector<std::string> defines{maps == CurvedMaps::dualParaboloid ? "PAIR" : "CUBE"};
        if (parallax) defines.emplace_back("PARALLAX");
        if (rough) defines.emplace_back("ROUGH");
        return defines;
    }

    void drawSky(const EyeView& view, const glm::dmat4& clipFromView, bool faded) const {
        setState();
        const gl::Program& p = sky.of(view.projection, false, layer != MirrorTarget::none, parallax && face);
        p.set("layer", layer);
        p.set("relativeFromView", glm::mat3(glm::transpose(view.viewFromWorld)));
        p.set("projection",
              glm::vec4(clipFromView[0][0], clipFromView[1][1], clipFromView[2][0], clipFromView[2][1]));
        // Infinitely far, nothing is left of it.
        p.set("zenith", faded ? glm::vec3(0) : world.zenith);
        p.set("horizon", faded ? glm::vec3(0) : world.horizon);
        p.set("nadir", faded ? glm::vec3(0) : world.nadir);
        p.use();
        glDisable(GL_CULL_FACE);
        glDisable(GL_CLIP_DISTANCE0);
        glDisable(GL_CLIP_DISTANCE1);
        nothing.bind();
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    const MirrorWorld& world;
    CurvedMaps curvedMaps;
    bool parallax;
    bool face = false;               ///< an environment map's is being drawn
    int layer = MirrorTarget::none;  ///< of the target
    MirrorWorldGeometry plain;
    std::optional<MirrorWorldGeometry> fine;
    Kind matte{{"MATTE"}}, flat{{"FLAT"}}, flatWithDistance{{"FLAT", "DISTANCE"}},
        rough{{"FLAT", "DISTANCE", "ROUGH"}}, glossed{{"FLAT", "DISTANCE", "GLOSSED"}},
        bumped{{"FLAT", "DISTANCE", "BUMPED"}}, sphere{{"VIEW"}}, roughSphere{{"VIEW", "ROUGH"}},
        curved{curvedDefines(curvedMaps, parallax, false)},
        roughCurved{curvedDefines(curvedMaps, parallax, true)};
    Kind sky{{}, "mirror_sky.vert", "mirror_sky.frag"};
    gl::VertexArray nothing = gl::VertexArray::create();
    std::vector<std::uint32_t> environment;
    std::vector<bool> flatApplied, curvedApplied;
    std::vector<std::vector<bool>> leftOut, curvedLeftOut;
    std::vector<std::uint32_t> held;
    MirrorDrawList list;
    bool clusters = true;
    std::uint64_t triangles = 0;
    bool oblique = false;
};

MirrorWorldRenderer::MirrorWorldRenderer(const MirrorWorld& world, CurvedMaps curved, bool parallax)
    : impl_(std::make_unique<Impl>(world, curved, parallax)) {}
MirrorWorldRenderer::~MirrorWorldRenderer() = default;

bool MirrorWorldRenderer::canDrawLayers() {
    return epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array");
}

void MirrorWorldRenderer::setClusters(bool clusters) {
    impl_->clusters = clusters;
}

void MirrorWorldRenderer::setLeftOut(std::size_t curved, std::vector<bool> objects,
                                     std::vector<bool> others) {
    impl_->leftOut.resize(impl_->world.curved.size());
    impl_->leftOut[curved] = std::move(objects);
    impl_->curvedLeftOut.resize(impl_->world.curved.size());
    impl_->curvedLeftOut[curved] = std::move(others);
}

std::span<const std::uint32_t> MirrorWorldRenderer::environments() const {
    return impl_->environment;
}

void MirrorWorldRenderer::setOblique(bool oblique) {
    impl_->oblique = oblique;
}

void MirrorWorldRenderer::drawRoot(const ReflectionTree& tree, std::uint32_t root, const MirrorTarget&) {
    const ReflectionRoot& r = tree.roots[root];
    glFrontFace(r.view.mirrored() ? GL_CW : GL_CCW);
    impl_->markRoot(tree, r);
    impl_->into(false, MirrorTarget::none);
    impl_->drawImage(r.view, r.view.clipFromView, {0, 0, 0, 1}, {}, tree.objectsOf(r), r.frustum, r.curved);
}

void MirrorWorldRenderer::drawNode(const ReflectionTree& tree, const ReflectionNode& node,
                                   const MirrorTarget&) {
    const auto index = static_cast<std::uint32_t>(&node - tree.nodes.data());
    impl_->markApplied(tree, [&](const ReflectionNode& n) { return n.parent == index; });
    impl_->into(false, MirrorTarget::none);
    impl_->drawImage(node.view, impl_->oblique ? node.obliqueClipFromView : node.clipFromView, node.glass,
                     impl_->fadingOf(tree, &node), tree.objectsOf(node), node.frustum, node.hiddenCurved);
}

void MirrorWorldRenderer::drawFace(const ReflectionTree& tree, const ReflectionRoot& face,
                                   const MirrorTarget& target) {
    impl_->markRoot(tree, face);
    impl_->into(true, target.layer);
    impl_->drawImage(face.view, face.view.clipFromView, {0, 0, 0, 1}, {},
                     impl_->heldBy(face.curved, tree.objectsOf(face)), face.frustum, face.curved);
}

void MirrorWorldRenderer::finishRoot(const ReflectionTree& tree, std::uint32_t root) {
    impl_->into(false, MirrorTarget::none);
    impl_->drawSky(tree.roots[root].view, tree.roots[root].view.clipFromView, false);
}

void MirrorWorldRenderer::finishNode(const ReflectionTree& tree, const ReflectionNode& node,
                                     const MirrorTarget&) {
    impl_->into(false, MirrorTarget::none);
    impl_->drawSky(node.view, impl_->oblique ? node.obliqueClipFromView : node.clipFromView,
                   impl_->fadingOf(tree, &node).perMetre > 0);
}

void MirrorWorldRenderer::finishFace(const ReflectionTree&, const ReflectionRoot& face,
                                     const MirrorTarget& target) {
    impl_->into(true, target.layer);
    impl_->drawSky(face.view, face.view.clipFromView, false);
}

void MirrorWorldRenderer::publish(const reflection::EnvironmentJob& job, std::uint32_t texture) {
    impl_->environment[job.curved] = texture;
}

void MirrorWorldRenderer::applyNode(const ReflectionTree& tree, const ReflectionNode& node,
                                    const reflection::MirrorMap& map, const ReflectionNode* parent,
                                    const MirrorTarget& target) {
    Impl& my = *impl_;
    my.setState();
    my.into(parent == nullptr && tree.roots[node.root].isEnvironment(), target.layer);
    // The image in which the reflector is met.
    const EyeView& view = parent != nullptr ? parent->view : tree.roots[node.root].view;
    const glm::dmat4& clip = parent == nullptr ? view.clipFromView
                             : my.oblique      ? parent->obliqueClipFromView
                                               : parent->clipFromView;
    const HalfSpace glass = parent != nullptr ? parent->glass : HalfSpace(0, 0, 0, 1);
    const Fading fading = my.fadingOf(tree, parent);
    const MirrorWorldGeometry& g = my.geometry(view);
    g.bind();
    glBindTextureUnit(8, map.colour);
    if (!node.planar()) {
        const gl::Program& p =
            my.use(map.blurred != 0 ? my.roughSphere : my.sphere, view, clip, glass, fading);
        glBindTextureUnit(9, map.blurred);
        p.set("blurredScale", map.blurredScale);
        p.set("uvLimits", map.uvLimits);
        p.set("blurLevels", map.blurLevels);
        p.set("glossAngle", static_cast<float>(reflection::glossAngle(static_cast<double>(node.roughness))));
        p.set("mapFromRelative", glm::mat3(node.view.viewFromWorld));
        p.set("mapScale", static_cast<float>(node.clipFromView[0][0]));
        const glm::vec2 low = glm::vec2(map.uvLimits) - 0.5f / map.texels;
        p.set("mapPart", glm::vec4(glm::vec2(node.resolution) / map.texels, low));
        p.set("mapLimits", map.uvLimits);
        p.set("reflectance", my.world.curved[node.curved].reflector.surface.reflectance);
        p.set("tint", my.world.curved[node.curved].tint);
        my.listSeen(g.curved[node.curved], view.eye,
                    parent != nullptr ? parent->frustum : tree.roots[node.root].frustum);
        my.list.draw();
        return;
    }
    const auto isBumped = [&](std::uint32_t m) { return my.world.mirrors[m].ripples.any(); };
    const bool bumped = map.distance != 0 && std::ranges::any_of(tree.mirrorsOf(node), isBumped);
    const auto isNodes = [&](std::uint32_t m) {
        return my.world.mirrors[m].mirror.plane.surface().roughness == node.roughness;
    };
    const bool glossed = map.glossed != 0 && std::ranges::all_of(tree.mirrorsOf(node), isNodes);
    const gl::Program& p = my.use(glossed             ? my.glossed
                                  : map.blurred != 0  ? my.rough
                                  : bumped            ? my.bumped
                                  : map.distance != 0 ? my.flatWithDistance
                                                      : my.flat,
                                  view, clip, glass, fading);
    p.set("uvFromFragment", map.uvFromFragment);
    p.set("uvLimits", map.uvLimits);
    p.set("blurredScale", map.blurredScale);
    p.set("addDistance", target.withDistance && map.distance != 0 ? 1 : 0);
    glBindTextureUnit(9, glossed ? map.glossed : map.blurred);
    glBindTextureUnit(10, map.distance);
    p.set("blurLevels", map.blurLevels);
    p.set("uvPerTangent", 0.5f * glm::vec2(target.viewport.size()) *
                              glm::vec2(map.uvFromFragment.x * static_cast<float>(clip[0][0]),
                                        map.uvFromFragment.y * static_cast<float>(clip[1][1])));
    for (std::uint32_t m : tree.mirrorsOf(node)) {
        const reflection::MirrorPlane& plane = my.world.mirrors[m].mirror.plane;
        p.set("reflectance", plane.surface().reflectance);
        p.set("tint", my.world.mirrors[m].tint);
        p.set("mirrorNormal", glm::vec3(plane.normal()));
        const MirrorWorld::Flat& flat = my.world.mirrors[m];
        if (bumped) {
            const RippleFrame frame(plane.normal());
            p.set("rippleU", glm::vec3(frame.u));
            p.set("rippleV", glm::vec3(frame.v));
            p.set("ripples", glm::vec2(flat.ripples.slope, flat.ripples.wavelength));
        }
        p.set("glossAngle", static_cast<float>(reflection::glossAngle(plane.surface().roughness)));
        my.draw(g.mirrors[m]);
    }
}

void MirrorWorldRenderer::drawMirrorShape(std::uint32_t mirror, const EyeView& view,
                                          const glm::dmat4& clipFromView, const HalfSpace& glass,
                                          const glm::vec3& colour) {
    const MirrorWorldGeometry& g = impl_->geometry(view);
    g.bind();
    impl_->use(impl_->matte, view, clipFromView, glass, {});
    // A constant in place of the corners' colours.
    glDisableVertexArrayAttrib(g.arrayName(), 2);
    glVertexAttrib3f(2, colour.r, colour.g, colour.b);
    impl_->draw(g.mirrors[mirror]);
    glEnableVertexArrayAttrib(g.arrayName(), 2);
}

std::uint64_t MirrorWorldRenderer::trianglesDrawn() const {
    return impl_->list.trianglesDrawn();
}

}  // namespace app
