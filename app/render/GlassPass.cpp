#include "app/render/GlassPass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reflection/planar/Gloss.h"

namespace app {

namespace gl = reflection::gl;

namespace {

std::uint8_t byteOf(float share) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.f, 1.f) * 255));
}

std::uint16_t glossOf(const city::GlassSurface& glass) {
    const double angle = reflection::glossAngle(std::clamp(static_cast<double>(glass.roughness), 0.0, 1.0));
    return static_cast<std::uint16_t>(std::lround(std::min(angle, 1.0) * 65535));
}

}  // namespace

GlassPass::GlassPass(std::span<const city::GlassFront> fronts) {
    std::vector<GlassVertex> vertices;
    std::vector<std::uint32_t> indices;
    for (const city::GlassFront& front : fronts) {
        Front f;
        f.range.firstIndex = static_cast<std::uint32_t>(indices.size());
        f.range.indexCount = static_cast<std::uint32_t>(front.panes.indices.size());
        f.range.baseVertex = static_cast<std::int32_t>(vertices.size());
        f.bounds = front.bounds;
        f.normal = glm::vec3(front.normal);
        f.point = glm::vec3(front.outline[0]);
        f.rough = front.glass.roughness > 0;
        for (const city::Vertex& v : front.panes.vertices)
            vertices.push_back({v.position, v.texcoord, packNormal(v.normal),
                                static_cast<std::uint16_t>(std::min<std::uint32_t>(v.material, 0xffffu)),
                                byteOf(front.glass.reflectance), byteOf(front.glass.transmittance),
                                glossOf(front.glass),
                                static_cast<std::uint16_t>(front.glass.solid ? 0xffff : 0)});
        indices.insert(indices.end(), front.panes.indices.begin(), front.panes.indices.end());
        fronts_.push_back(f);
    }
    vertices_ = gl::Buffer::filled(std::span<const GlassVertex>(vertices));
    indices_ = gl::Buffer::filled(std::span<const std::uint32_t>(indices));
    array_ = gl::VertexArray::create();
    array_.buffer(0, vertices_.name(), sizeof(GlassVertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(GlassVertex, position))
        .attribute(1, 0, 2, GL_FLOAT, false, offsetof(GlassVertex, texcoord))
        .attribute(2, 0, 4, GL_INT_2_10_10_10_REV, true, offsetof(GlassVertex, normal))
        .integerAttribute(3, 0, 1, GL_UNSIGNED_SHORT, offsetof(GlassVertex, material))
        .attribute(4, 0, 2, GL_UNSIGNED_BYTE, true, offsetof(GlassVertex, reflectance))
        .attribute(5, 0, 2, GL_UNSIGNED_SHORT, true, offsetof(GlassVertex, glossAngle))
        .indices(indices_.name());
}

const gl::Program& GlassPass::programFor(PassTarget target, Image image) {
    gl::Program& program = programs_[static_cast<std::size_t>(target)][static_cast<std::size_t>(image)];
    if (!program) {
        std::vector<std::string> defines;
        if (target == PassTarget::cube) defines.emplace_back("CUBE");
        if (image != Image::none) defines.emplace_back("MIRROR");
        if (image == Image::blurred) defines.emplace_back("ROUGH");
        program = gl::Program::fromFiles({"glass.vert", "glass.frag"}, defines);
    }
    return program;
}

void GlassPass::list(std::span<const std::uint32_t> fronts, const bool* rough, Counts& counts) {
    counts_.clear();
    offsets_.clear();
    baseVertices_.clear();
    for (const std::uint32_t f : fronts) {
        if (f >= fronts_.size() || (rough != nullptr && fronts_[f].rough != *rough)) continue;
        const MeshRange& range = fronts_[f].range;
        counts_.push_back(static_cast<GLsizei>(range.indexCount));
        offsets_.push_back(reinterpret_cast<const void*>(static_cast<std::uintptr_t>(range.firstIndex) *
                                                         sizeof(std::uint32_t)));
        baseVertices_.push_back(range.baseVertex);
        counts.triangles += range.indexCount / 3;
    }
}

GlassPass::Counts GlassPass::draw(PassTarget target, std::span<const std::uint32_t> fronts,
                                  const Mirrored* mirrored) {
    Counts counts;
    const auto drawListed = [&](Image image) {
        if (counts_.empty()) return;
        const gl::Program& program = programFor(target, image);
        if (mirrored != nullptr) {
            program.set("uvFromFragment", mirrored->map.uvFromFragment);
            program.set("uvLimits", mirrored->map.uvLimits);
            glBindTextureUnit(8, mirrored->map.colour);
        }
        if (image == Image::blurred) {
            program.set("blurredScale", mirrored->map.blurredScale);
            program.set("blurLevels", mirrored->map.blurLevels);
            program.set("viewFromRelative", mirrored->viewFromRelative);
            program.set("uvPerTangent", mirrored->uvPerTangent);
            glBindTextureUnit(9, mirrored->map.blurred);
        }
        program.use();
        array_.bind();
        glEnable(GL_CULL_FACE);
        glMultiDrawElementsBaseVertex(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(),
                                      static_cast<GLsizei>(counts_.size()), baseVertices_.data());
        ++counts.drawCalls;
    };
    if (mirrored == nullptr || mirrored->map.blurred == 0) {
        list(fronts, nullptr, counts);
        drawListed(mirrored == nullptr ? Image::none : Image::sharp);
        return counts;
    }
    for (const bool rough : {false, true}) {
        list(fronts, &rough, counts);
        drawListed(rough ? Image::blurred : Image::sharp);
    }
    return counts;
}

void GlassPass::seenBy(const PassView& view, float reach, const std::vector<bool>& without,
                       std::vector<std::uint32_t>& seen) const {
    seen.clear();
    const glm::vec3 eye(view.eye);
    for (std::uint32_t f = 0; f < fronts_.size(); ++f) {
        if (f < without.size() && without[f]) continue;
        const Front& front = fronts_[f];
        if (glm::dot(front.normal, eye - front.point) <= 0) continue;
        const glm::vec3 away =
            glm::max(glm::abs(front.bounds.centre() - eye) - 0.5f * front.bounds.size(), glm::vec3(0));
        if (glm::length(away) > reach || !view.sees(front.bounds)) continue;
        seen.push_back(f);
    }
}

}  // namespace app
