#include "app/render/MirrorWorldChrome.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <map>
#include <optional>

#include "app/mirrors/LitShapes.h"
#include "reflection/chrome/ReflectorPieces.h"
#include "reflection/gl/ChromeLayer.h"
#include "reflection/gl/ChromeSearchMesh.h"
#include "reflection/gl/Program.h"

namespace app {

namespace gl = reflection::gl;

namespace {

/// An object farther from a reflector than so many of its radii is left to the environment map: seen from all
/// over the reflector its direction differs by less than one part in so many.
constexpr double closeRadii = 12;

/// An object's corners, each place and colour once: triangles that meet without a crease share searches.
struct Welded {
    std::vector<glm::vec3> positions;
    std::vector<float> colours;
    std::vector<std::uint32_t> indices;
};

Welded weld(const LitMesh& mesh) {
    Welded out;
    std::map<std::array<float, 6>, std::uint32_t> known;
    std::vector<std::uint32_t> ids;
    for (const LitMesh::Corner& c : mesh.corners) {
        const glm::vec3 &p = c.position, &l = c.colour;
        const auto [at, added] = known.try_emplace({p.x, p.y, p.z, l.r, l.g, l.b},
                                                   static_cast<std::uint32_t>(out.positions.size()));
        if (added) {
            out.positions.push_back(p);
            out.colours.insert(out.colours.end(), {l.r, l.g, l.b});
        }
        ids.push_back(at->second);
    }
    for (const std::uint32_t i : mesh.indices) out.indices.push_back(ids[i]);
    return out;
}

double distanceTo(const city::Aabb& box, const glm::dvec3& p) {
    return glm::length(glm::max(glm::max(glm::dvec3(box.min) - p, p - glm::dvec3(box.max)), glm::dvec3(0)));
}

/// The pixels in which a ball may be seen; all where the eye is close to it.
reflection::PixelRect pixelsOf(const reflection::EyeView& view, const glm::ivec2& size,
                               const glm::dvec3& centre, double radius) {
    const reflection::PixelRect all{glm::ivec2(0), size};
    const glm::dvec3 c = glm::dmat3(view.viewFromWorld) * (centre - view.eye);
    if (c.z > radius) return {glm::ivec2(0), glm::ivec2(0)};
    if (-c.z <= 1.1 * radius) return all;
    // The box around the ball, at its nearest depth.
    glm::dvec2 low(1e9), high(-1e9);
    for (const double z : {c.z + radius, c.z - radius})
        for (const double x : {c.x - radius, c.x + radius})
            for (const double y : {c.y - radius, c.y + radius}) {
                const glm::dvec4 clip = view.clipFromView * glm::dvec4(x, y, z, 1);
                const glm::dvec2 p = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(size);
                low = glm::min(low, p), high = glm::max(high, p);
            }
    const auto inside = [&](const glm::dvec2& p) {
        return glm::ivec2(glm::clamp(p, glm::dvec2(0), glm::dvec2(size)));
    };
    return {inside(glm::floor(low)), inside(glm::ceil(high))};
}

/// Whether some triangle shows the eye its front.
bool faces(const city::Mesh& mesh, const glm::vec3& eye) {
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const glm::vec3& a = mesh.vertices[mesh.indices[k]].position;
        const glm::vec3& b = mesh.vertices[mesh.indices[k + 1]].position;
        const glm::vec3& c = mesh.vertices[mesh.indices[k + 2]].position;
        if (glm::dot(glm::cross(b - a, c - a), eye - a) > 0) return true;
    }
    return false;
}

}  // namespace

struct MirrorWorldChrome::Impl {
    struct Object {
        std::size_t index;
        reflection::VirtualMesh mesh;
        std::optional<gl::ChromeMesh> drawn;
    };
    struct Piece {
        reflection::ReflectorPiece piece;
        std::vector<Object> objects;
        gl::Buffer vertices, indices;
        gl::VertexArray array;
        std::optional<reflection::ChromeSearchMesh> onGpu;  ///< all objects, where the GPU searches
    };
    struct Chrome {
        std::vector<bool> close;
        std::vector<Piece> pieces;
    };

