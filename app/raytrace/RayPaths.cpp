#include "app/raytrace/RayPaths.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "app/frame/Sky.h"
#include "app/raytrace/Strata.h"
#include "reflection/planar/Gloss.h"

namespace app {

namespace {

/// Metres off the surface from which mirror rays start: above the rounding of positions (0.06 mm at 1 km),
/// below what a panel's shape could show.
constexpr float offSurface = 0.001f;

/// Rays for what a rough mirror spreads. In mirrors in a row the fewer the less it matters: all of them from
/// a sixth of the light on.
int raysFor(const RayPaths::Scene& scene, float matters, bool seenDirectly) {
    const int most = std::max(scene.film, 1);
    if (seenDirectly) return most;
    return std::clamp(static_cast<int>(std::ceil(6 * matters * static_cast<float>(most))), 1, most);
}

/// A slope of a normal distribution, half as wide as the mirrored directions' (Box and Muller), from two
/// numbers in [0, 1).
glm::vec2 slopeOf(const glm::vec2& r, float angle) {
    const float away = 0.5f * angle * std::sqrt(-2 * std::log(std::max(1 - r.x, 1e-6f)));
    const float turn = 2 * std::numbers::pi_v<float> * r.y;
    return away * glm::vec2(std::cos(turn), std::sin(turn));
}

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

void RayPaths::shade(const Scene& scene, const PathRay& from, const reflection::TracedHit& hit,
                     bool mirrorAgain, std::span<glm::vec3> sums) {
    const RayShading& shading = *scene.shading;
    PathRay ray = from;
    if (ray.fading > 0) {
        if (!hit.found()) return;  // infinitely far
        ray.weight *= std::exp(-ray.fading * hit.t);
    }
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
                             shading.city(placed, triangle, pane->weights, level, behindSky(pane->glass),
                                          behindSun(pane->glass));
            if (!mirrorAgain) {
                sums[ray.sum] +=
                    ray.weight * shares.mirrored * meanSurroundings(shading.lighting(), reflected);
                return;
            }
            if (pane->glass.roughness > 0) {
                PathRay met = ray;
                met.weight *= shares.mirrored;
                addRoughRays(scene, *pane, met, footprint, false, next_);
                return;
            }
            next_.push_back({pane->at, reflected, footprint, ray.spread, ray.weight * shares.mirrored,
                             ray.sum, ray.pixel});
            next_.back().pixel.reflect(pane->at, pane->normal);
            next_.back().fading = ray.fading + scene.fading;
            return;
        }
        glm::vec3 light = shading.city(placed, triangle, weights, level);
        const glm::vec3 share =
            scene.shadows != nullptr ? scene.shadows->share(ray.origin, ray.direction, hit.t) : glm::vec3(1);
        if (const auto ground =
                scene.wet ? shading.wetGround(placed, hit, triangle, ray.direction) : std::nullopt) {
            light *= ground->under * (1 - ground->mirrored);
            if (ground->mirrored > 0 && mirrorAgain) {
                PathRay met = ray;
                met.weight *= share;
                addWetRays(scene, *ground, triangle.at(weights), met, footprint, hit.t, false, next_);
            } else {
                light +=
                    shading.wetSurroundings(triangle, weights, ray.direction, *ground) * ground->mirrored;
            }
        }
        sums[ray.sum] += ray.weight * share * light;
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

void RayPaths::addWetRays(const Scene& scene, const WetGround& ground, const glm::vec3& at,
                          const PathRay& ray, float footprint, float distance, bool seenDirectly,
                          std::vector<PathRay>& to) {
    const glm::vec3 up(0, 0, 1);
    const auto add = [&](const glm::vec2& slope, const glm::vec3& weight, float spread) -> PathRay& {
        const glm::vec3 normal = glm::normalize(glm::vec3(slope, 1));
        glm::vec3 direction = mirrorDirection(normal, -ray.direction);
        direction.z = std::abs(direction.z);  // what is thrown downwards comes up from the next grain
        return to.emplace_back(PathRay{mirrorStart(at, up, direction),
                                       direction,
                                       footprint,
                                       spread,
                                       ray.weight * weight,
                                       ray.sum,
                                       {},
                                       ray.fading + scene.fading});
    };
    if (ground.puddle > 0) {
        PathRay& smooth =
            add(rippleAt(glm::vec2(at), distance), glm::vec3(ground.mirrored * ground.puddle), ray.spread);
        smooth.pixel = ray.pixel;
        smooth.pixel.reflect(at, up);
    }
    const float film = ground.mirrored * (1 - ground.puddle) * wet::filmShare;
    if (!(film > 0)) return;
    const float matters = film * std::max({ray.weight.x, ray.weight.y, ray.weight.z});
    const int count = raysFor(scene, matters, seenDirectly);
    const std::uint64_t key =
        strataKey(scene.seed, std::bit_cast<std::uint32_t>(at.x), std::bit_cast<std::uint32_t>(at.y));
    const float share = 1 / static_cast<float>(count);
    for (int s = 0; s < count; ++s) {
        add(slopeOf(stratum(key, 0, s, count), filmAngle()), glm::vec3(film * share),
            std::max(ray.spread, filmAngle() * std::sqrt(share)));
    }
}

void RayPaths::addRoughRays(const Scene& scene, const GlassPoint& point, const PathRay& ray, float footprint,
                            bool seenDirectly, std::vector<PathRay>& to) {
    const glm::vec3& n = point.normal;
    const glm::vec3 u = glm::normalize(std::abs(n.z) < 0.9f ? glm::cross(n, glm::vec3(0, 0, 1))
                                                            : glm::cross(n, glm::vec3(1, 0, 0)));
    const glm::vec3 v = glm::cross(n, u);
    const auto angle = static_cast<float>(reflection::glossAngle(point.glass.roughness));
    const float matters = std::max({ray.weight.x, ray.weight.y, ray.weight.z});
    const int count = raysFor(scene, matters, seenDirectly);
    const std::uint64_t key = strataKey(scene.seed, std::bit_cast<std::uint32_t>(point.at.x + point.at.y),
                                        std::bit_cast<std::uint32_t>(point.at.z));
    const float share = 1 / static_cast<float>(count);
    for (int s = 0; s < count; ++s) {
        const glm::vec2 slope = slopeOf(stratum(key, 0, s, count), angle);
        glm::vec3 direction = mirrorDirection(glm::normalize(n + slope.x * u + slope.y * v), -ray.direction);
        // What is thrown at the wall comes back from the next facet.
        if (const float out = glm::dot(direction, n); out < 0) direction -= 2 * out * n;
        to.push_back({mirrorStart(point.at, n, direction),
                      direction,
                      footprint,
                      std::max(ray.spread, angle * std::sqrt(share)),
                      ray.weight * share,
                      ray.sum,
                      {},
                      ray.fading + scene.fading});
    }
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
