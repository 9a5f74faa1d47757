#include "app/render/MirrorWorldRenderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <glm/mat3x3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "app/mirrors/LitShapes.h"
#include "reflection/gl/Buffer.h"
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

struct Range {
    GLsizei count = 0;
    std::size_t first = 0;  ///< index
    const void* offset() const { return reinterpret_cast<const void*>(first * sizeof(std::uint32_t)); }
};

/// The scene's triangles in one pair of buffers.
struct Geometry {
    gl::Buffer vertices, indices;
    gl::VertexArray array;
    std::vector<Range> objects, mirrors, curved;
};

/// What draws one kind of surface, for straight and for bent projections, seen plainly or in mirrors that
/// fade. Compiled when first asked for: a rasteriser in software pays for a branch's lookups on both its
/// sides, so there are many and a scene needs few.
class Kind {
  public:
    explicit Kind(std::vector<std::string> defines) : defines_(std::move(defines)) {}
    const gl::Program& of(Projection p, bool faded) const {
        const bool bent = p != Projection::perspective;
        gl::Program& program = programs_[(bent ? 1u : 0u) + (faded ? 2u : 0u)];
        if (!program) {
            std::vector<std::string> all = defines_;
            if (bent) all.emplace_back("PARABOLOID");
            if (faded) all.emplace_back("FADED");
            program = gl::Program::fromFiles({"mirror_world.vert", "mirror_world.frag"}, all);
        }
        return program;
    }

  private:
    std::vector<std::string> defines_;
    mutable std::array<gl::Program, 4> programs_;
};

/// How mirrors on the way to an image fade what it shows: from its glass on, all of them.
struct Fading {
    double perMetre = 0;
    HalfSpace from{0, 0, 0, 1};
};

glm::vec3 withoutMap(const glm::vec3& tint, const glm::vec3& reflectance, const glm::vec3& beyond) {
    return tint * (1.f - reflectance) + reflectance * beyond;
}

LitMesh meshOf(const MirrorWorld::Flat& flat, const glm::vec3& colour) {
    LitMesh mesh;
    for (const glm::dvec3& c : flat.mirror.plane.corners())
        mesh.corners.push_back({glm::vec3(c), glm::vec3(flat.mirror.plane.normal()), colour});
    for (std::uint32_t i = 2; i < mesh.corners.size(); ++i)
        mesh.indices.insert(mesh.indices.end(), {0, i - 1, i});
    return mesh;
}

}  // namespace

struct MirrorWorldRenderer::Impl {
    Impl(const MirrorWorld& w, CurvedMaps c, bool p)
        : world(w), curvedMaps(c), parallax(p), plain(geometryOf(0)) {
        if (c == CurvedMaps::dualParaboloid) {
            // An edge may bend by some hundredths of its length at a distance of as much.
            fine.emplace(geometryOf(0.25f));
        }
        environment.resize(w.curved.size(), 0);
    }

