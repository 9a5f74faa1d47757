#include <epoxy/gl.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "app/render/MirrorWorldChromeImpl.h"

namespace app {

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

void MirrorWorldChrome::Impl::plan(const reflection::EyeView& view, const glm::ivec2& size) {
    tree = {};
    if (bounces.depth <= 1) return;
    std::vector<reflection::ChromeBody> parts;
    for (std::size_t c = 0; c < chrome.size(); ++c) {
        const reflection::CurvedReflector& reflector = world.curved[c].reflector;
        reflection::ChromeBody& body = parts.emplace_back();
        body.reflector = chrome[c].reflector.get();
        body.points = chrome[c].points;
        body.centre = reflector.centre;
        body.radius = reflector.radius;
        body.reach = chrome[c].reach;
        const reflection::PixelRect pixels = pixelsOf(view, size, reflector.centre, reflector.radius);
        body.inView = pixels.size().x > 0 && pixels.size().y > 0;
    }
    tree = reflection::chromeTree(view, size, parts, bounces);
}

/// What a piece shows, seen from a node's eye.
void MirrorWorldChrome::Impl::makePicture(std::uint32_t number, const ChromeEnvironments& environments,
                                          ChromeFrame& frame) {
    const reflection::ChromeNode& node = tree.nodes[number];
    ++frame.pictures;
    frame.pictureTexels += static_cast<std::size_t>(node.size.x) * static_cast<std::size_t>(node.size.y);
    drawPiece({node.view, node.size, 0, number}, node.of, node.ofPiece, {glm::ivec2(0), node.size},
              pictures[number], environments, frame);
}

void MirrorWorldChrome::Impl::drawBody(const reflection::ChromeNode& node, Body& body,
                                       const reflection::EyeView& view,
                                       const ChromeEnvironments& environments, ChromeFrame& frame) {
    const MirrorWorld::Curved& of = world.curved[body.index];
    const reflection::ReflectorPiece& piece = *chrome[body.index].pieces[body.piece].piece;
    const bool pictured = node.look == reflection::ChromeLook::picture;
    const std::span<const city::Vertex> vertices(piece.mesh.vertices);
    places.assign(vertices.size(), glm::dvec3(0));
    lookups.assign(vertices.size(), {});
    std::vector<float>& values = bodyValues;
    values.clear();
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const glm::dvec3 p(vertices[k].position), n = glm::normalize(glm::dvec3(vertices[k].normal));
        const glm::dvec3 from = reflection::reflectionPointOf(body.mesh.vertices()[k], view.eye,
                                                              glm::dvec3(vertices[k].position));
        const glm::dvec3 d = (p - from) / std::max(glm::distance(p, from), 1e-12);
        places[k] = p + node.middle * (d - 2.0 * glm::dot(d, n) * n);
        const glm::vec3 f(from);
        values.insert(values.end(), {vertices[k].position.x, vertices[k].position.y, vertices[k].position.z,
                                     vertices[k].normal.x, vertices[k].normal.y, vertices[k].normal.z, f.x,
                                     f.y, f.z, 0, 0, 0});
    }
    if (pictured) {
        // Where from the node's eye the piece shows what lies on each vertex's reflected ray.
        reflection::findReflectionPoints(piece.built.map, node.eye, places, lookups, options.vertices.search);
        frame.searched += places.size();
        for (std::size_t k = 0; k < lookups.size(); ++k) {
            const bool any = lookups[k].status == reflection::ReflectionStatus::found ||
                             lookups[k].status == reflection::ReflectionStatus::unreflected;
            const glm::vec3 at = any ? glm::vec3(lookups[k].point) : vertices[k].position;
            for (int i = 0; i < 3; ++i) values[12 * k + 9 + static_cast<std::size_t>(i)] = at[i];
        }
    }
    frame.searchMilliseconds += millisecondsSince(start);
    body.drawn->upload(body.mesh, values);
    const gl::Program& program = virtualBodies;
    program.set("mapCentre", glm::vec3(of.reflector.centre));
    program.set("parallax", environments.nearness ? 1 : 0);
    program.set("reflectance", of.reflector.surface.reflectance);
    program.set("tint", of.tint);
    program.set("pictured", pictured ? 1 : 0);
    program.set("pictureEye", glm::vec3(node.eye));
    program.set("pictureFromRelative",
                glm::mat4(node.view.clipFromView * glm::dmat4(node.view.viewFromWorld)));
    program.set("slice", glm::vec3(node.axis));
    constexpr double endless = 1e30;
    program.set("sliceEnds", glm::vec2(std::max(node.low, -endless), std::min(node.high, endless)));
    program.use();
    glBindTextureUnit(8, environments.maps[body.index]);
    if (pictured) {
        const gl::ChromeLayer& picture = pictures[static_cast<std::size_t>(&node - tree.nodes.data())];
        program.set("pictureShare", glm::vec2(node.size) / glm::vec2(picture.size()));
        glBindTextureUnit(12, picture.colour());
        glBindSampler(12, linear.name());
    }
    body.drawn->draw();
    glBindSampler(12, 0);
}

void MirrorWorldChrome::Impl::drawBodies(const Image& image, std::size_t curved, std::size_t piece,
                                         const reflection::VirtualMeshOptions& how, const glm::mat4& clip,
                                         const ChromeEnvironments& environments, ChromeFrame& frame) {
    Piece& p = chrome[curved].pieces[piece];
    virtualBodies.set("clipFromVirtual", clip);
    for (Body& b : p.bodies) {
        bool updated = false;
        if (environments.maps[b.index] == 0) continue;
        for (const reflection::ChromeNode& node : tree.nodes) {
            if (node.parent != image.node || node.in != curved || node.piece != piece || node.of != b.index ||
                node.ofPiece != b.piece)
                continue;
            if (!updated) {
                const auto start = std::chrono::steady_clock::now();
                add(b.mesh.update(p.piece->built.map, image.view.eye, glm::dmat4(1), how), b.mesh, frame);
                frame.searchMilliseconds += millisecondsSince(start);
                updated = true;
            }
            drawBody(node, b, image.view, environments, frame);
        }
    }
}

}  // namespace app
