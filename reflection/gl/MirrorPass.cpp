#include "reflection/gl/MirrorPass.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "reflection/gl/MirrorBlur.h"
#include "reflection/gl/MirrorLevel.h"
#include "reflection/planar/Gloss.h"

namespace reflection {

namespace {

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

void clearDepth() {
    glDepthMask(GL_TRUE);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);
}

}  // namespace

struct MirrorPass::Impl {
    /// An image that reflections are met in.
    struct Image {
        const ReflectionNode* node = nullptr;  ///< null: a root's
        NdcRect crop;
        MirrorTarget target;
    };

    MirrorPassOptions options;
    MirrorPassCounters counters;
    std::vector<gl::MirrorLevel> levels;
    gl::MirrorBlur blur;
    std::vector<gl::Texture> environments;  ///< complete, one a curved reflector
    gl::Texture spare, spareDepth;          ///< the one being drawn
    gl::Framebuffer spareTarget;
    int faceSize = 0;
    bool withDistance =
        false;  ///< of the tree at hand: some mirror is rough, and way lengths add up through all

    void look(const ReflectionTree& tree) {
        withDistance = false;
        for (const ReflectionNode& n : tree.nodes) withDistance = withDistance || rough(n);
    }
    bool rough(const ReflectionNode& node) const {
        return options.gloss && node.planar() && node.roughness > 0 &&
               node.view.projection == Projection::perspective;
    }

    Image draw(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene) {
        if (node.level >= levels.size()) levels.resize(node.level + 1);
        gl::MirrorLevel& level = levels[node.level];
        const glm::ivec2 needed =
            node.level < tree.levelSize.size() ? tree.levelSize[node.level] : node.resolution;
        level.require(glm::max(needed, node.resolution), glFormat(options.format), withDistance);
        Image image;
        image.node = &node;
        image.crop = node.crop;
        image.target.framebuffer = level.framebuffer.name();
        image.target.viewport = {glm::ivec2(0), node.resolution};
        image.target.scissor = node.scissor;
        image.target.withDistance = level.withDistance();
        image.target.mirrored = node.view.mirrored();
        bind(image.target);
        clearDepth();
        scene.drawNode(tree, node, image.target);
        ++counters.images;
        counters.texels += static_cast<std::uint64_t>(node.scissor.area());
        return image;
    }

    void apply(const ReflectionTree& tree, const ReflectionNode& node, MirrorScene& scene,
               const Image& parent) {
        const gl::MirrorLevel& level = levels[node.level];
        MirrorMap map;
        map.colour = level.colour.name();
        map.texels = glm::vec2(level.size());
        if (level.withDistance()) map.distance = level.distance.name();
        const glm::dvec2 pixels(glm::max(parent.target.viewport.size(), glm::ivec2(1)));
        // Fragment of the parent's target -> its whole image -> what of it the map shows -> texture.
        const glm::dvec2 part = glm::dvec2(node.resolution) / glm::dvec2(level.size());
        const glm::dvec2 scale = parent.crop.size() / pixels / node.crop.size() * part;
        const glm::dvec2 offset = (parent.crop.low - node.crop.low) / node.crop.size() * part -
                                  glm::dvec2(parent.target.viewport.low) * scale;
        map.uvFromFragment = glm::vec4(scale, offset);
        const glm::dvec2 texel = 1.0 / glm::dvec2(level.size());
        map.uvLimits = glm::vec4(0.5 * texel, (glm::dvec2(node.resolution) - 0.5) * texel);
        map.texelsPerPixel = static_cast<float>(scale.y * level.size().y);
        if (rough(node)) {
            const double texelsPerRadian = 0.5 * std::max(node.clipFromView[0][0] * node.resolution.x,
                                                          node.clipFromView[1][1] * node.resolution.y);
            map.blurLevels = blur.blur(level, node, glossAngle(node.roughness) * texelsPerRadian);
            map.blurred = blur.pyramid().name();
            map.blurredScale = glm::vec2(level.size()) / glm::vec2(blur.size());
            ++counters.filtered;
        }
        bind(parent.target);
        scene.applyNode(tree, node, map, parent.node, parent.target);
    }

    /// Takes steps from `at` on while they belong into `image`; a node's own steps are taken inside it.
    std::size_t run(const ReflectionTree& tree, std::span<const ReflectionStep> steps, std::size_t at,
                    MirrorScene& scene, const Image& image) {
        while (at < steps.size() && steps[at].what == ReflectionStep::What::draw) {
            const ReflectionNode& node = tree.nodes[steps[at].node];
            const Image below = draw(tree, node, scene);
            at = run(tree, steps, at + 1, scene, below);
            apply(tree, node, scene, image);
            ++at;
        }
        return at;
    }

