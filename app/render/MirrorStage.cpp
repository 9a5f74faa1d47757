#include "app/render/MirrorStage.h"

#include <epoxy/gl.h>

#include <optional>

#include "app/render/MirrorStencil.h"
#include "app/render/MirrorWorldRenderer.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;
using reflection::MirrorTarget;

struct MirrorStage::Impl {
    Impl(const MirrorWorld& w, glm::ivec2 s, reflection::CurvedMaps c,
         const reflection::MirrorPassOptions& options)
        : world(w),
          size(s),
          curved(c),
          nearness(options.nearness),
          arrays(w),
          renderer(w, c, options.nearness),
          pass(options) {
        const bool bytes = options.format == reflection::MirrorFormat::rgba8;
        colour = gl::Texture::image2D(bytes ? GL_RGBA8 : GL_RGBA16F, size.x, size.y);
        depth = gl::Texture::image2D(GL_DEPTH32F_STENCIL8, size.x, size.y);
        framebuffer = gl::Framebuffer::create();
        framebuffer.attach(GL_COLOR_ATTACHMENT0, colour.name())
            .attach(GL_DEPTH_STENCIL_ATTACHMENT, depth.name());
        framebuffer.requireComplete("a scene of mirrors");
        target.framebuffer = framebuffer.name();
        target.viewport = target.scissor = {glm::ivec2(0), size};
    }

    void plan(reflection::TreeSettings& settings) {
        settings.curved = curved;
        const reflection::TreeView view = world.view(size);
        tree = reflection::reflectionTree(std::span(&view, 1), arrays.scene(), settings);
    }

    void drawScene() {
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
        glViewport(0, 0, size.x, size.y);
        glDisable(GL_SCISSOR_TEST);
        glDepthMask(GL_TRUE);
        glClearDepth(0);
        glClearStencil(0);
        glStencilMask(0xff);
        glClear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
        renderer.drawRoot(tree, 0, target);
    }

    const MirrorWorld& world;
    glm::ivec2 size;
    reflection::CurvedMaps curved;
    bool nearness;
    MirrorWorldScene arrays;
    MirrorWorldRenderer renderer;
    reflection::MirrorPass pass;
    reflection::ReflectionTree tree;
    gl::Texture colour, depth;
    gl::Framebuffer framebuffer;
    MirrorTarget target;
    std::optional<MirrorWorldChrome> chrome;
    ChromeFrame chromeFrame;
};

MirrorStage::MirrorStage(const MirrorWorld& world, glm::ivec2 size, reflection::CurvedMaps curved,
                         const reflection::MirrorPassOptions& options)
    : impl_(std::make_unique<Impl>(world, size, curved, [&] {
          reflection::MirrorPassOptions same = options;
          same.environments = curved;
          same.layered = same.together && MirrorWorldRenderer::canDrawLayers();
          same.distances = same.distances || world.needsDistances();
          for (const MirrorWorld::Curved& c : world.curved)
              same.prefilter = same.prefilter || c.reflector.surface.roughness > 0;
          return same;
      }())) {}
MirrorStage::~MirrorStage() = default;

const reflection::ReflectionTree& MirrorStage::draw(reflection::TreeSettings settings) {
    Impl& my = *impl_;
    my.plan(settings);
    my.pass.drawEnvironments(my.tree, my.renderer, my.arrays.curved.size());
    for (const reflection::EnvironmentJob& job : my.tree.environments)
        my.arrays.curved[job.curved].hasMap = true;
    my.pass.makeReflections(my.tree, 0, my.renderer);
    my.drawScene();
    my.pass.drawReflections(my.tree, 0, my.renderer, my.target);
    my.renderer.finishRoot(my.tree, 0);
    my.chromeFrame = {};
    if (my.chrome)
        my.chromeFrame = my.chrome->draw(my.tree.roots[0].view, my.size, my.framebuffer.name(),
                                         {my.renderer.environments(), my.nearness});
    return my.tree;
}

void MirrorStage::setChrome(const reflection::VirtualMeshOptions& options, bool concave,
                            reflection::ChromeTreeOptions bounces) {
    Impl& my = *impl_;
    // Only cube maps can be looked up from where another reflector is seen.
    if (my.curved != reflection::CurvedMaps::cube) bounces.depth = 1;
    my.chrome.emplace(my.world, options, concave, bounces);
    for (std::size_t c = 0; c < my.world.curved.size(); ++c)
        my.renderer.setLeftOut(c, my.chrome->leftToChrome(c), my.chrome->reflectorsLeftToChrome(c));
}

const reflection::ChromeTree& MirrorStage::chromeTree() const {
    static const reflection::ChromeTree none;
    return impl_->chrome ? impl_->chrome->tree() : none;
}

void MirrorStage::searchChromeOnGpu() {
    if (impl_->chrome) impl_->chrome->searchOnGpu();
}

const ChromeFrame& MirrorStage::chromeFrame() const {
    return impl_->chromeFrame;
}

const reflection::ReflectionTree& MirrorStage::drawWithStencil(reflection::TreeSettings settings) {
    Impl& my = *impl_;
    my.plan(settings);
    my.drawScene();
    drawByStencil(my.tree, 0, my.world, my.renderer, my.target);
    return my.tree;
}

std::vector<glm::vec3> MirrorStage::read() const {
    const Impl& my = *impl_;
    const auto width = static_cast<std::size_t>(my.size.x), height = static_cast<std::size_t>(my.size.y);
    std::vector<float> raw(4 * width * height);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, my.framebuffer.name());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, my.size.x, my.size.y, GL_RGBA, GL_FLOAT, raw.data());
    std::vector<glm::vec3> image(width * height);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const float* p = &raw[4 * ((height - 1 - y) * width + x)];
            image[y * width + x] = {p[0], p[1], p[2]};
        }
    return image;
}

glm::ivec2 MirrorStage::size() const {
    return impl_->size;
}

void MirrorStage::setClusters(bool clusters) {
    impl_->renderer.setClusters(clusters);
}

void MirrorStage::setOblique(bool oblique) {
    impl_->renderer.setOblique(oblique);
}

reflection::MirrorPass& MirrorStage::pass() {
    return impl_->pass;
}

std::uint64_t MirrorStage::trianglesDrawn() const {
    return impl_->renderer.trianglesDrawn();
}

}  // namespace app
