#include "vehicles/models/WheelArch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <unordered_map>

#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"

namespace vehicles {
namespace {

/// Bends the surface outwards near the opening: by `flare` at the edge, fading over `reach` metres, with
/// normals to match.
void flareOut(Shell& half, const WheelArch& arch, float reach) {
    for (std::size_t i = 0; i < half.positions.size(); ++i) {
        glm::vec3& p = half.positions[i];
        glm::vec3& n = half.normals[i];
        if (p.y < arch.inner || n.y < 0.3f) continue;
        const glm::vec3 away{p.x - arch.x, 0, p.z - arch.z};
        const float r = glm::length(away);
        const float t = std::clamp((arch.radius + reach - r) / reach, 0.0f, 1.0f);
        if (t <= 0 || r < 0.1f) continue;
        // height = flare * t^2 (3 - 2t): flat at both ends, so that the lip's edge and its foot both stay
        // smooth.
        const float slope = -6 * t * (1 - t) / reach * arch.flare;
        p.y += arch.flare * t * t * (3 - 2 * t);
        // n of (p + h e_y): the surface y(x, z) gains the gradient of h.
        const glm::vec3 gradient = slope / r * away;
        n = glm::normalize(n - n.y * gradient);
    }
}

}  // namespace

void cutWheelArch(Shell& half, city::Mesh& parts, const WheelArch& arch) {
    const auto circle = [&](float radius) -> Field {
        return [=](const glm::vec3& p, const glm::vec3&) {
            return std::max(std::hypot(p.x - arch.x, p.z - arch.z) - radius, arch.inner - p.y);
        };
    };
    if (arch.flare > 0) {
        constexpr float reach = 0.05f;
        half.refine(circle(arch.radius), 0.03f);
        for (const float share : {0.25f, 0.5f, 0.75f, 1.0f}) half.divide(circle(arch.radius + share * reach));
        half.divide(circle(arch.radius));
        flareOut(half, arch, reach);
    } else {
        half.refine(circle(arch.radius), 0.04f);
    }
    half.remove(circle(arch.radius));

    // The opening's edge: edges of one triangle only, on the circle.
    std::unordered_map<std::uint64_t, int> uses;
    const auto key = [](std::uint32_t a, std::uint32_t b) {
        return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    };
    for (const auto& t : half.triangles)
        for (int k = 0; k < 3; ++k) ++uses[key(t.corner[k], t.corner[(k + 1) % 3])];
    const auto onCircle = [&](std::uint32_t i) {
        const glm::vec3& p = half.positions[i];
        return p.y > arch.inner - 1e-3f &&
               std::abs(std::hypot(p.x - arch.x, p.z - arch.z) - arch.radius) < 4e-3f;
    };
    constexpr float lip = 0.022f;
    const auto strip = [&](std::uint32_t a, std::uint32_t b, float fromDepth, float toY, Surface surface,
                           bool absolute) {
        glm::vec3 corners[4] = {half.positions[a], half.positions[b], half.positions[b], half.positions[a]};
        corners[0].y -= fromDepth;
        corners[1].y -= fromDepth;
        for (int k = 2; k < 4; ++k) corners[k].y = absolute ? toY : corners[k].y - toY;
        city::Vertex v[4];
        for (int k = 0; k < 4; ++k) {
            const glm::vec3 n = glm::normalize(glm::vec3(arch.x - corners[k].x, 0, arch.z - corners[k].z));
            v[k] = {corners[k], n, glm::vec2(0), static_cast<std::uint32_t>(surface)};
        }
        // The triangle that owns the edge runs a -> b; the strip hangs on its other side, so it starts b ->
        // a.
        parts.addQuad(v[1], v[0], v[3], v[2]);
    };
    for (const auto& t : half.triangles)
        for (int k = 0; k < 3; ++k) {
            const auto a = t.corner[k], b = t.corner[(k + 1) % 3];
            if (uses[key(a, b)] != 1 || !onCircle(a) || !onCircle(b)) continue;
            const bool outside = std::min(half.positions[a].y, half.positions[b].y) > arch.inner + lip;
            if (outside) strip(a, b, 0, lip, Surface::paint, false);
            strip(a, b, outside ? lip : 0, arch.inner, Surface::interior, true);
        }
    // The housing's end.
    const auto surface = static_cast<std::uint32_t>(Surface::interior);
    constexpr int steps = 20;
    const glm::vec3 n{0, 1, 0}, middle{arch.x, arch.inner, arch.z};
    const float start = -0.25f * glm::pi<float>(), sweep = 1.5f * glm::pi<float>();
    for (int s = 0; s < steps; ++s) {
        const auto at = [&](int i) {
            const float angle = start + sweep * static_cast<float>(i) / steps;
            return middle + (arch.radius + 0.01f) * glm::vec3(std::cos(angle), 0, std::sin(angle));
        };
        parts.addTriangle({middle, n, glm::vec2(0), surface}, {at(s + 1), n, glm::vec2(0), surface},
                          {at(s), n, glm::vec2(0), surface});
    }
}

}  // namespace vehicles
