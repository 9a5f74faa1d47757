#include "reflection/gl/MirrorPass.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "reflection/gl/MirrorMaps.h"
#include "reflection/planar/MapAtlas.h"

namespace reflection {

namespace {

void clearDepth() {
    glDepthMask(GL_TRUE);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);
}

}  // namespace

using gl::MirrorImage;

struct MirrorPass::Impl {
    explicit Impl(const MirrorPassOptions& given) : options(given), maps(given) {}

    MirrorPassOptions options;
    MirrorPassCounters counters;
    gl::MirrorMaps maps;
    std::vector<gl::Texture> environments;  ///< complete, one a curved reflector
    gl::Texture spare, spareDepth;          ///< the one being drawn
    gl::Framebuffer spareTarget;
    int faceSize = 0;
    std::uint64_t faceTexels = 0;
    /// The maps of a view that are made and not yet shown.
    struct Made {
        std::uint32_t root = 0;
        std::vector<glm::ivec2> origins;  ///< of each node
    };
    std::optional<Made> made;

    /// Takes steps from `at` on while they belong into `image`; a node's own steps are taken inside it.
    std::size_t run(const ReflectionTree& tree, std::span<const ReflectionStep> steps, std::size_t at,
                    MirrorScene& scene, const MirrorImage& image) {
        while (at < steps.size() && steps[at].what == ReflectionStep::What::draw) {
            const AtlasGroup::Place place{steps[at].node, glm::ivec2(0)};
            const ReflectionNode& node = tree.nodes[place.node];
            maps.require(node.level, glm::max(tree.levelSize[node.level], node.resolution));
            const MirrorImage below = maps.draw(tree, node, scene, place.origin, false);
            at = run(tree, steps, at + 1, scene, below);
            scene.finishNode(tree, node, below.target);
            maps.filter(tree, std::span(&place, 1));
            maps.apply(tree, node, scene, place.origin, image);
            ++at;
        }
        return at;
    }

    /// Draws a group's maps, the deepest level first.
    void make(const ReflectionTree& tree, const ReflectionChildren& children, const AtlasGroup& group,
              MirrorScene& scene, std::vector<glm::ivec2>& origins) {
        const std::uint32_t first = tree.nodes[group.tops.front()].level;
        for (std::size_t k = group.levels.size(); k-- > 0;) {
            const AtlasGroup::Level& level = group.levels[k];
            const auto index = first + static_cast<std::uint32_t>(k);
            maps.require(index, level.size);
            maps.clear(index);
            for (const AtlasGroup::Place& p : level.places) {
                origins[p.node] = p.origin;
                const ReflectionNode& node = tree.nodes[p.node];
                const MirrorImage image = maps.draw(tree, node, scene, p.origin, true);
                for (const std::uint32_t child : children.ofNode[p.node])
                    maps.apply(tree, tree.nodes[child], scene, origins[child], image);
                scene.finishNode(tree, node, image.target);
            }
            maps.filter(tree, level.places);
        }
    }

    /// The one group of all reflections met in a view; none where they do not fit into one.
    std::optional<AtlasGroup> oneGroup(const ReflectionTree& tree, const ReflectionChildren& children,
                                       const std::vector<std::uint32_t>& tops) const {
        std::vector<AtlasGroup> groups = atlasGroups(tree, children, tops, limits());
        if (groups.size() != 1 || !groups.front().fits) return std::nullopt;
        return std::move(groups.front());
    }

    /// The reflections met in an image, with as few changes of target as their maps' size allows.
    void runTogether(const ReflectionTree& tree, const ReflectionChildren& children,
                     const std::vector<std::uint32_t>& tops, MirrorScene& scene, const MirrorImage& image) {
        std::vector<glm::ivec2> origins(tree.nodes.size(), glm::ivec2(0));
        for (const AtlasGroup& group : atlasGroups(tree, children, tops, limits())) {
            if (group.fits) {
                make(tree, children, group, scene, origins);
            } else {
                const AtlasGroup::Place place{group.tops.front(), glm::ivec2(0)};
                const ReflectionNode& node = tree.nodes[place.node];
                maps.require(node.level, node.resolution);
                const MirrorImage below = maps.draw(tree, node, scene, place.origin, false);
                runTogether(tree, children, children.ofNode[place.node], scene, below);
                scene.finishNode(tree, node, below.target);
                maps.filter(tree, std::span(&place, 1));
            }
            for (const std::uint32_t top : group.tops)
                maps.apply(tree, tree.nodes[top], scene, origins[top], image);
        }
    }
    AtlasLimits limits() const {
        AtlasLimits most;
        most.most = glm::ivec2(options.largestAtlas);
        return most;
    }

