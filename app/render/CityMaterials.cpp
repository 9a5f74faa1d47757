#include "app/render/CityMaterials.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>

#include "city/model/PatternImages.h"
#include "reflection/gl/SoftwareRenderer.h"

namespace app {

namespace {

/// A picture in linear floats, halved step by step. Colours are stored as square roots: almost as even to the
/// eye as sRGB, but decoded with one multiplication, and plain 8 bit textures take the fastest path of a
/// software rasteriser.
class MipChain {
  public:
    /// Precondition: image.rgba holds image.size^2 texels.
    MipChain(const city::PatternImage& image, int size)
        : size_(size), texels_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                // Nearest texel: a picture that is smaller than the others is enlarged.
                const int sx = x * image.size / size;
                const int sy = y * image.size / size;
                const std::uint8_t* c =
                    &image.rgba[4 * (static_cast<std::size_t>(sy) * static_cast<std::size_t>(image.size) +
                                     static_cast<std::size_t>(sx))];
                texels_[index(x, y)] = {linear(c[0]), linear(c[1]), linear(c[2]),
                                        static_cast<float>(c[3]) / 255.f};
            }
        }
        for (const glm::vec4& t : texels_) opaqueShare_ += t.a >= 0.5f ? 1.0 : 0.0;
        opaqueShare_ /= static_cast<double>(texels_.size());
    }

    int size() const { return size_; }

    void halve() {
        const int half = std::max(size_ / 2, 1);
        std::vector<glm::vec4> next(static_cast<std::size_t>(half) * static_cast<std::size_t>(half));
        for (int y = 0; y < half && size_ > 1; ++y) {
            for (int x = 0; x < half; ++x) {
                glm::vec4 sum(0);
                float weight = 0;
                for (int k = 0; k < 4; ++k) {
                    const glm::vec4& t = texels_[index(2 * x + k % 2, 2 * y + k / 2)];
                    // Colours count by their opacity, so that what shows through holes does not bleed in.
                    const float w = t.a + 1e-4f;
                    sum += glm::vec4(glm::vec3(t) * w, t.a);
                    weight += w;
                }
                next[static_cast<std::size_t>(y) * static_cast<std::size_t>(half) +
                     static_cast<std::size_t>(x)] = glm::vec4(glm::vec3(sum) / weight, sum.a / 4);
            }
        }
        texels_ = std::move(next);
        size_ = half;
    }

    /// 8 bit: roots of the colours; alpha scaled so that as large a share passes the test at 0.5 as in the
    /// full picture: leaves keep their mass in the distance (Castano 2010).
    std::vector<std::uint8_t> encoded() const {
        float scale = 1;
        if (opaqueShare_ < 1) {
            std::vector<float> alphas;
            for (const glm::vec4& t : texels_) alphas.push_back(t.a);
            const auto rank =
                static_cast<std::size_t>((1 - opaqueShare_) * static_cast<double>(alphas.size()));
            const auto at = alphas.begin() + static_cast<std::ptrdiff_t>(std::min(rank, alphas.size() - 1));
            std::nth_element(alphas.begin(), at, alphas.end());
            if (*at > 0) scale = 0.5f / *at;
        }
        std::vector<std::uint8_t> bytes;
        for (const glm::vec4& t : texels_) {
            for (int i = 0; i < 3; ++i) bytes.push_back(byte(std::sqrt(t[i])));
            bytes.push_back(byte(t.a * scale));
        }
        return bytes;
    }

  private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x);
    }
    static std::uint8_t byte(float x) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.f, 1.f) * 255.f));
    }
    static float linear(std::uint8_t encoded) {
        const float x = static_cast<float>(encoded) / 255.f;
        return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
    }

    int size_;
    std::vector<glm::vec4> texels_;
    double opaqueShare_ = 0;
};

}  // namespace

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

    const auto images = city::paintPatterns();
    int size = 1;
    for (const city::PatternImage& image : images) size = std::max(size, image.size);
    const int levels = mipLevels(size);
    patterns_ = Texture::array2D(GL_RGBA8, size, size, static_cast<int>(images.size()), levels);
    patterns_.filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR).wrap(GL_REPEAT);
    // Facades seen aslant stay sharp: 0.5 dB in local maps. Graphics cards have it for nearly nothing;
    // llvmpipe takes twice as long for a frame.
    if (!reflection::softwareRenderer() && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTextureParameterf(patterns_.name(), GL_TEXTURE_MAX_ANISOTROPY_EXT, 8);
    for (std::size_t layer = 0; layer < images.size(); ++layer) {
        MipChain chain(images[layer], size);
        for (int level = 0; level < levels; ++level) {
            const std::vector<std::uint8_t> texels = chain.encoded();
            glTextureSubImage3D(patterns_.name(), level, 0, 0, static_cast<int>(layer), chain.size(),
                                chain.size(), 1, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
            chain.halve();
        }
    }
}

void CityMaterials::bind() const {
    patterns_.bind(0);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, table_.name());
}

}  // namespace app
