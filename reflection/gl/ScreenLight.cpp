#include "reflection/gl/ScreenLight.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace reflection {

std::uint32_t packSharedExponent(const glm::vec3& radiance) {
    static constexpr float most = 65408;  // 511 / 512 * 2^16
    const auto kept = [](float x) { return x > 0 ? std::min(x, most) : 0.0f; };
    const float r = kept(radiance.r), g = kept(radiance.g), b = kept(radiance.b);
    const float greatest = std::max({r, g, b});
    // floor(log2(greatest)) + 1 + 15, from the float's own exponent.
    int exponent = std::max(static_cast<int>(std::bit_cast<std::uint32_t>(greatest) >> 23) - 127, -16) + 16;
    const auto scaleOf = [](int e) {  // 2^(15 + 9 - e)
        return std::bit_cast<float>(static_cast<std::uint32_t>(24 - e + 127) << 23);
    };
    if (static_cast<std::uint32_t>(greatest * scaleOf(exponent) + 0.5f) == 512) ++exponent;
    const float scale = scaleOf(exponent);
    const auto part = [&](float x) { return static_cast<std::uint32_t>(x * scale + 0.5f); };
    return part(r) | part(g) << 9 | part(b) << 18 | static_cast<std::uint32_t>(exponent) << 27;
}

void ScreenLight::upload(std::span<const glm::vec3> radiance, glm::ivec2 size, glm::ivec2 low,
                         glm::ivec2 high) {
    if (size.x <= 0 || size.y <= 0) return;
    if (size_ != size) {
        size_ = size;
        texture_ = gl::Texture::image2D(GL_RGB9_E5, size.x, size.y);
        texture_.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
        low = glm::ivec2(0);
        high = size;
    }
    const glm::ivec2 extent = high - low;
    if (extent.x <= 0 || extent.y <= 0) return;
    words_.resize(static_cast<std::size_t>(extent.x) * static_cast<std::size_t>(extent.y));
    tbb::parallel_for(0, extent.y, [&](int row) {
        const glm::vec3* from =
            &radiance[static_cast<std::size_t>(high.y - 1 - row) * static_cast<std::size_t>(size.x) +
                      static_cast<std::size_t>(low.x)];
        std::uint32_t* to = &words_[static_cast<std::size_t>(row) * static_cast<std::size_t>(extent.x)];
        std::transform(from, from + extent.x, to, packSharedExponent);
    });
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(texture_.name(), 0, low.x, size.y - high.y, extent.x, extent.y, GL_RGB,
                        GL_UNSIGNED_INT_5_9_9_9_REV, words_.data());
}

}  // namespace reflection