    MirrorImage startFace(const ReflectionTree& tree, const ReflectionRoot& root, MirrorScene& scene) {
        MirrorImage image;
        if (layered())
            image.target.layer = static_cast<int>(root.face);
        else
            spareTarget.attachLayer(GL_COLOR_ATTACHMENT0, spare.name(), static_cast<int>(root.face));
        image.target.framebuffer = spareTarget.name();
        image.target.viewport = image.target.scissor = {glm::ivec2(0), root.size};
        image.target.mirrored = root.view.mirrored();
        gl::bind(image.target);
        // Of all layers at once.
        if (!layered() || root.face == 0) clearDepth();
        scene.drawFace(tree, root, image.target);
        ++counters.faces;
        faceTexels += static_cast<std::uint64_t>(image.target.scissor.area());
        return image;
    }

    bool layered() const { return options.together && options.layered; }

    /// All faces of a reflector's map, their reflections together where these fit.
    void facesTogether(const ReflectionTree& tree, const ReflectionChildren& children,
                       const EnvironmentJob& job, MirrorScene& scene) {
        std::vector<std::uint32_t> tops;
        for (std::uint32_t r = job.firstRoot; r < job.firstRoot + job.rootCount; ++r)
            tops.insert(tops.end(), children.ofRoot[r].begin(), children.ofRoot[r].end());
        const std::optional<AtlasGroup> group = oneGroup(tree, children, tops);
        const bool one = group || tops.empty();
        std::vector<glm::ivec2> origins(tree.nodes.size(), glm::ivec2(0));
        if (group) make(tree, children, *group, scene, origins);
        if (layered()) spareTarget.attach(GL_COLOR_ATTACHMENT0, spare.name());
        for (std::uint32_t r = job.firstRoot; r < job.firstRoot + job.rootCount; ++r) {
            const MirrorImage image = startFace(tree, tree.roots[r], scene);
            if (!one) runTogether(tree, children, children.ofRoot[r], scene, image);
            if (one)
                for (const std::uint32_t top : children.ofRoot[r])
                    maps.apply(tree, tree.nodes[top], scene, origins[top], image);
            scene.finishFace(tree, tree.roots[r], image.target);
        }
    }

    void publish(const EnvironmentJob& job, MirrorScene& scene) {
        // What was shown so far becomes the next one to be drawn.
        std::swap(environments[job.curved], spare);
        if (options.prefilter) glGenerateTextureMipmap(environments[job.curved].name());
        scene.publish(job, environments[job.curved].name());
    }

    MirrorFormat environmentFormat() const {
        return options.nearness ? MirrorFormat::rgba16f : options.format;
    }
    void requireSpare(int size) {
        const bool cube = options.environments == CurvedMaps::cube;
        if (faceSize != size) {
            faceSize = size;
            environments.clear();
            spare = gl::Texture();
            const GLenum depth = GL_DEPTH_COMPONENT32F;
            spareDepth = !layered() ? gl::Texture::image2D(depth, size, size)
                         : cube     ? gl::Texture::cube(depth, size)
                                    : gl::Texture::array2D(depth, size, size, 2);
            spareTarget = gl::Framebuffer::create();
            spareTarget.attach(GL_DEPTH_ATTACHMENT, spareDepth.name());
        }
        if (spare) return;
        const GLenum format = gl::glFormat(environmentFormat());
        const int levels = options.prefilter ? gl::mipLevels(size) : 1;
        spare = cube ? gl::Texture::cube(format, size, levels)
                     : gl::Texture::array2D(format, size, size, 2, levels);
        spare.filter(levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR, GL_LINEAR).wrap(GL_CLAMP_TO_EDGE);
    }

