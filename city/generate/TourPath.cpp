#include "city/generate/TourPath.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace city {

namespace {

/// Smooth in the plan; heights ease from key to key and never swing beyond them.
glm::vec3 curve(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, float t) {
    glm::vec3 p =
        0.5f * ((2.0f * b) +
                t * ((c - a) + t * ((2.0f * a - 5.0f * b + 4.0f * c - d) + t * (3.0f * (b - c) + d - a))));
    p.z = b.z + (c.z - b.z) * t * t * (3 - 2 * t);
    return p;
}

}  // namespace

std::vector<TourStop> makeTour(std::span<const TourKey> keys) {
    std::vector<TourStop> tour;
    if (keys.size() < 2) return tour;
    const auto key = [&](std::ptrdiff_t i) {
        return keys[static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(keys.size()) - 1))];
    };
    float time = 0;
    for (std::ptrdiff_t k = 0; k + 1 < static_cast<std::ptrdiff_t>(keys.size()); ++k) {
        const TourKey a = key(k - 1), b = key(k), c = key(k + 1), d = key(k + 2);
        const float seconds = glm::length(c.eye - b.eye) / std::max(b.speed, 0.1f);
        const int pieces = std::max(1, static_cast<int>(std::round(seconds)));
        for (int i = 0; i < pieces; ++i) {
            const float t = static_cast<float>(i) / static_cast<float>(pieces);
            tour.push_back({curve(a.eye, b.eye, c.eye, d.eye, t),
                            curve(a.target, b.target, c.target, d.target, t), time + t * seconds});
        }
        time += seconds;
    }
    tour.push_back({keys.back().eye, keys.back().target, time});
    return tour;
}

}  // namespace city
