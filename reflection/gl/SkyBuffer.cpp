#include "reflection/gl/SkyBuffer.h"

#include <span>

namespace reflection {

std::uint32_t SkyBuffer::firstTexelOf(const LocalMap* sky) {
    if (sky == nullptr) return none;
    const auto [place, isNew] = first_.try_emplace(sky, static_cast<std::uint32_t>(texels_.size()));
    if (!isNew) return place->second;
    texels_.reserve(texels_.size() + sky->red.size());
    for (std::size_t i = 0; i < sky->red.size(); ++i)
        texels_.emplace_back(sky->red[i], sky->green[i], sky->blue[i], 0.0f);
    upload();
    return place->second;
}

void SkyBuffer::forget() {
    first_.clear();
    texels_.clear();
}

void SkyBuffer::upload() {
    static constexpr glm::vec4 nothing(0);
    buffer_.replace(
        texels_.empty() ? std::span<const glm::vec4>(&nothing, 1) : std::span<const glm::vec4>(texels_),
        GL_STATIC_DRAW);
}

}  // namespace reflection