    /// `longest`: edges are cut to that length; 0: left alone.
    Geometry geometryOf(float longest) const {
        Geometry g;
        std::vector<LitMesh::Corner> corners;
        std::vector<std::uint32_t> indices;
        const auto add = [&](const LitMesh& given) {
            const LitMesh mesh = longest > 0 ? subdivided(given, longest) : given;
            const Range range{static_cast<GLsizei>(mesh.indices.size()), indices.size()};
            const auto base = static_cast<std::uint32_t>(corners.size());
            corners.insert(corners.end(), mesh.corners.begin(), mesh.corners.end());
            for (std::uint32_t i : mesh.indices) indices.push_back(base + i);
            return range;
        };
        for (const LitMesh& m : world.objects) g.objects.push_back(add(m));
        for (const MirrorWorld::Flat& f : world.mirrors)
            g.mirrors.push_back(
                add(meshOf(f, withoutMap(f.tint, f.mirror.plane.surface().reflectance, world.beyond))));
        for (const MirrorWorld::Curved& c : world.curved) {
            LitMesh mesh = c.mesh;
            for (LitMesh::Corner& corner : mesh.corners)
                corner.colour = withoutMap(c.tint, c.reflector.surface.reflectance, world.beyond);
            g.curved.push_back(add(mesh));
        }
        g.vertices = gl::Buffer::filled(std::span<const LitMesh::Corner>(corners));
        g.indices = gl::Buffer::filled(std::span<const std::uint32_t>(indices));
        g.array = gl::VertexArray::create();
        g.array.buffer(0, g.vertices.name(), sizeof(LitMesh::Corner))
            .attribute(0, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, position))
            .attribute(1, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, normal))
            .attribute(2, 0, 3, GL_FLOAT, false, offsetof(LitMesh::Corner, colour))
            .indices(g.indices.name());
        return g;
    }

    const Geometry& geometry(const EyeView& view) const {
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

    /// The program of a kind, ready to draw into an image.
    const gl::Program& use(const Kind& kind, const EyeView& view, const glm::dmat4& clipFromView,
                           const HalfSpace& glass, const Fading& fading) const {
        const gl::Program& p = kind.of(view.projection, fading.perMetre > 0);
        if (fading.perMetre > 0) {
            p.set("fading", static_cast<float>(fading.perMetre));
            p.set("fadeFrom", glm::vec4(fading.from));
        }
        p.set("eye", glm::vec3(view.eye));
        p.set("clipFromRelative", glm::mat4(clipFromView * glm::dmat4(view.viewFromWorld)));
        p.set("viewFromRelative", glm::mat3(view.viewFromWorld));
        p.set("nearPlane", static_cast<float>(clipFromView[3][2]));
        p.set("keepNearness", parallax && face ? 1 : 0);
        p.set("glass", oblique ? glm::vec4(0, 0, 0, 1) : glm::vec4(glass));
        p.use();
        return p;
    }

    void draw(const Range& range) {
        glDrawElements(GL_TRIANGLES, range.count, GL_UNSIGNED_INT, range.offset());
        triangles += static_cast<std::uint64_t>(range.count / 3);
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
        const Geometry& g = geometry(view);
        g.array.bind();
        use(matte, view, clipFromView, glass, fading);
        counts.clear();
        offsets.clear();
        std::size_t end = 0;
        const auto list = [&](const Range& r) {
            triangles += static_cast<std::uint64_t>(r.count / 3);
            // Neighbours in the buffer are one draw: each costs a software rasteriser microseconds.
            if (!counts.empty() && r.first == end) {
                counts.back() += r.count;
            } else {
                counts.push_back(r.count);
                offsets.push_back(r.offset());
            }
            end = r.first + static_cast<std::size_t>(r.count);
        };
        for (std::uint32_t o : objects) list(g.objects[o]);
        for (std::size_t m = 0; m < g.mirrors.size(); ++m) {
            const reflection::MirrorPlane& plane = world.mirrors[m].mirror.plane;
            if (!flatApplied[m] && plane.signedDistance(view.eye) > 0 &&
                reflection::touches(frustum, plane.point() - view.eye, plane.radius()))
                list(g.mirrors[m]);
        }
        std::vector<std::uint32_t> shown;
        for (std::uint32_t c = 0; c < g.curved.size(); ++c) {
            const reflection::CurvedReflector& r = world.curved[c].reflector;
            if (c == hidden || curvedApplied[c] ||
                !reflection::touches(frustum, r.centre - view.eye, r.radius))
                continue;
            if (environment[c] != 0)
                shown.push_back(c);
            else
                list(g.curved[c]);
        }
        glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                            static_cast<GLsizei>(counts.size()));
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
                draw(g.curved[c]);
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
        const gl::Program& p = view.projection == Projection::perspective ? sky : skyBent;
        p.set("relativeFromView", glm::mat3(glm::transpose(view.viewFromWorld)));
        p.set("projection",
              glm::vec4(clipFromView[0][0], clipFromView[1][1], clipFromView[2][0], clipFromView[2][1]));
        p.set("keepNearness", parallax && face ? 1 : 0);
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
    bool face = false;  ///< an environment map's is being drawn
    Geometry plain;
    std::optional<Geometry> fine;
    Kind matte{{"MATTE"}}, flat{{"FLAT"}}, flatWithDistance{{"FLAT", "DISTANCE"}},
        rough{{"FLAT", "DISTANCE", "ROUGH"}}, bumped{{"FLAT", "DISTANCE", "BUMPED"}}, sphere{{"VIEW"}},
        curved{curvedDefines(curvedMaps, parallax, false)},
        roughCurved{curvedDefines(curvedMaps, parallax, true)};
    gl::Program sky = gl::Program::fromFiles({"mirror_sky.vert", "mirror_sky.frag"});
    gl::Program skyBent = gl::Program::fromFiles({"mirror_sky.vert", "mirror_sky.frag"}, {"PARABOLOID"});
    gl::VertexArray nothing = gl::VertexArray::create();
    std::vector<std::uint32_t> environment;
    std::vector<bool> flatApplied, curvedApplied;
    std::vector<GLsizei> counts;
    std::vector<const void*> offsets;
    std::uint64_t triangles = 0;
    bool oblique = false;
};

MirrorWorldRenderer::MirrorWorldRenderer(const MirrorWorld& world, CurvedMaps curved, bool parallax)
    : impl_(std::make_unique<Impl>(world, curved, parallax)) {}
MirrorWorldRenderer::~MirrorWorldRenderer() = default;

void MirrorWorldRenderer::setOblique(bool oblique) {
    impl_->oblique = oblique;
}

