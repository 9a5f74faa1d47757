#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <map>

#include "app/frame/ChromeDrawing.h"
#include "app/mirrors/LitShapes.h"
#include "app/render/MirrorWorldChromeImpl.h"
#include "reflection/chrome/ReflectorPieces.h"

namespace app {

namespace {

/// Points of a reflector by which others see it.
constexpr std::size_t bodyPoints = 48;

WeldedMesh weld(const LitMesh& mesh) {
    WeldedMesh out;
    std::map<std::array<float, 6>, std::uint32_t> known;
    std::vector<std::uint32_t> ids;
    for (const LitMesh::Corner& c : mesh.corners) {
        const glm::vec3 &p = c.position, &l = c.colour;
        const auto [at, added] = known.try_emplace({p.x, p.y, p.z, l.r, l.g, l.b},
                                                   static_cast<std::uint32_t>(out.positions.size()));
        if (added) {
            out.positions.push_back(p);
            out.values.insert(out.values.end(), {l.r, l.g, l.b});
        }
        ids.push_back(at->second);
    }
    for (const std::uint32_t i : mesh.indices) out.indices.push_back(ids[i]);
    return out;
}

double distanceTo(const city::Aabb& box, const glm::dvec3& p) {
    return glm::length(glm::max(glm::max(glm::dvec3(box.min) - p, p - glm::dvec3(box.max)), glm::dvec3(0)));
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

void MirrorWorldChrome::Impl::makeGlObjects() {
    if (layer) return;
    layer.emplace();
    virtualObjects = gl::Program::fromFiles({"chrome.vert", "chrome.frag"});
    if (searchOnGpu) {
        search.emplace();
        searched = gl::Program::fromFiles({"chrome.vert", "chrome.frag"}, {"WITH_STATUS"});
    }
    if (bounces.depth > 1) {
        linear = gl::Sampler::create(GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE);
        virtualBodies = gl::Program::fromFiles({"chrome_body.vert", "chrome_body.frag"});
    }
    apply = gl::Program::fromFiles({"mirror_world.vert", "chrome_apply.frag"});
    for (Chrome& c : chrome)
        for (Piece& p : c.pieces) {
            p.vertices = gl::Buffer::filled(std::span<const city::Vertex>(p.piece->mesh.vertices));
            p.indices = gl::Buffer::filled(std::span<const std::uint32_t>(p.piece->mesh.indices));
            p.array = gl::VertexArray::create();
            p.array.buffer(0, p.vertices.name(), sizeof(city::Vertex))
                .attribute(0, 0, 3, GL_FLOAT, false, offsetof(city::Vertex, position))
                .indices(p.indices.name());
            p.drawn.emplace(std::vector<int>{3});
            for (Body& b : p.bodies) b.drawn.emplace(std::vector<int>{3, 3, 3, 3});
            // On concave pieces images tear, which the processor's meshes find and leave out.
            if (!searchOnGpu || p.piece->bend == reflection::Bend::concave || p.piece->built.map.empty())
                continue;
            p.onGpu.emplace(p.piece->built.map, 3);
            for (const Object& o : p.objects) {
                const WeldedMesh& object = objects[o.index];
                p.onGpu->add(object.positions, object.indices, object.values);
            }
        }
}

MirrorWorldChrome::MirrorWorldChrome(const MirrorWorld& world, const reflection::VirtualMeshOptions& given,
                                     bool concave, const reflection::ChromeTreeOptions& bounces)
    : impl_(std::make_unique<Impl>(world)) {
    reflection::VirtualMeshOptions options = given;
    // Each vertex behind an open part's rim would be looked for everywhere, to be drawn nowhere.
    options.vertices.search.thorough = false;
    options.vertices.threads = true;
    impl_->options = options;
    impl_->bounces = bounces;
    impl_->bounces.search.thorough = false;
    std::vector<WeldedMesh>& objects = impl_->objects;
    for (const LitMesh& m : world.objects) objects.push_back(weld(m));
    for (const MirrorWorld::Curved& curved : world.curved) {
        Impl::Chrome& chrome = impl_->chrome.emplace_back();
        chrome.close.assign(world.objects.size(), false);
        chrome.closeCurved.assign(world.curved.size(), false);
        if (curved.reflector.surface.roughness > 0) continue;
        chrome.reach = (closeRadii + 1) * curved.reflector.radius;
        for (std::size_t o = 0; o < world.objects.size(); ++o)
            chrome.close[o] = distanceTo(world.objects[o].bounds(), curved.reflector.centre) < chrome.reach;
        // Drawn is what has been drawn before, depth by depth: the finer surface only where it is one piece.
        reflection::Reflector reflector = reflection::makeReflector(withoutLight(curved.finest()));
        if (reflector.pieces.size() == 1)
            reflector.pieces.front().mesh = withoutLight(curved.mesh);
        else
            reflector = reflection::makeReflector(withoutLight(curved.mesh));
        // Others see its concave pieces too.
        for (reflection::ReflectorPiece& piece : reflector.pieces) {
            if (!concave && piece.bend == reflection::Bend::concave) piece.built.map = {};
            if (bounces.depth > 1) chrome.points.push_back(reflection::spreadPoints(piece.mesh, bodyPoints));
        }
        const bool any = std::ranges::any_of(reflector.pieces, [](const reflection::ReflectorPiece& piece) {
            return !piece.built.map.empty();
        });
        chrome.reflector = std::make_unique<reflection::Reflector>(std::move(reflector));
        for (const reflection::ReflectorPiece& piece : chrome.reflector->pieces) {
            Impl::Piece& made = chrome.pieces.emplace_back();
            made.piece = &piece;
            if (piece.built.map.empty()) continue;
            for (std::size_t o = 0; o < world.objects.size(); ++o) {
                if (!chrome.close[o]) continue;
                made.objects.push_back(
                    {o, reflection::VirtualMesh(objects[o].positions, objects[o].indices, options)});
            }
        }
        if (!any) chrome.close.assign(world.objects.size(), false);
    }
    if (bounces.depth <= 1) return;
    for (std::size_t a = 0; a < impl_->chrome.size(); ++a)
        for (std::size_t b = 0; b < impl_->chrome.size(); ++b) {
            Impl::Chrome& in = impl_->chrome[a];
            const reflection::CurvedReflector& of = world.curved[b].reflector;
            if (a == b || in.pieces.empty() || impl_->chrome[b].pieces.empty() ||
                !(glm::distance(world.curved[a].reflector.centre, of.centre) - of.radius < in.reach))
                continue;
            in.closeCurved[b] = true;
            for (Impl::Piece& piece : in.pieces)
                for (std::size_t k = 0; k < impl_->chrome[b].pieces.size() && !piece.piece->built.map.empty();
                     ++k) {
                    const city::Mesh& mesh = impl_->chrome[b].pieces[k].piece->mesh;
                    std::vector<glm::vec3> positions;
                    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
                    piece.bodies.push_back(
                        {b, k, reflection::VirtualMesh(std::move(positions), mesh.indices, options), {}});
                }
        }
}
MirrorWorldChrome::~MirrorWorldChrome() = default;

void MirrorWorldChrome::searchOnGpu() {
    impl_->searchOnGpu = true;
}

std::vector<bool> MirrorWorldChrome::leftToChrome(std::size_t curved) const {
    return impl_->hollow(curved) ? std::vector<bool>() : impl_->chrome[curved].close;
}

std::vector<bool> MirrorWorldChrome::reflectorsLeftToChrome(std::size_t curved) const {
    return impl_->hollow(curved) ? std::vector<bool>() : impl_->chrome[curved].closeCurved;
}

const reflection::ChromeTree& MirrorWorldChrome::tree() const {
    return impl_->tree;
}

reflection::VirtualMeshOptions MirrorWorldChrome::Impl::optionsFor(const Image& image,
                                                                   std::size_t curved) const {
    const reflection::CurvedReflector& reflector = world.curved[curved].reflector;
    reflection::VirtualMeshOptions how = options;
    const glm::dvec3 towards = reflector.centre - image.view.eye;
    const double distance = glm::length(towards);
    if (distance > 1.1 * reflector.radius) {
        const double sine = reflector.radius / distance;
        how.towards = towards / distance;
        how.coneCosine = std::sqrt(1 - sine * sine);
    }
    if (image.node != reflection::ChromeNode::none) {
        // A picture's texels are as many as the pixels it covers: as fine as those.
        how.tolerance = 1 / (image.view.clipFromView[1][1] * image.size.y);
        how.vertices.cellTolerance = 0.5 * how.tolerance;
    }
    return how;
}

/// The virtual objects of a piece, in a layer: what the piece shows where it is seen.
void MirrorWorldChrome::Impl::drawPiece(const Image& image, std::size_t curved, std::size_t piece,
                                        const reflection::PixelRect& pixels, gl::ChromeLayer& into,
                                        const ChromeEnvironments& environments, ChromeFrame& frame) {
    Piece& p = chrome[curved].pieces[piece];
    const reflection::VirtualMeshOptions how = optionsFor(image, curved);
    const glm::mat4 clip(image.view.clipFromView * glm::dmat4(image.view.viewFromWorld));
    const auto start = std::chrono::steady_clock::now();
    if (p.onGpu) {
        p.onGpu->update(*search, image.view.eye);
        frame.meshes += p.objects.size();
        frame.vertices += p.onGpu->vertexCount();
        frame.searched += p.onGpu->vertexCount();
        frame.triangles += p.onGpu->triangleCount();
    }
    if (!p.onGpu) {
        std::vector<reflection::VirtualMesh::Placed> meshes;
        for (Object& o : p.objects) meshes.push_back({&o.mesh, glm::dmat4(1), how, {}});
        reflection::VirtualMesh::update(p.piece->built.map, image.view.eye, meshes);
        for (const reflection::VirtualMesh::Placed& m : meshes) add(m.counts, *m.mesh, frame);
    }
    frame.searchMilliseconds += millisecondsSince(start);
    into.begin(image.size, pixels);
    // Mirrored once: what is seen of an object's front has turned round.
    glDisable(GL_CULL_FACE);
    glDisable(GL_CLIP_DISTANCE0);
    glDisable(GL_CLIP_DISTANCE1);
    const gl::Program& program = p.onGpu ? searched : virtualObjects;
    program.set("clipFromVirtual", clip);
    program.use();
    if (p.onGpu) {
        p.onGpu->draw();
    } else {
        std::vector<gl::ChromeMesh::Part> parts;
        for (const Object& o : p.objects) parts.push_back({&o.mesh, objects[o.index].values});
        p.drawn->upload(parts, {clip, image.size, pixels});
        p.drawn->draw();
    }
    if (!tree.nodes.empty()) drawBodies(image, curved, piece, how, clip, environments, frame);
}

void MirrorWorldChrome::Impl::drawPieces(const Image& image, std::size_t curved,
                                         const reflection::PixelRect& pixels,
                                         const ChromeEnvironments& environments, ChromeFrame& frame) {
    const reflection::CurvedReflector& reflector = world.curved[curved].reflector;
    const glm::mat4 clip(image.view.clipFromView * glm::dmat4(image.view.viewFromWorld));
    for (std::size_t k = 0; k < chrome[curved].pieces.size(); ++k) {
        Piece& p = chrome[curved].pieces[k];
        if (p.piece->built.map.empty() || !faces(p.piece->mesh, glm::vec3(image.view.eye))) continue;
        ++frame.jobs;
        drawPiece(image, curved, k, pixels, *layer, environments, frame);
        glBindFramebuffer(GL_FRAMEBUFFER, image.framebuffer);
        glDepthMask(GL_FALSE);
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
        apply.set("eye", glm::vec3(image.view.eye));
        apply.set("clipFromRelative", clip);
        apply.set("glass", glm::vec4(0, 0, 0, 1));
        apply.set("reflectance", reflector.surface.reflectance);
        apply.set("tint", world.curved[curved].tint);
        apply.use();
        glBindTextureUnit(11, layer->colour());
        p.array.bind();
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(p.piece->mesh.indices.size()), GL_UNSIGNED_INT,
                       nullptr);
        glDisable(GL_BLEND);
        glDepthMask(GL_TRUE);
    }
}

ChromeFrame MirrorWorldChrome::draw(const reflection::EyeView& view, const glm::ivec2& size,
                                    std::uint32_t framebuffer, const ChromeEnvironments& environments) {
    Impl& my = *impl_;
    my.makeGlObjects();
    ChromeFrame frame;
    const auto planning = std::chrono::steady_clock::now();
    my.plan(view, size);
    frame.planMilliseconds = millisecondsSince(planning);
    if (my.pictures.size() < my.tree.nodes.size()) my.pictures.resize(my.tree.nodes.size());
    glFrontFace(view.mirrored() ? GL_CW : GL_CCW);
    for (std::size_t n = my.tree.nodes.size(); n-- > 0;)
        if (my.tree.nodes[n].look == reflection::ChromeLook::picture)
            my.makePicture(static_cast<std::uint32_t>(n), environments, frame);
    for (std::size_t c = 0; c < my.chrome.size(); ++c) {
        const reflection::CurvedReflector& reflector = my.world.curved[c].reflector;
        const reflection::PixelRect pixels = pixelsOf(view, size, reflector.centre, reflector.radius);
        const bool nothingClose =
            std::none_of(my.chrome[c].close.begin(), my.chrome[c].close.end(),
                         [](bool close) { return close; }) &&
            std::none_of(my.chrome[c].closeCurved.begin(), my.chrome[c].closeCurved.end(),
                         [](bool close) { return close; });
        if (my.chrome[c].pieces.empty() || nothingClose || pixels.size().x <= 0 || pixels.size().y <= 0)
            continue;
        my.drawPieces({view, size, framebuffer, reflection::ChromeNode::none}, c, pixels, environments,
                      frame);
    }
    glDisable(GL_SCISSOR_TEST);
    return frame;
}

}  // namespace app
