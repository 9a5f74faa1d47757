#include "app/render/CityMaterials.h"

#include <epoxy/gl.h>

#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>

#include "app/frame/PatternMips.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

CityMaterials::CityMaterials(const std::vector<city::Material>& materials) {
    if (materials.size() > capacity) {
        throw std::runtime_error("The city has " + std::to_string(materials.size()) +
                                 " materials, more than the " + std::to_string(capacity) +
                                 " that can be drawn; merge materials of equal look.");
    }
    struct Entry {
        glm::vec4 tint{0.8f, 0.8f, 0.8f, 0};
        glm::vec4 emission{0};
    };
    std::vector<Entry> entries(capacity);
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const auto layer = static_cast<float>(materials[i].pattern);
        entries[i] = {glm::vec4(materials[i].tint, layer), glm::vec4(materials[i].emission, 0)};
    }
    using namespace reflection::gl;
    table_ = Buffer::filled(std::span<const Entry>(entries));

    const PatternMips mips = patternMips();
    const int levels = mips.levels();
    patterns_ =
        Texture::array2D(GL_RGBA8, mips.size, mips.size, static_cast<int>(mips.texels.size()), levels);
    patterns_.filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR).wrap(GL_REPEAT);
    // Facades seen aslant stay sharp: 0.5 dB in local maps. Graphics cards have it for nearly nothing;
    // llvmpipe takes twice as long for a frame.
    if (!reflection::softwareRenderer() && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTextureParameterf(patterns_.name(), GL_TEXTURE_MAX_ANISOTROPY_EXT, 8);
    for (std::size_t layer = 0; layer < mips.texels.size(); ++layer) {
        for (int level = 0; level < levels; ++level) {
            const int size = mips.size >> level;
            glTextureSubImage3D(patterns_.name(), level, 0, 0, static_cast<int>(layer), size, size, 1,
                                GL_RGBA, GL_UNSIGNED_BYTE,
                                mips.texels[layer][static_cast<std::size_t>(level)].data());
        }
    }
}

void CityMaterials::bind() const {
    patterns_.bind(0);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, table_.name());
}

}  // namespace app
