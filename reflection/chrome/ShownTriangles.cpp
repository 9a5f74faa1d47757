#include "reflection/chrome/ShownTriangles.h"

#include <cmath>
#include <glm/common.hpp>

namespace reflection {

namespace {

/// Pixels by which a rasteriser may round a corner: OpenGL asks for four bits below a pixel at least.
constexpr float rounding = 1.f / 32;

}  // namespace

void showing(std::span<const VirtualVertex> vertices, std::span<const std::uint32_t> triangles,
             const VirtualWindow& window, std::vector<std::uint32_t>& out) {
    out.clear();
    std::vector<glm::vec2> at;
    at.reserve(vertices.size());
    const glm::vec2 half = 0.5f * glm::vec2(window.size);
    for (const VirtualVertex& v : vertices) {
        const glm::vec4 clip = window.clipFromVirtual * glm::vec4(v.fromEye, 1);
        // From middles of pixels, which then have whole numbers.
        at.push_back(clip.w > 0 ? glm::vec2(clip) / clip.w * half + half - 0.5f : glm::vec2(NAN));
    }
    const glm::vec2 first(window.pixels.low), last(window.pixels.high - 1);
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
        const glm::vec2 &a = at[triangles[k]], &b = at[triangles[k + 1]], &c = at[triangles[k + 2]];
        const glm::vec2 low = glm::max(glm::ceil(glm::min(glm::min(a, b), c) - rounding), first);
        const glm::vec2 high = glm::min(glm::floor(glm::max(glm::max(a, b), c) + rounding), last);
        const bool known = std::isfinite(a.x + b.x + c.x) && std::isfinite(a.y + b.y + c.y);
        if (known && (low.x > high.x || low.y > high.y)) continue;
        out.insert(out.end(), {triangles[k], triangles[k + 1], triangles[k + 2]});
    }
}

}  // namespace reflection