    void requireSpare(int size) {
        const bool cube = options.environments == CurvedMaps::cube;
        if (faceSize != size) {
            faceSize = size;
            environments.clear();
            spare = gl::Texture();
            spareDepth = gl::Texture::image2D(GL_DEPTH_COMPONENT32F, size, size);
            spareTarget = gl::Framebuffer::create();
            spareTarget.attach(GL_DEPTH_ATTACHMENT, spareDepth.name());
        }
        if (spare) return;
        spare = cube ? gl::Texture::cube(glFormat(options.format), size)
                     : gl::Texture::array2D(glFormat(options.format), size, size, 2);
        spare.filter(GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
    }

    void count() {
        counters.mapBytes = counters.depthBytes = 0;
        for (const gl::MirrorLevel& l : levels) {
            if (!l.colour) continue;
            counters.mapBytes += l.texels() * bytesOf(options.format);
            counters.depthBytes += l.texels() * (l.withDistance() ? 8u : 4u);
        }
        counters.blurBytes = blur.bytes();
        const std::uint64_t face =
            static_cast<std::uint64_t>(faceSize) * static_cast<std::uint64_t>(faceSize);
        const std::uint64_t map =
            face * bytesOf(options.format) * (options.environments == CurvedMaps::cube ? 6u : 2u);
        counters.environmentBytes = 0;
        for (const gl::Texture& t : environments)
            if (t) counters.environmentBytes += map;
        counters.spareBytes = (spare ? map : 0) + (spareDepth ? face * 4 : 0);
    }
};

MirrorPass::MirrorPass(const MirrorPassOptions& options) : impl_(std::make_unique<Impl>()) {
    impl_->options = options;
}
MirrorPass::~MirrorPass() = default;
MirrorPass::MirrorPass(MirrorPass&&) noexcept = default;
MirrorPass& MirrorPass::operator=(MirrorPass&&) noexcept = default;

void MirrorPass::drawEnvironments(const ReflectionTree& tree, MirrorScene& scene, std::size_t curved) {
    Impl& my = *impl_;
    const std::vector<ReflectionStep> steps = tree.environmentSteps();
    my.look(tree);
    std::size_t at = 0;
    while (at < steps.size()) {
        const ReflectionStep& step = steps[at];
        if (step.what == ReflectionStep::What::publish) {
            const EnvironmentJob& job = tree.environments[step.node];
            // What was shown so far becomes the next one to be drawn.
            std::swap(my.environments[job.curved], my.spare);
            scene.publish(job, my.environments[job.curved].name());
            ++at;
            continue;
        }
        const ReflectionRoot& root = tree.roots[step.node];
        my.requireSpare(root.size.x);
        my.environments.resize(
            std::max(my.environments.size(), std::max<std::size_t>(curved, root.curved + 1)));
        my.spareTarget.attachLayer(GL_COLOR_ATTACHMENT0, my.spare.name(), static_cast<int>(root.face));
        Impl::Image image;
        image.target.framebuffer = my.spareTarget.name();
        image.target.viewport = image.target.scissor = {glm::ivec2(0), root.size};
        image.target.mirrored = root.view.mirrored();
        bind(image.target);
        clearDepth();
        scene.drawFace(tree, root, image.target);
        ++my.counters.faces;
        my.counters.texels += static_cast<std::uint64_t>(image.target.scissor.area());
        at = my.run(tree, steps, at + 1, scene, image);
    }
    my.count();
}

void MirrorPass::drawReflections(const ReflectionTree& tree, std::uint32_t root, MirrorScene& scene,
                                 const MirrorTarget& target) {
    Impl& my = *impl_;
    const std::vector<ReflectionStep> steps = tree.stepsOf(root);
    if (steps.empty()) return;
    my.look(tree);
    Impl::Image image;
    image.target = target;
    my.run(tree, steps, 0, scene, image);
    bind(target);
    my.count();
}

std::uint32_t MirrorPass::environment(std::size_t curved) const {
    return curved < impl_->environments.size() ? impl_->environments[curved].name() : 0;
}

void MirrorPass::trim(const ReflectionTree& tree) {
    Impl& my = *impl_;
    if (my.levels.size() > tree.levelSize.size()) my.levels.resize(tree.levelSize.size());
    if (tree.levelSize.empty()) my.blur.release();
    my.count();
}

void MirrorPass::release() {
    impl_->levels.clear();
    impl_->blur.release();
    impl_->environments.clear();
    impl_->spare = gl::Texture();
    impl_->spareDepth = gl::Texture();
    impl_->spareTarget = gl::Framebuffer();
    impl_->faceSize = 0;
    impl_->count();
}

const MirrorPassCounters& MirrorPass::counters() const {
    return impl_->counters;
}

void MirrorPass::resetCounters() {
    MirrorPassCounters fresh;
    std::swap(impl_->counters, fresh);
    impl_->count();
}

}  // namespace reflection