    const MirrorWorld& world;
    reflection::VirtualMeshOptions options;
    std::vector<Chrome> chrome;
    std::vector<Welded> objects;  ///< the world's
    std::optional<gl::ChromeLayer> layer;
    gl::Program virtualObjects, apply;
    bool searchOnGpu = false;
    std::optional<reflection::ChromeSearch> search;
    gl::Program searched;  ///< draws what the GPU has searched for

    void makeGlObjects() {
        if (layer) return;
        layer.emplace();
        virtualObjects = gl::Program::fromFiles({"chrome.vert", "chrome.frag"});
        if (searchOnGpu) {
            search.emplace();
            searched = gl::Program::fromFiles({"chrome.vert", "chrome.frag"}, {"WITH_STATUS"});
        }
        apply = gl::Program::fromFiles({"mirror_world.vert", "chrome_apply.frag"});
        for (Chrome& c : chrome)
            for (Piece& p : c.pieces) {
                p.vertices = gl::Buffer::filled(std::span<const city::Vertex>(p.piece.mesh.vertices));
                p.indices = gl::Buffer::filled(std::span<const std::uint32_t>(p.piece.mesh.indices));
                p.array = gl::VertexArray::create();
                p.array.buffer(0, p.vertices.name(), sizeof(city::Vertex))
                    .attribute(0, 0, 3, GL_FLOAT, false, offsetof(city::Vertex, position))
                    .indices(p.indices.name());
                for (Object& o : p.objects) o.drawn.emplace(std::vector<int>{3});
                // On concave pieces images tear, which the processor's meshes find and leave out.
                if (!searchOnGpu || p.piece.bend == reflection::Bend::concave) continue;
                p.onGpu.emplace(p.piece.built.map, 3);
                for (const Object& o : p.objects) {
                    const Welded& object = objects[o.index];
                    p.onGpu->add(object.positions, object.indices, object.colours);
                }
            }
    }
};

MirrorWorldChrome::MirrorWorldChrome(const MirrorWorld& world, const reflection::VirtualMeshOptions& options,
                                     bool concave)
    : impl_(new Impl{world, options, {}, {}, {}, {}, {}, false, {}, {}}) {
    std::vector<Welded>& objects = impl_->objects;
    for (const LitMesh& m : world.objects) objects.push_back(weld(m));
    for (const MirrorWorld::Curved& curved : world.curved) {
        Impl::Chrome& chrome = impl_->chrome.emplace_back();
        chrome.close.assign(world.objects.size(), false);
        if (curved.reflector.surface.roughness > 0) continue;
        for (std::size_t o = 0; o < world.objects.size(); ++o)
            chrome.close[o] = distanceTo(world.objects[o].bounds(), curved.reflector.centre) <
                              (closeRadii + 1) * curved.reflector.radius;
        // Drawn is what has been drawn before, depth by depth: the finer surface only where it is one piece.
        reflection::Reflector reflector = reflection::makeReflector(withoutLight(curved.finest()));
        if (reflector.pieces.size() == 1)
            reflector.pieces.front().mesh = withoutLight(curved.mesh);
        else
            reflector = reflection::makeReflector(withoutLight(curved.mesh));
        for (reflection::ReflectorPiece& piece : reflector.pieces) {
            if (piece.built.map.empty()) continue;
            if (!concave && piece.bend == reflection::Bend::concave) continue;
            Impl::Piece& made = chrome.pieces.emplace_back();
            made.piece = std::move(piece);
            for (std::size_t o = 0; o < world.objects.size(); ++o) {
                if (!chrome.close[o]) continue;
                made.objects.push_back(
                    {o, reflection::VirtualMesh(objects[o].positions, objects[o].indices, options), {}});
            }
        }
        if (chrome.pieces.empty()) chrome.close.assign(world.objects.size(), false);
    }
}
MirrorWorldChrome::~MirrorWorldChrome() = default;

void MirrorWorldChrome::searchOnGpu() {
    impl_->searchOnGpu = true;
}

