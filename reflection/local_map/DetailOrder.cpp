#include "reflection/local_map/DetailOrder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace reflection {

SurfacePatch patchAround(const CubeFace& face, const float* reciprocal, int n, int x, int y) {
    const auto w = [&](int column, int row) {
        return reciprocal[static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
                          static_cast<std::size_t>(column)];
    };
    const float texelSize = 2.0f / static_cast<float>(n);
    const float s = (static_cast<float>(x) + 0.5f) * texelSize - 1;
    const float t = (static_cast<float>(y) + 0.5f) * texelSize - 1;
    const int left = std::max(x - 1, 0), right = std::min(x + 1, n - 1);
    const int above = std::max(y - 1, 0), below = std::min(y + 1, n - 1);
    const float own = w(x, y);
    float alongS = 0, alongT = 0;
    if (right > left) alongS = (w(right, y) - w(left, y)) / (static_cast<float>(right - left) * texelSize);
    if (below > above) alongT = (w(x, below) - w(x, above)) / (static_cast<float>(below - above) * texelSize);
    constexpr float least = 1 / PackedReferenceMap::skyDepth;
    return {(face.major + s * face.sAxis + t * face.tAxis) / std::max(own, least),
            (own - s * alongS - t * alongT) * face.major + alongS * face.sAxis + alongT * face.tAxis};
}

void orderByDetail(std::span<const Candidate> candidates, const SurfacePatch& patch,
                   std::span<std::uint8_t> order) {
    /// Share of the local map's own detail below which a surface is hidden, or as good as hidden.
    constexpr float grazing = 0.01f;
    std::array<float, 16> misfits{};
    const float own = glm::dot(patch.point, patch.point);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const glm::vec3 offset = candidates[k].offset;
        const glm::vec3 apart = patch.point - offset;
        const float squared = own / glm::dot(apart, apart);
        const float along = (1 - glm::dot(patch.plane, offset)) * squared;
        const float across = std::sqrt(squared);
        const float misfit = along > grazing ? std::max(std::max(along, across), 1 / std::min(along, across))
                                             : (1 / grazing) * (1 + 1 / squared);
        std::size_t at = k;
        for (; at > 0 && misfits[at - 1] > misfit; --at) {
            misfits[at] = misfits[at - 1];
            order[at] = order[at - 1];
        }
        misfits[at] = misfit;
        order[at] = static_cast<std::uint8_t>(k);
    }
}

}  // namespace reflection
