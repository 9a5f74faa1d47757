#include "reflection/gl/MirrorMaps.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "reflection/planar/Gloss.h"

namespace reflection::gl {

GLenum glFormat(MirrorFormat format) {
    switch (format) {
        case MirrorFormat::rgba8:
            return GL_RGBA8;
        case MirrorFormat::r11g11b10f:
            return GL_R11F_G11F_B10F;
        case MirrorFormat::rgba16f:
            return GL_RGBA16F;
    }
    return GL_RGBA8;
}

std::uint64_t bytesOf(MirrorFormat format) {
    return format == MirrorFormat::rgba16f ? 8 : 4;
}

void bind(const MirrorTarget& target) {
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    const glm::ivec2 size = target.viewport.size(), part = target.scissor.size();
    glViewport(target.viewport.low.x, target.viewport.low.y, size.x, size.y);
    glScissor(target.scissor.low.x, target.scissor.low.y, part.x, part.y);
    glEnable(GL_SCISSOR_TEST);
    glFrontFace(target.mirrored ? GL_CW : GL_CCW);
}

void MirrorMaps::look(const ReflectionTree& tree) {
    const bool all = options_.distances || (options_.nearness && !tree.environments.empty());
    nodeWithDistance_.assign(tree.nodes.size(), all);
    withDistance_ = all;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const ReflectionNode& n = tree.nodes[i];
        const bool above = n.parent != ReflectionNode::none && nodeWithDistance_[n.parent];
        nodeWithDistance_[i] = all || above || rough(n);
        withDistance_ = withDistance_ || nodeWithDistance_[i];
    }
}

bool MirrorMaps::withDistance(const ReflectionTree& tree, const ReflectionNode& node) const {
    const auto index = static_cast<std::size_t>(&node - tree.nodes.data());
    return index < nodeWithDistance_.size() && nodeWithDistance_[index];
}

bool MirrorMaps::rough(const ReflectionNode& node) const {
    return node.roughness > 0 && node.view.projection == Projection::perspective;
}

/// Standard deviation, in texels; a curved reflector's at its map's edge, where directions lie densest: its
/// map is looked up at all angles, a planar one's spread is counted in the middle of the view.
double MirrorMaps::widestBlur(const ReflectionNode& node) const {
    const double edge = node.planar() ? 1 : 1 + 1 / (node.clipFromView[0][0] * node.clipFromView[0][0]);
    return edge * glossAngle(static_cast<double>(node.roughness)) * 0.5 *
           std::max(node.clipFromView[0][0] * node.resolution.x, node.clipFromView[1][1] * node.resolution.y);
}

void MirrorMaps::require(std::uint32_t level, const glm::ivec2& texels) {
    if (level >= levels_.size()) levels_.resize(level + 1);
    levels_[level].require(texels, glFormat(options_.format), withDistance_);
}

void MirrorMaps::clear(std::uint32_t level) {
    glBindFramebuffer(GL_FRAMEBUFFER, levels_[level].framebuffer.name());
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);
}

MirrorImage MirrorMaps::draw(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene,
                             const glm::ivec2& origin, bool cleared) {
    const MirrorLevel& level = levels_[node.level];
    MirrorImage image;
    image.node = &node;
    image.crop = node.crop;
    const bool distance = level.withDistance() && withDistance(tree, node);
    image.target.framebuffer = level.target(distance).name();
    image.target.viewport = {origin, origin + node.resolution};
    image.target.scissor = {origin + node.scissor.low, origin + node.scissor.high};
    image.target.withDistance = distance;
    image.target.mirrored = node.view.mirrored();
    bind(image.target);
    if (!cleared) {
        glDepthMask(GL_TRUE);
        glClearDepth(0);
        glClear(GL_DEPTH_BUFFER_BIT);
    }
    scene.drawNode(tree, node, image.target);
    ++drawn.images;
    drawn.texels += static_cast<std::uint64_t>(node.scissor.area());
    return image;
}

void MirrorMaps::filter(const ReflectionTree& tree, std::span<const AtlasGroup::Place> places) {
    std::vector<MirrorBlur::Item> items;
    for (const AtlasGroup::Place& p : places)
        if (rough(tree.nodes[p.node]))
            items.push_back({&tree.nodes[p.node], p.origin, widestBlur(tree.nodes[p.node]),
                             glossAngle(static_cast<double>(tree.nodes[p.node].roughness))});
    if (items.empty()) return;
    blur_.blur(levels_[items.front().node->level], items);
    drawn.filtered += items.size();
    std::erase_if(items, [](const MirrorBlur::Item& i) { return !i.node->planar(); });
    if (options_.glossPerTexel && !items.empty())
        blur_.gloss(items, options_.format == MirrorFormat::rgba8 ? GL_RGBA8 : GL_RGBA16F);
}

void MirrorMaps::apply(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene,
                       const glm::ivec2& origin, const MirrorImage& parent) {
    const MirrorLevel& level = levels_[node.level];
    MirrorMap map;
    map.colour = level.colour.name();
    map.texels = glm::vec2(level.size());
    if (level.withDistance() && withDistance(tree, node)) map.distance = level.distance.name();
    const glm::dvec2 pixels(glm::max(parent.target.viewport.size(), glm::ivec2(1)));
    // Fragment of the parent's target -> its whole image -> what of it the map shows -> texture.
    const glm::dvec2 texel = 1.0 / glm::dvec2(level.size()), part = glm::dvec2(node.resolution) * texel;
    const glm::dvec2 scale = parent.crop.size() / pixels / node.crop.size() * part;
    const glm::dvec2 offset = (parent.crop.low - node.crop.low) / node.crop.size() * part +
                              glm::dvec2(origin) * texel - glm::dvec2(parent.target.viewport.low) * scale;
    map.uvFromFragment = glm::vec4(scale, offset);
    map.uvLimits = glm::vec4((glm::dvec2(origin) + 0.5) * texel,
                             (glm::dvec2(origin) + glm::dvec2(node.resolution) - 0.5) * texel);
    map.texelsPerPixel = static_cast<float>(scale.y * level.size().y);
    if (rough(node)) {
        map.blurLevels = MirrorBlur::levelsFor(widestBlur(node));
        map.blurred = blur_.pyramid().name();
        if (options_.glossPerTexel && node.planar()) map.glossed = blur_.glossed().name();
        map.blurredScale = glm::vec2(level.size()) / glm::vec2(blur_.size());
    }
    bind(parent.target);
    scene.applyNode(tree, node, map, parent.node, parent.target);
}

void MirrorMaps::keep(std::size_t levels) {
    if (levels_.size() > levels) levels_.resize(levels);
    if (levels == 0) blur_.release();
}

void MirrorMaps::count(MirrorPassCounters& held) const {
    held.mapBytes = held.depthBytes = 0;
    for (const MirrorLevel& l : levels_) {
        if (!l.colour) continue;
        held.mapBytes += l.texels() * bytesOf(options_.format);
        held.depthBytes += l.texels() * (l.withDistance() ? 8u : 4u);
    }
    held.blurBytes = blur_.bytes();
}

}  // namespace reflection::gl