void MirrorWorldRenderer::drawRoot(const ReflectionTree& tree, std::uint32_t root, const MirrorTarget&) {
    const ReflectionRoot& r = tree.roots[root];
    glFrontFace(r.view.mirrored() ? GL_CW : GL_CCW);
    impl_->markRoot(tree, r);
    impl_->face = false;
    impl_->drawImage(r.view, r.view.clipFromView, {0, 0, 0, 1}, {}, tree.objectsOf(r), r.frustum, r.curved);
}

void MirrorWorldRenderer::drawNode(const ReflectionTree& tree, const ReflectionNode& node,
                                   const MirrorTarget&) {
    const auto index = static_cast<std::uint32_t>(&node - tree.nodes.data());
    impl_->markApplied(tree, [&](const ReflectionNode& n) { return n.parent == index; });
    impl_->face = false;
    impl_->drawImage(node.view, impl_->oblique ? node.obliqueClipFromView : node.clipFromView, node.glass,
                     impl_->fadingOf(tree, &node), tree.objectsOf(node), node.frustum, node.hiddenCurved);
}

void MirrorWorldRenderer::drawFace(const ReflectionTree& tree, const ReflectionRoot& face,
                                   const MirrorTarget&) {
    impl_->markRoot(tree, face);
    impl_->face = true;
    impl_->drawImage(face.view, face.view.clipFromView, {0, 0, 0, 1}, {}, tree.objectsOf(face), face.frustum,
                     face.curved);
}

void MirrorWorldRenderer::finishRoot(const ReflectionTree& tree, std::uint32_t root) {
    impl_->face = false;
    impl_->drawSky(tree.roots[root].view, tree.roots[root].view.clipFromView, false);
}

void MirrorWorldRenderer::finishNode(const ReflectionTree& tree, const ReflectionNode& node,
                                     const MirrorTarget&) {
    impl_->face = false;
    impl_->drawSky(node.view, impl_->oblique ? node.obliqueClipFromView : node.clipFromView,
                   impl_->fadingOf(tree, &node).perMetre > 0);
}

void MirrorWorldRenderer::finishFace(const ReflectionTree&, const ReflectionRoot& face, const MirrorTarget&) {
    impl_->face = true;
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
    my.face = parent == nullptr && tree.roots[node.root].isEnvironment();
    // The image in which the reflector is met.
    const EyeView& view = parent != nullptr ? parent->view : tree.roots[node.root].view;
    const glm::dmat4& clip = parent == nullptr ? view.clipFromView
                             : my.oblique      ? parent->obliqueClipFromView
                                               : parent->clipFromView;
    const HalfSpace glass = parent != nullptr ? parent->glass : HalfSpace(0, 0, 0, 1);
    const Fading fading = my.fadingOf(tree, parent);
    const Geometry& g = my.geometry(view);
    g.array.bind();
    glBindTextureUnit(8, map.colour);
    if (!node.planar()) {
        const gl::Program& p = my.use(my.sphere, view, clip, glass, fading);
        p.set("mapFromRelative", glm::mat3(node.view.viewFromWorld));
        p.set("mapScale", static_cast<float>(node.clipFromView[0][0]));
        const glm::vec2 low = glm::vec2(map.uvLimits) - 0.5f / map.texels;
        p.set("mapPart", glm::vec4(glm::vec2(node.resolution) / map.texels, low));
        p.set("mapLimits", map.uvLimits);
        p.set("reflectance", my.world.curved[node.curved].reflector.surface.reflectance);
        p.set("tint", my.world.curved[node.curved].tint);
        my.draw(g.curved[node.curved]);
        return;
    }
    const auto isBumped = [&](std::uint32_t m) { return my.world.mirrors[m].ripples.any(); };
    const bool bumped = map.distance != 0 && std::ranges::any_of(tree.mirrorsOf(node), isBumped);
    const gl::Program& p = my.use(map.blurred != 0    ? my.rough
                                  : bumped            ? my.bumped
                                  : map.distance != 0 ? my.flatWithDistance
                                                      : my.flat,
                                  view, clip, glass, fading);
    p.set("uvFromFragment", map.uvFromFragment);
    p.set("uvLimits", map.uvLimits);
    p.set("blurredScale", map.blurredScale);
    p.set("addDistance", target.withDistance && map.distance != 0 ? 1 : 0);
    glBindTextureUnit(9, map.blurred);
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
    const Geometry& g = impl_->geometry(view);
    g.array.bind();
    impl_->use(impl_->matte, view, clipFromView, glass, {});
    // A constant in place of the corners' colours.
    glDisableVertexArrayAttrib(g.array.name(), 2);
    glVertexAttrib3f(2, colour.r, colour.g, colour.b);
    impl_->draw(g.mirrors[mirror]);
    glEnableVertexArrayAttrib(g.array.name(), 2);
}

std::uint64_t MirrorWorldRenderer::trianglesDrawn() const {
    return impl_->triangles;
}

}  // namespace app
