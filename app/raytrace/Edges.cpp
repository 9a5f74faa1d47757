#include "app/raytrace/Edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/raytrace/ViewRays.h"

namespace app {

namespace {

constexpr float sameNormal = 0.9848f;  // cosine of 10 degrees
constexpr float samePlane = 0.01f;     // of the distance

}  // namespace

std::vector<unsigned char> edgesOf(const TracedPicture& picture, const View& view, int radius) {
    const int width = picture.size.x, height = picture.size.y;
    const ViewRays rays(view);
    const auto index = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    const auto towards = [&](int x, int y) { return glm::normalize(rays.through(glm::vec2(x, y) + 0.5f)); };
    // Whether b, seen along directionB, lies in the plane of a.
    const auto inPlane = [&](std::size_t a, const glm::vec3& directionA, std::size_t b,
                             const glm::vec3& directionB) {
        const float along = glm::dot(picture.normal[a], directionB);
        const float expected = picture.distance[a] * glm::dot(picture.normal[a], directionA);
        // Both scaled by the cosine, which may be near 0.
        return std::abs(expected - picture.distance[b] * along) <= samePlane * picture.distance[b];
    };
    const auto broken = [&](int ax, int ay, int bx, int by) {
        const std::size_t a = index(ax, ay), b = index(bx, by);
        if (picture.kind[a] != picture.kind[b] || picture.vehicle[a] != picture.vehicle[b] ||
            picture.surface[a] != picture.surface[b])
            return true;
        if (picture.kind[a] == SeenKind::sky) return false;
        if (glm::dot(picture.normal[a], picture.normal[b]) < sameNormal) return true;
        const glm::vec3 da = towards(ax, ay), db = towards(bx, by);
        return !inPlane(a, da, b, db) || !inPlane(b, db, a, da);
    };
    std::vector<unsigned char> breaks(picture.radiance.size()), edges(picture.radiance.size());
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x)
            breaks[index(x, y)] =
                (x + 1 < width && broken(x, y, x + 1, y)) || (x > 0 && broken(x, y, x - 1, y)) ||
                        (y + 1 < height && broken(x, y, x, y + 1)) || (y > 0 && broken(x, y, x, y - 1))
                    ? 1
                    : 0;
    });
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x)
            for (int ny = std::max(y - radius, 0); ny <= std::min(y + radius, height - 1); ++ny)
                for (int nx = std::max(x - radius, 0); nx <= std::min(x + radius, width - 1); ++nx)
                    if (breaks[index(nx, ny)] != 0) edges[index(x, y)] = 1;
    });
    return edges;
}

}  // namespace app