    void count() {
        maps.count(counters);
        counters.images = maps.drawn.images;
        counters.filtered = maps.drawn.filtered;
        counters.texels = maps.drawn.texels + faceTexels;
        const std::uint64_t face =
            static_cast<std::uint64_t>(faceSize) * static_cast<std::uint64_t>(faceSize);
        const std::uint64_t map = (options.prefilter ? face * 4 / 3 : face) *
                                  gl::bytesOf(environmentFormat()) *
                                  (options.environments == CurvedMaps::cube ? 6u : 2u);
        counters.environmentBytes = 0;
        for (const gl::Texture& t : environments)
            if (t) counters.environmentBytes += map;
        const std::uint64_t depths = !layered() ? 1 : options.environments == CurvedMaps::cube ? 6 : 2;
        counters.spareBytes = (spare ? map : 0) + (spareDepth ? depths * face * 4 : 0);
    }
};

MirrorPass::MirrorPass(const MirrorPassOptions& options) : impl_(std::make_unique<Impl>(options)) {}
MirrorPass::~MirrorPass() = default;
MirrorPass::MirrorPass(MirrorPass&&) noexcept = default;
MirrorPass& MirrorPass::operator=(MirrorPass&&) noexcept = default;

void MirrorPass::drawEnvironments(const ReflectionTree& tree, MirrorScene& scene, std::size_t curved) {
    Impl& my = *impl_;
    if (tree.environments.empty()) return;
    my.maps.look(tree);
    const auto prepare = [&](const EnvironmentJob& job) {
        my.requireSpare(tree.roots[job.firstRoot].size.x);
        my.environments.resize(
            std::max(my.environments.size(), std::max<std::size_t>(curved, job.curved + 1)));
    };
    if (my.options.together) {
        const ReflectionChildren children(tree);
        for (const EnvironmentJob& job : tree.environments) {
            prepare(job);
            my.facesTogether(tree, children, job, scene);
            my.publish(job, scene);
        }
        my.count();
        return;
    }
    const std::vector<ReflectionStep> steps = tree.environmentSteps();
    std::size_t at = 0, job = 0;
    while (at < steps.size()) {
        const ReflectionStep& step = steps[at];
        if (step.what == ReflectionStep::What::publish) {
            my.publish(tree.environments[step.node], scene);
            ++at, ++job;
            continue;
        }
        prepare(tree.environments[job]);
        const ReflectionRoot& root = tree.roots[step.node];
        const gl::MirrorImage image = my.startFace(tree, root, scene);
        at = my.run(tree, steps, at + 1, scene, image);
        scene.finishFace(tree, root, image.target);
    }
    my.count();
}

void MirrorPass::makeReflections(const ReflectionTree& tree, std::uint32_t root, MirrorScene& scene) {
    Impl& my = *impl_;
    my.made.reset();
    if (!my.options.together || root >= tree.roots.size()) return;
    const ReflectionChildren children(tree);
    const std::optional<AtlasGroup> group = my.oneGroup(tree, children, children.ofRoot[root]);
    if (!group) return;
    my.maps.look(tree);
    my.made = Impl::Made{root, std::vector<glm::ivec2>(tree.nodes.size(), glm::ivec2(0))};
    my.make(tree, children, *group, scene, my.made->origins);
}

void MirrorPass::drawReflections(const ReflectionTree& tree, std::uint32_t root, MirrorScene& scene,
                                 const MirrorTarget& target) {
    Impl& my = *impl_;
    if (root >= tree.roots.size()) return;
    gl::MirrorImage image;
    image.target = target;
    if (my.made && my.made->root == root && my.made->origins.size() == tree.nodes.size()) {
        const ReflectionChildren children(tree);
        for (const std::uint32_t top : children.ofRoot[root])
            my.maps.apply(tree, tree.nodes[top], scene, my.made->origins[top], image);
    } else if (my.options.together) {
        const ReflectionChildren children(tree);
        if (children.ofRoot[root].empty()) return;
        my.maps.look(tree);
        my.runTogether(tree, children, children.ofRoot[root], scene, image);
    } else {
        const std::vector<ReflectionStep> steps = tree.stepsOf(root);
        if (steps.empty()) return;
        my.maps.look(tree);
        my.run(tree, steps, 0, scene, image);
    }
    my.made.reset();
    gl::bind(target);
    my.count();
}

void MirrorPass::trim(const ReflectionTree& tree) {
    impl_->maps.keep(tree.levelSize.size());
    impl_->count();
}

const MirrorPassCounters& MirrorPass::counters() const {
    return impl_->counters;
}

void MirrorPass::resetCounters() {
    MirrorPassCounters fresh;
    std::swap(impl_->counters, fresh);
    impl_->maps.drawn = {};
    impl_->faceTexels = 0;
    impl_->count();
}

}  // namespace reflection
