#include "app/display/OffscreenTarget.h"

#include <epoxy/gl.h>

#include <array>

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"

namespace app {

struct OffscreenTarget::Impl {
    reflection::gl::Texture colour;
    reflection::gl::Framebuffer framebuffer;
};

OffscreenTarget::OffscreenTarget(glm::ivec2 size)
    : size_(size),
      impl_(new Impl{reflection::gl::Texture::image2D(GL_RGBA8, size.x, size.y),
                     reflection::gl::Framebuffer::create()}) {
    impl_->framebuffer.attach(GL_COLOR_ATTACHMENT0, impl_->colour.name());
    impl_->framebuffer.requireComplete("pictures without a window");
}

OffscreenTarget::~OffscreenTarget() = default;

std::uint32_t OffscreenTarget::framebuffer() const {
    return impl_->framebuffer.name();
}

void OffscreenTarget::copyTo(std::uint32_t framebuffer, glm::ivec2 size) const {
    glBlitNamedFramebuffer(impl_->framebuffer.name(), framebuffer, 0, 0, size_.x, size_.y, 0, 0, size.x,
                           size.y, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

void finishDrawing() {
    glFinish();
}

std::vector<std::pair<std::string, std::string>> contextLimits() {
    struct Limit {
        const char* name;
        GLenum value;
    };
    constexpr std::array<Limit, 9> limits{{{"texture size", GL_MAX_TEXTURE_SIZE},
                                           {"cube map size", GL_MAX_CUBE_MAP_TEXTURE_SIZE},
                                           {"array layers", GL_MAX_ARRAY_TEXTURE_LAYERS},
                                           {"texture units", GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS},
                                           {"uniform block bytes", GL_MAX_UNIFORM_BLOCK_SIZE},
                                           {"storage block bytes", GL_MAX_SHADER_STORAGE_BLOCK_SIZE},
                                           {"buffer texture texels", GL_MAX_TEXTURE_BUFFER_SIZE},
                                           {"samples", GL_MAX_SAMPLES},
                                           {"compute invocations", GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS}}};
    std::vector<std::pair<std::string, std::string>> values;
    for (const Limit& limit : limits) {
        GLint64 value = 0;
        glGetInteger64v(limit.value, &value);
        values.emplace_back(limit.name, std::to_string(value));
    }
    return values;
}

}  // namespace app
