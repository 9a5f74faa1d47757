#include "app/frame/PatternMips.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/vec4.hpp>

#include "city/model/PatternImages.h"

namespace app {

namespace {

/// A picture in linear floats, halved step by step.
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

int PatternMips::levels() const {
    return std::bit_width(static_cast<unsigned>(size));
}

PatternMips patternMips() {
    const auto images = city::paintPatterns();
    PatternMips mips;
    for (const city::PatternImage& image : images) mips.size = std::max(mips.size, image.size);
    mips.texels.resize(images.size());
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
        MipChain chain(images[i], mips.size);
        for (int level = 0; level < mips.levels(); ++level) {
            mips.texels[i].push_back(chain.encoded());
            chain.halve();
        }
    });
    return mips;
}

}  // namespace app
