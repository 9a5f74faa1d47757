#include "reflection/reference_maps/ReferenceMap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace reflection {

namespace {

/// Samples within this ratio of the median count as one surface; a texel's samples on one plane differ by
/// more only at less than about 2 degrees of grazing, where a texel is a smear anyway.
constexpr float sameSurface = 1.25f;

}  // namespace

float representativeDistance(std::span<float> samples) {
    std::sort(samples.begin(), samples.end());
    const float median = samples[(samples.size() - 1) / 2];
    if (std::isinf(median)) return median;
    float sum = 0;
    int count = 0;
    for (float s : samples) {
        if (s > median * sameSurface || s * sameSurface < median) continue;
        sum += 1 / std::max(s, 1e-6f);
        ++count;
    }
    return static_cast<float>(count) / sum;
}

ReferenceMap halved(const ReferenceMap& map) {
    ReferenceMap half;
    half.position = map.position;
    half.faceSize = map.faceSize / 2;
    half.colour.resize(half.texelCount());
    half.distance.resize(half.texelCount());
    const auto from = static_cast<std::size_t>(map.faceSize), to = static_cast<std::size_t>(half.faceSize);
    for (std::size_t row = 0; row < 6 * to; ++row) {
        for (std::size_t x = 0; x < to; ++x) {
            const std::size_t i = 2 * row * from + 2 * x;
            std::array<float, 4> samples{map.distance[i], map.distance[i + 1], map.distance[i + from],
                                         map.distance[i + from + 1]};
            half.colour[row * to + x] =
                0.25f * (map.colour[i] + map.colour[i + 1] + map.colour[i + from] + map.colour[i + from + 1]);
            half.distance[row * to + x] = representativeDistance(samples);
        }
    }
    return half;
}

}  // namespace reflection
