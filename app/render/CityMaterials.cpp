#include "app/render/CityMaterials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>

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

    constexpr auto layers = static_cast<int>(city::Pattern::count);
    patterns_ = Texture::array2D(GL_RGBA8, 1, 1, layers);
    const std::vector<std::uint8_t> white(static_cast<std::size_t>(layers) * 4, 255);
    glTextureSubImage3D(patterns_.name(), 0, 0, 0, 0, 1, 1, layers, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
}

void CityMaterials::bind() const {
    patterns_.bind(0);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, table_.name());
}

}  // namespace app
