#include "vehicles/models/Bumper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <utility>

namespace vehicles {

float outlineAt(const Shell& half, float z, float x, float angle) {
    const glm::vec2 from{x, 0}, along{std::cos(angle), std::sin(angle)}, across{-along.y, along.x};
    float farthest = 0;
    for (const Shell::Triangle& t : half.triangles) {
        std::array<glm::vec2, 2> cut;
        int cuts = 0;
        for (int k = 0; k < 3 && cuts < 2; ++k) {
            const glm::vec3& a = half.positions[t.corner[static_cast<std::size_t>(k)]];
            const glm::vec3& b = half.positions[t.corner[static_cast<std::size_t>((k + 1) % 3)]];
            if ((a.z < z) == (b.z < z)) continue;
            const float s = (z - a.z) / (b.z - a.z);
            cut[static_cast<std::size_t>(cuts++)] = glm::vec2(a) + s * (glm::vec2(b) - glm::vec2(a)) - from;
        }
        if (cuts < 2) continue;
        const float left = glm::dot(cut[0], across), right = glm::dot(cut[1], across);
        if ((left < 0) == (right < 0)) continue;
        const float s = left / (left - right);
        farthest = std::max(farthest, glm::dot(cut[0] + s * (cut[1] - cut[0]), along));
    }
    return farthest;
}

namespace {

constexpr int stations = 26, across = 9;

/// The outline at even steps along it, from the plane of symmetry on, `standOff` metres before the shell.
std::vector<glm::vec2> pathOf(const Shell& half, const BumperShape& shape) {
    constexpr int looks = 60;
    std::vector<glm::vec2> seen;
    for (int i = 0; i <= looks; ++i) {
        const float turn = shape.halfAngle * static_cast<float>(i) / looks;
        // A hair off the plane of symmetry: the half shell ends there.
        const float angle = shape.rear ? glm::pi<float>() - turn : turn;
        const float hair = i == 0 ? (shape.rear ? -1e-3f : 1e-3f) : 0;
        const float reach = outlineAt(half, shape.z, shape.centre, angle + hair);
        if (reach <= 0) return {};
        seen.push_back(glm::vec2(shape.centre, 0) +
                       (reach + shape.standOff) * glm::vec2(std::cos(angle), std::sin(angle)));
    }
    // The shell's facets must not show in the chrome.
    for (int round = 0; round < 12; ++round) {
        const std::vector<glm::vec2> was = seen;
        for (std::size_t i = 0; i + 1 < seen.size(); ++i) {
            const glm::vec2 before = i == 0 ? glm::vec2(was[1].x, -was[1].y) : was[i - 1];
            seen[i] = 0.25f * before + 0.5f * was[i] + 0.25f * was[i + 1];
        }
    }
    std::vector<float> lengths{0};
    for (std::size_t i = 1; i < seen.size(); ++i)
        lengths.push_back(lengths.back() + glm::length(seen[i] - seen[i - 1]));
    std::vector<glm::vec2> path;
    for (int i = 0; i < stations; ++i) {
        const float want = lengths.back() * static_cast<float>(i) / (stations - 1);
        const auto next = std::upper_bound(lengths.begin(), lengths.end() - 1, want);
        const auto k = static_cast<std::size_t>(next - lengths.begin());
        const float s = (want - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
        path.push_back(glm::mix(seen[k - 1], seen[k], std::clamp(s, 0.0f, 1.0f)));
    }
    path.front().y = 0;
    return path;
}

}  // namespace

void addBumper(city::Mesh& parts, const Shell& half, const BumperShape& shape) {
    const std::vector<glm::vec2> path = pathOf(half, shape);
    if (path.empty()) return;
    const float step = glm::length(path[1] - path[0]);
    // From above to below over the outside; a ghost row on either side for the normals.
    const auto at = [&](int i, int j) {
        const bool ghost = i < 0;
        const auto k = static_cast<std::size_t>(std::min(ghost ? -i : i, stations - 1));
        const glm::vec2 before = k == 0 ? glm::vec2(path[1].x, -path[1].y) : path[k - 1];
        const glm::vec2 after = k + 1 < path.size() ? path[k + 1] : 2.0f * path[k] - path[k - 1];
        const glm::vec2 along = glm::normalize(after - before);
        const glm::vec2 out = shape.rear ? glm::vec2(-along.y, along.x) : glm::vec2(along.y, -along.x);
        // The last hand's breadth is drawn in as an ellipse is.
        const float left = step * static_cast<float>(stations - 1 - static_cast<int>(k));
        const float s = std::clamp(1 - left / 0.08f, 0.0f, 1.0f);
        const float size = std::sqrt(std::max(1 - s * s, 0.0025f));
        const float angle = glm::pi<float>() * (0.5f - static_cast<float>(j) / (across - 1));
        const glm::vec2 p = path[k] + out * (shape.depth * size * std::cos(angle));
        return glm::vec3(p.x, ghost ? -p.y : p.y, shape.z + shape.halfHeight * size * std::sin(angle));
    };
    const auto base = static_cast<std::uint32_t>(parts.vertices.size());
    const auto add = [&](const glm::vec3& position, const glm::vec3& normal) {
        parts.vertices.push_back(
            {position, normal, glm::vec2(0), static_cast<std::uint32_t>(Surface::chrome)});
    };
    for (int i = 0; i < stations; ++i)
        for (int j = 0; j < across; ++j) {
            const glm::vec3 along = at(std::min(i + 1, stations - 1), j) - at(i - 1, j);
            const glm::vec3 down = at(i, j + 1) - at(i, j - 1);
            glm::vec3 normal = glm::normalize(glm::cross(down, along));
            if (shape.rear) normal = -normal;
            if (i == 0) normal = glm::normalize(glm::vec3(normal.x, 0, normal.z));
            add(at(i, j), normal);
        }
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (shape.rear) std::swap(b, c);
        parts.indices.insert(parts.indices.end(), {a, b, c});
    };
    for (std::uint32_t i = 0; i + 1 < stations; ++i)
        for (std::uint32_t j = 0; j + 1 < across; ++j) {
            const std::uint32_t a = base + i * across + j, b = a + across;
            triangle(a, a + 1, b);
            triangle(b, a + 1, b + 1);
        }
    // Closed behind, within the vehicle's body, by the section's own level tangents and a plane between its
    // ends: with its other half a whole convex body.
    const glm::vec3 end = at(stations - 1, across / 2);
    const float back = shape.rear ? 1.0f : -1.0f;
    for (const float side : {1.0f, -1.0f})
        add({end.x, 0, shape.z + side * shape.halfHeight}, glm::normalize(glm::vec3(0.3f * back, 0, side)));
    const std::uint32_t top = base + stations * across, bottom = top + 1;
    for (std::uint32_t i = 0; i + 1 < stations; ++i) {
        const std::uint32_t a = base + i * across, b = a + across;
        triangle(top, a, b);
        triangle(bottom, b + across - 1, a + across - 1);
    }
    const std::uint32_t last = base + (stations - 1) * across;
    triangle(top, last, bottom);
    triangle(bottom, last, last + across - 1);
    // The end's own small face.
    for (std::uint32_t j = 1; j + 1 < across; ++j) triangle(last, last + j, last + j + 1);
}

}  // namespace vehicles
