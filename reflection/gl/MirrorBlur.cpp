#include "reflection/gl/MirrorBlur.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace reflection::gl {

namespace {

constexpr int mostLevels = 7;  // as many as sizes in multiples of 64 can be halved

}  // namespace

void MirrorBlur::require(const glm::ivec2& size) {
    if (!first_) {
        first_ = Program::fromFiles({"fullscreen.vert", "mirror_blur.frag"}, {"FIRST"});
        next_ = Program::fromFiles({"fullscreen.vert", "mirror_blur.frag"});
        nothing_ = VertexArray::create();
    }
    if (pyramid_ && size_.x >= size.x && size_.y >= size.y) return;
    size_ = glm::max(size_, size);
    pyramid_ = Texture::image2D(GL_RGBA16F, size_.x, size_.y, mostLevels);
    pyramid_.filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
    levels_.clear();
    for (int k = 0; k < mostLevels; ++k) {
        levels_.push_back(Framebuffer::create());
        levels_.back().attach(GL_COLOR_ATTACHMENT0, pyramid_.name(), k);
    }
    levels_.front().requireComplete("a rough mirror's map");
    glossed_ = Texture();
}

int MirrorBlur::levelsFor(double sigma) {
    // The level whose kernel under the spline is as wide, and the next: see mirror_map.glsl.
    const double level = 0.5 * std::log2(std::max((sigma * sigma + 0.25) / (7.0 / 12), 1.0));
    return std::clamp(static_cast<int>(level) + 2, 2, mostLevels);
}

/// A fragment's ray: the inverse of the projection, row by row, over gl_FragCoord.
void MirrorBlur::setRays(const Program& program, const Item& item) const {
    const ReflectionNode& node = *item.node;
    const glm::dmat4& c = node.clipFromView;
    const glm::dmat3 worldFromView = glm::transpose(node.view.viewFromWorld);
    const glm::dvec2 perTexel = 2.0 / glm::dvec2(node.resolution);
    const glm::dvec2 low = -1.0 - glm::dvec2(item.origin) * perTexel;
    const glm::dvec3 corner((low.x + c[2][0]) / c[0][0], (low.y + c[2][1]) / c[1][1], -1);
    program.set("rayBase", glm::vec3(worldFromView * corner));
    program.set("rayRight", glm::vec3(worldFromView * glm::dvec3(perTexel.x / c[0][0], 0, 0)));
    program.set("rayUp", glm::vec3(worldFromView * glm::dvec3(0, perTexel.y / c[1][1], 0)));
}

void MirrorBlur::gloss(std::span<const Item> items, GLenum format) {
    if (!gloss_) gloss_ = Program::fromFiles({"fullscreen.vert", "mirror_gloss.frag"});
    if (!glossed_ || glossFormat_ != format) {
        glossFormat_ = format;
        glossed_ = Texture::image2D(format, size_.x, size_.y);
        glossed_.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
        glossTarget_ = Framebuffer::create();
        glossTarget_.attach(GL_COLOR_ATTACHMENT0, glossed_.name());
        glossTarget_.requireComplete("what a rough mirror shows");
    }
    glBindFramebuffer(GL_FRAMEBUFFER, glossTarget_.name());
    glEnable(GL_SCISSOR_TEST);
    nothing_.bind();
    pyramid_.bind(9);
    gloss_.use();
    const glm::dvec2 size(size_);
    for (const Item& item : items) {
        const ReflectionNode& node = *item.node;
        setRays(gloss_, item);
        gloss_.set("glassNormal", glm::vec3(node.glass));
        gloss_.set("viewFromWorld", glm::mat3(node.view.viewFromWorld));
        gloss_.set("uvPerTangent",
                   glm::vec2(0.5 * glm::dvec2(node.clipFromView[0][0], node.clipFromView[1][1]) *
                             glm::dvec2(node.resolution) / size));
        gloss_.set("uvLimits", glm::vec4((glm::dvec2(item.origin) + 0.5) / size,
                                         (glm::dvec2(item.origin + node.resolution) - 0.5) / size));
        gloss_.set("blurredScale", glm::vec2(1));
        gloss_.set("glossAngle", static_cast<float>(item.angle));
        gloss_.set("blurLevels", levelsFor(item.sigma));
        glViewport(item.origin.x, item.origin.y, node.resolution.x, node.resolution.y);
        // The mirrors' bounds, of the map that reaches beyond them, and a texel more for interpolation.
        const glm::dvec2 scale = glm::dvec2(node.resolution) / node.crop.size();
        const glm::ivec2 low =
            glm::max(glm::ivec2(glm::floor((node.bounds.low - node.crop.low) * scale)) - 1, glm::ivec2(0));
        const glm::ivec2 high =
            glm::min(glm::ivec2(glm::ceil((node.bounds.high - node.crop.low) * scale)) + 1, node.resolution);
        glScissor(item.origin.x + low.x, item.origin.y + low.y, high.x - low.x, high.y - low.y);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glDisable(GL_SCISSOR_TEST);
}

void MirrorBlur::blur(const MirrorLevel& map, std::span<const Item> items) {
    require(map.size());
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    nothing_.bind();
    map.colour.bind(0);
    map.distance.bind(1);
    first_.use();
    glBindFramebuffer(GL_FRAMEBUFFER, levels_[0].name());
    int most = 0;
    for (const Item& item : items) {
        const ReflectionNode& node = *item.node;
        setRays(first_, item);
        first_.set("glass", glm::vec4(node.glass));
        glViewport(item.origin.x, item.origin.y, node.resolution.x, node.resolution.y);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        most = std::max(most, levelsFor(item.sigma));
    }
    pyramid_.bind(0);
    next_.use();
    for (int k = 1; k < most; ++k) {
        // Levels that are written must not be readable.
        glTextureParameteri(pyramid_.name(), GL_TEXTURE_MAX_LEVEL, k - 1);
        const glm::vec2 finer(size_ / (1 << (k - 1)));
        next_.set("finerLevel", static_cast<float>(k - 1));
        next_.set("finerTexel", 1.f / finer);
        glBindFramebuffer(GL_FRAMEBUFFER, levels_[static_cast<std::size_t>(k)].name());
        for (const Item& item : items) {
            if (k >= levelsFor(item.sigma)) continue;
            const auto used = [&](int level) {
                return (item.node->resolution + ((1 << level) - 1)) / (1 << level);
            };
            const glm::vec2 from(item.origin / (1 << (k - 1)));
            next_.set("limits",
                      glm::vec4((from + 0.5f) / finer, (from + glm::vec2(used(k - 1)) - 0.5f) / finer));
            glViewport(item.origin.x >> k, item.origin.y >> k, used(k).x, used(k).y);
            glDrawArrays(GL_TRIANGLES, 0, 3);
        }
    }
    glTextureParameteri(pyramid_.name(), GL_TEXTURE_MAX_LEVEL, mostLevels - 1);
}

std::uint64_t MirrorBlur::bytes() const {
    std::uint64_t texels = 0;
    if (pyramid_)
        for (int k = 0; k < mostLevels; ++k)
            texels += static_cast<std::uint64_t>(size_.x >> k) * static_cast<std::uint64_t>(size_.y >> k);
    const std::uint64_t shown = static_cast<std::uint64_t>(size_.x) * static_cast<std::uint64_t>(size_.y);
    return 8 * texels + (glossed_ ? (glossFormat_ == GL_RGBA16F ? 8u : 4u) * shown : 0u);
}

void MirrorBlur::release() {
    pyramid_ = Texture();
    glossed_ = Texture();
    levels_.clear();
    size_ = glm::ivec2(0);
}

}  // namespace reflection::gl
