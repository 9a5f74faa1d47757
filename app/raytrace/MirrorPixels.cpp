#include "app/raytrace/MirrorPixels.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/raytrace/Strata.h"

namespace app {

namespace {

/// vehicle.frag looks up brushed rims in level 2 of the local map: of the finest maps (128 texels a face)
/// those texels are 4 / 64 of a direction's unit wide, and bilinear filtering spreads each over two.
constexpr float brushedWidth = 4.0f / 64;

/// Farther than this outside the triangle, its plane says nothing of the pixel.
constexpr float farOutside = 4;

struct Mirror {
    glm::vec3 position, direction;
};

/// Any two directions that make a frame with a third.
void frameOf(const glm::vec3& n, glm::vec3& u, glm::vec3& v) {
    u = glm::normalize(std::abs(n.z) < 0.9f ? glm::cross(n, glm::vec3(0, 0, 1))
                                            : glm::cross(n, glm::vec3(1, 0, 0)));
    v = glm::cross(n, u);
}

}  // namespace

void MirrorPixels::addPixel(const RayPaths::Scene& scene, const ViewRays& view, const MirrorPixel& pixel,
                            const TraceOptions& options, std::uint32_t sum) {
    const RayShading& shading = *scene.shading;
    const glm::vec2 middle = glm::vec2(pixel.pixel) + 0.5f;
    const glm::vec3 facing = pixel.triangle.facing();
    std::array<glm::vec3, 3> normals;
    RayShading::cornerNormals(*pixel.placed, pixel.triangle, normals);
    const auto mirrorAt = [&](const glm::vec2& offset, Mirror& mirror) {
        const glm::vec3 through = view.through(middle + offset);
        glm::vec2 weights = pixel.weights;
        if (offset != glm::vec2(0)) {
            glm::vec2 there;
            if (pixel.triangle.meet(view.eye, through, there) &&
                glm::all(glm::lessThan(glm::abs(there), glm::vec2(farOutside))))
                weights = there;
        }
        const glm::vec3 normal = glm::normalize(blend(normals[0], normals[1], normals[2], weights));
        mirror = {pixel.triangle.at(weights), mirrorDirection(normal, -glm::normalize(through))};
    };
    Mirror centre, right, below;
    mirrorAt({0, 0}, centre);
    mirrorAt({1, 0}, right);
    mirrorAt({0, 1}, below);
    const int samples = std::max(options.samples, 1);
    const float share = 1 / std::sqrt(static_cast<float>(samples));
    const float spread = std::max(glm::length(right.direction - centre.direction),
                                  glm::length(below.direction - centre.direction));
    const float width = std::min(glm::length(right.position - centre.position),
                                 glm::length(below.position - centre.position));
    const glm::vec3 weight(1 / static_cast<float>(samples));
    if (samples == 1) {
        paths_.rays.push_back({mirrorStart(centre.position, facing, centre.direction), centre.direction,
                               width, spread, weight, sum});
        return;
    }
    const float f0 =
        coatedVertex(shading.lighting(), static_cast<vehicles::Surface>(pixel.triangle.corner[0]->material),
                     scene.frame->vehicles[pixel.placed->vehicle], facing, 0)
            .f0;
    const bool brushed = RayShading::brushed({glm::vec3(0), f0, 0, 0});
    const std::uint64_t key = strataKey(options.seed, static_cast<std::uint32_t>(pixel.pixel.x),
                                        static_cast<std::uint32_t>(pixel.pixel.y));
    for (int s = 0; s < samples; ++s) {
        Mirror mirror;
        mirrorAt(stratum(key, 0, s, samples) - 0.5f, mirror);
        glm::vec3 direction = mirror.direction;
        if (brushed) {
            glm::vec3 u, v;
            frameOf(direction, u, v);
            // The weights of bilinear filtering: a tent over two texels.
            const glm::vec2 r = stratum(key, 1, s, samples) * 2.0f - 1.0f;
            const auto tent = [](float x) { return x < 0 ? -1 + std::sqrt(1 + x) : 1 - std::sqrt(1 - x); };
            direction = glm::normalize(direction + brushedWidth * (tent(r.x) * u + tent(r.y) * v));
        }
        paths_.rays.push_back({mirrorStart(mirror.position, facing, direction), direction, width * share,
                               std::max(spread, brushed ? brushedWidth : 0.0f) * share, weight, sum});
    }
}

std::uint64_t MirrorPixels::gather(const RayPaths::Scene& scene, const ViewRays& view,
                                   std::span<const MirrorPixel> pixels, const TraceOptions& options,
                                   std::span<glm::vec3> light) {
    std::fill(light.begin(), light.end(), glm::vec3(0));
    std::uint64_t rays = 0;
    // As many pixels at a time as keep the batch within the caches.
    constexpr std::size_t batch = 4096;
    for (std::size_t first = 0; first < pixels.size();) {
        paths_.rays.clear();
        for (; first < pixels.size() && paths_.rays.size() < batch; ++first)
            addPixel(scene, view, pixels[first], options, static_cast<std::uint32_t>(first));
        rays += paths_.follow(scene, std::max(options.bounces, 1) - 1, light);
    }
    return rays;
}

}  // namespace app
