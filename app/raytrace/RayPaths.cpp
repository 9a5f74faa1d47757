#include "app/raytrace/RayPaths.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "app/frame/Sky.h"

namespace app {

namespace {

/// Metres off the surface from which mirror rays start: above the rounding of positions (0.06 mm at 1 km),
/// below what a panel's shape could show.
constexpr float offSurface = 0.001f;

}  // namespace

void PixelRays::reflect(const glm::vec3& at, const glm::vec3& normal) {
    apex -= 2 * glm::dot(normal, apex - at) * normal;
    for (glm::vec3& d : through) d -= 2 * glm::dot(normal, d) * normal;
}

glm::vec3 mirrorStart(const glm::vec3& position, const glm::vec3& facing, const glm::vec3& direction) {
    // Interpolated normals may send a ray below its triangle, at outlines above all. It then starts below,
    // and leaves the body through the backs of its panels, which rays pass.
    return position + facing * (glm::dot(facing, direction) >= 0 ? offSurface : -offSurface);
}

void RayPaths::shade(const Scene& scene, const PathRay& ray, const reflection::TracedHit& hit,
                     bool mirrorAgain, std::span<glm::vec3> sums) {
    const RayShading& shading = *scene.shading;
    if (!hit.found()) {
        sums[ray.sum] += ray.weight * skyRadiance(shading.lighting(), ray.direction);
        return;
    }
    const PlacedMesh& placed = scene.scene->placed(hit.instance);
    if (placed.kind == PlacedMesh::Kind::lamp) {
        sums[ray.sum] += ray.weight * placed.radiance;
        return;
    }
    const MetTriangle triangle = shading.triangle(placed, hit);
    const glm::vec2 weights(hit.u, hit.v);
    const float footprint = ray.width + ray.spread * hit.t;
    if (placed.kind == PlacedMesh::Kind::city) {
        const float cosine = glm::dot(triangle.facing(), ray.direction);
        const PatternSampler::Level level =
            ray.pixel.known ? shading.levelOf(triangle, ray.pixel.apex, ray.pixel.through, scene.filter)
                            : shading.levelOf(triangle, footprint, cosine);
        const auto pane =
            scene.glass ? shading.glass(placed, triangle, weights, ray.direction) : std::nullopt;
        if (pane) {
            const GlassShares shares = glassShares(pane->glass, -cosine);
            const glm::vec3 reflected = mirrorDirection(pane->normal, -ray.direction);
            sums[ray.sum] += ray.weight * shares.through *
                             shading.city(placed, triangle, pane->weights, level, roomSky, roomSun);
            if (!mirrorAgain) {
                sums[ray.sum] +=
                    ray.weight * shares.mirrored * meanSurroundings(shading.lighting(), reflected);
                return;
            }
            next_.push_back({pane->at, reflected, footprint, ray.spread, ray.weight * shares.mirrored,
                             ray.sum, ray.pixel});
            next_.back().pixel.reflect(pane->at, pane->normal);
            return;
        }
        glm::vec3 light = shading.city(placed, triangle, weights, level);
        if (scene.shadows != nullptr) light *= scene.shadows->share(ray.origin, ray.direction, hit.t);
        sums[ray.sum] += ray.weight * light;
        return;
    }
    const VehiclePoint point =
        shading.vehicle(placed, triangle, weights, scene.frame->vehicles[placed.vehicle]);
    const glm::vec3 towardsEye = -ray.direction;
    const float fresnel = coatFresnel(point.coat, glm::dot(point.normal, towardsEye));
    const glm::vec3 reflected = mirrorDirection(point.normal, towardsEye);
    sums[ray.sum] += ray.weight * point.coat.diffuse * (1 - fresnel);
    if (!mirrorAgain) {
        sums[ray.sum] += ray.weight * plainSurroundings(shading.lighting(), point.coat, reflected) * fresnel;
        return;
    }
    next_.push_back({mirrorStart(triangle.at(weights), triangle.facing(), reflected),
                     reflected,
                     footprint,
                     ray.spread,
                     ray.weight * fresnel,
                     ray.sum,
                     {}});
}

std::uint64_t RayPaths::follow(const Scene& scene, int mirrors, std::span<glm::vec3> sums,
                               std::span<float> distances) {
    std::uint64_t count = 0;
    for (int mirror = 0; !rays.empty(); ++mirror) {
        traced_.clear();
        for (const PathRay& r : rays)
            traced_.push_back(
                {r.origin, r.direction, 0, std::numeric_limits<float>::infinity(), r.width, r.spread});
        hits_.resize(traced_.size());
        scene.scene->traced().trace(traced_, hits_, reflection::TracedScene::Backs::pass);
        count += rays.size();
        next_.clear();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (mirror == 0 && !distances.empty()) distances[i] = hits_[i].t;
            shade(scene, rays[i], hits_[i], mirror < mirrors, sums);
        }
        std::swap(rays, next_);
    }
    return count;
}

}  // namespace app
