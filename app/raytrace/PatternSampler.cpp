#include "app/raytrace/PatternSampler.h"

#include <algorithm>
#include <cmath>

namespace app {

PatternSampler::PatternSampler() : mips_(patternMips()) {}

PatternSampler::Level PatternSampler::levelOf(float repeats, TextureFilter filter) const {
    const float texels = repeats * static_cast<float>(mips_.size);
    const int last = mips_.levels() - 1;
    if (!(texels > 0)) return {};
    if (filter == TextureFilter::standard) {
        const float level = std::clamp(std::log2(texels), 0.0f, static_cast<float>(last));
        const int lower = std::min(static_cast<int>(level), last);
        return {lower, level - static_cast<float>(lower)};
    }
    // lp_build_brilinear_rho with a factor of two: levels change where they are equally far, and are blended
    // over half of the way.
    constexpr float factor = 2;
    int exponent = 0;
    const float mantissa = 2 * std::frexp(texels * ((2 * factor - 0.5f) / (1.41421356f * factor)), &exponent);
    const int lower = exponent - 1;
    if (lower < 0) return {};
    if (lower >= last) return {last, 0};
    return {lower, std::clamp(mantissa * factor + 1 - 2 * factor, 0.0f, 1.0f)};
}

template <int first, int count>
void PatternSampler::lookUp(std::uint32_t pattern, const glm::vec2& texcoord, int level, float weight,
                            float* sum) const {
    const int size = mips_.size >> level;
    const int mask = size - 1;
    const std::uint8_t* texels =
        mips_.texels[std::min<std::size_t>(pattern, mips_.texels.size() - 1)][static_cast<std::size_t>(level)]
            .data();
    const float x = (texcoord.x - std::floor(texcoord.x)) * static_cast<float>(size) - 0.5f;
    const float y = (texcoord.y - std::floor(texcoord.y)) * static_cast<float>(size) - 0.5f;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
    const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    for (int k = 0; k < 4; ++k) {
        const int tx = (i + (k & 1)) & mask, ty = (j + (k >> 1)) & mask;
        const std::uint8_t* texel = texels + 4 * (ty * size + tx) + first;
        const float w = weight * weights[k] * (1.0f / 255.0f);
        for (int c = 0; c < count; ++c) sum[c] += w * static_cast<float>(texel[c]);
    }
}

glm::vec4 PatternSampler::at(std::uint32_t pattern, const glm::vec2& texcoord, Level level) const {
    if (!std::isfinite(texcoord.x) || !std::isfinite(texcoord.y)) return glm::vec4(1);
    glm::vec4 sum(0);
    lookUp<0, 4>(pattern, texcoord, level.lower, 1 - level.share, &sum.x);
    if (level.share > 0) lookUp<0, 4>(pattern, texcoord, level.lower + 1, level.share, &sum.x);
    return sum;
}

float PatternSampler::opacityAt(std::uint32_t pattern, const glm::vec2& texcoord, Level level) const {
    if (!std::isfinite(texcoord.x) || !std::isfinite(texcoord.y)) return 1;
    float sum = 0;
    lookUp<3, 1>(pattern, texcoord, level.lower, 1 - level.share, &sum);
    if (level.share > 0) lookUp<3, 1>(pattern, texcoord, level.lower + 1, level.share, &sum);
    return sum;
}

}  // namespace app