const std::vector<bool>& MirrorWorldChrome::closeTo(std::size_t curved) const {
    return impl_->chrome[curved].close;
}

ChromeFrame MirrorWorldChrome::draw(const reflection::EyeView& view, const glm::ivec2& size,
                                    std::uint32_t framebuffer) {
    Impl& my = *impl_;
    my.makeGlObjects();
    ChromeFrame frame;
    const glm::mat4 clip(view.clipFromView * glm::dmat4(view.viewFromWorld));
    glFrontFace(view.mirrored() ? GL_CW : GL_CCW);
    for (std::size_t c = 0; c < my.chrome.size(); ++c) {
        const reflection::CurvedReflector& reflector = my.world.curved[c].reflector;
        const reflection::PixelRect pixels = pixelsOf(view, size, reflector.centre, reflector.radius);
        const bool nothingClose = std::none_of(my.chrome[c].close.begin(), my.chrome[c].close.end(),
                                               [](bool close) { return close; });
        if (my.chrome[c].pieces.empty() || nothingClose || pixels.size().x <= 0 || pixels.size().y <= 0)
            continue;
        reflection::VirtualMeshOptions options = my.options;
        const glm::dvec3 towards = reflector.centre - view.eye;
        const double distance = glm::length(towards);
        if (distance > 1.1 * reflector.radius) {
            const double sine = reflector.radius / distance;
            options.towards = towards / distance;
            options.coneCosine = std::sqrt(1 - sine * sine);
        }
        for (Impl::Piece& p : my.chrome[c].pieces) {
            if (!faces(p.piece.mesh, glm::vec3(view.eye))) continue;
            ++frame.jobs;
            const auto start = std::chrono::steady_clock::now();
            if (p.onGpu) {
                p.onGpu->update(*my.search, view.eye);
                frame.meshes += p.objects.size();
                frame.vertices += p.onGpu->vertexCount();
                frame.searched += p.onGpu->vertexCount();
                frame.triangles += p.onGpu->triangleCount();
            }
            for (Impl::Object& o : p.objects) {
                if (p.onGpu) break;
                const reflection::VirtualCounts counts =
                    o.mesh.update(p.piece.built.map, view.eye, glm::dmat4(1), options);
                ++frame.meshes;
                frame.vertices += o.mesh.vertices().size();
                frame.searched += counts.searched;
                frame.lookups += counts.lookups;
                frame.triangles += o.mesh.indices().size() / 3;
            }
            frame.searchMilliseconds +=
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
            my.layer->begin(size, pixels);
            // Mirrored once: what is seen of an object's front has turned round.
            glDisable(GL_CULL_FACE);
            glDisable(GL_CLIP_DISTANCE0);
            glDisable(GL_CLIP_DISTANCE1);
            const gl::Program& program = p.onGpu ? my.searched : my.virtualObjects;
            program.set("clipFromVirtual", clip);
            program.use();
            if (p.onGpu) p.onGpu->draw();
            for (Impl::Object& o : p.objects) {
                if (p.onGpu) break;
                o.drawn->upload(o.mesh, my.objects[o.index].colours);
                o.drawn->draw();
            }
            glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
            glDepthMask(GL_FALSE);
            glEnable(GL_BLEND);
            glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
            glEnable(GL_CULL_FACE);
            glCullFace(GL_BACK);
            my.apply.set("eye", glm::vec3(view.eye));
            my.apply.set("clipFromRelative", clip);
            my.apply.set("glass", glm::vec4(0, 0, 0, 1));
            my.apply.set("reflectance", reflector.surface.reflectance);
            my.apply.set("tint", my.world.curved[c].tint);
            my.apply.use();
            glBindTextureUnit(11, my.layer->colour());
            p.array.bind();
            glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(p.piece.mesh.indices.size()), GL_UNSIGNED_INT,
                           nullptr);
            glDisable(GL_BLEND);
            glDepthMask(GL_TRUE);
        }
    }
    glDisable(GL_SCISSOR_TEST);
    return frame;
}

}  // namespace app
