#include "app/raytrace/RayShading.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

constexpr float inversePi = std::numbers::inv_pi_v<float>;

/// Metres by which rays to the sun start off the surface: a hundred roundings of a coordinate of a kilometre.
constexpr float offSurface = 0.006f;

}  // namespace

bool MetTriangle::meet(const glm::vec3& origin, const glm::vec3& direction, glm::vec2& weights) const {
    const glm::vec3 e1 = position[1] - position[0], e2 = position[2] - position[0];
    const glm::vec3 p = glm::cross(direction, e2);
    const float determinant = glm::dot(e1, p);
    if (determinant == 0 || !std::isfinite(1 / determinant)) return false;
    const glm::vec3 from = origin - position[0];
    weights = glm::vec2(glm::dot(from, p), glm::dot(direction, glm::cross(from, e1))) / determinant;
    return std::isfinite(weights.x) && std::isfinite(weights.y);
}

glm::vec3 MetTriangle::facing() const {
    const glm::vec3 n = glm::cross(position[1] - position[0], position[2] - position[0]);
    const float length = glm::length(n);
    return length > 0 ? n / length : glm::vec3(0);
}

MetTriangle RayShading::triangle(const PlacedMesh& placed, const reflection::TracedHit& hit) const {
    const city::Mesh& mesh = meshes_->part(placed.mesh, hit.part);
    MetTriangle met;
    for (std::size_t k = 0; k < 3; ++k) {
        met.corner[k] = &mesh.vertices[mesh.indices[3 * std::size_t{hit.triangle} + k]];
        met.position[k] = transformPoint(placed.worldFromMesh, met.corner[k]->position);
    }
    return met;
}

float RayShading::sunAt(const glm::vec3& position, const glm::vec3& normal) const {
    if (sunMap_ != nullptr)
        return sunMap_->lightAt(
            transformPoint(sunMap_->shadowFromWorld, position + normal * sunMap_->normalOffset));
    if (blockers_ == nullptr) return 1;
    // Towards the side from which the sun shines: leaves are lit from both.
    const float side = glm::dot(normal, lighting_.sunDirection) >= 0 ? offSurface : -offSurface;
    const reflection::TracedRay ray{position + normal * side, lighting_.sunDirection, 0};
    std::uint8_t blocked = 0;
    blockers_->blocked({&ray, 1}, {&blocked, 1});
    return blocked != 0 ? 0.0f : 1.0f;
}

PatternSampler::Level RayShading::levelOf(const MetTriangle& triangle, float footprint, float cosine) const {
    const float area = glm::length(
        glm::cross(triangle.position[1] - triangle.position[0], triangle.position[2] - triangle.position[0]));
    const glm::vec2 s = triangle.corner[1]->texcoord - triangle.corner[0]->texcoord;
    const glm::vec2 t = triangle.corner[2]->texcoord - triangle.corner[0]->texcoord;
    if (!(area > 0)) return {};
    const float density = std::sqrt(std::abs(s.x * t.y - s.y * t.x) / area);
    // Between the footprint's short side and its long one.
    return meshes_->patterns().levelOf(footprint * density / std::sqrt(std::max(std::abs(cosine), 0.01f)),
                                       TextureFilter::standard);
}

PatternSampler::Level RayShading::levelOf(const MetTriangle& triangle, const glm::vec3& apex,
                                          const std::array<glm::vec3, 3>& through,
                                          TextureFilter filter) const {
    glm::vec2 texcoord[3];
    for (std::size_t k = 0; k < 3; ++k) {
        glm::vec2 w;
        if (!triangle.meet(apex, through[k], w)) return {};
        texcoord[k] = blend(triangle.corner[0]->texcoord, triangle.corner[1]->texcoord,
                            triangle.corner[2]->texcoord, w);
    }
    const glm::vec2 dx = texcoord[1] - texcoord[0], dy = texcoord[2] - texcoord[0];
    const float repeats = filter == TextureFilter::standard
                              ? std::max(glm::length(dx), glm::length(dy))
                              : std::max({std::abs(dx.x), std::abs(dx.y), std::abs(dy.x), std::abs(dy.y)});
    return meshes_->patterns().levelOf(repeats, filter);
}

glm::vec3 RayShading::city(const PlacedMesh& placed, const MetTriangle& triangle, const glm::vec2& weights,
                           PatternSampler::Level level, float skyShare, float sunShare) const {
    glm::vec3 normal[3], shaded[3], sunlit[3];
    bool sunny = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const city::Vertex& v = *triangle.corner[k];
        normal[k] = placed.mesh == meshes_->chunks() || placed.mesh == meshes_->whole()
                        ? v.normal
                        : glm::normalize(transformDirection(placed.worldFromMesh, v.normal));
        glm::vec3 tint(0.8f), emission(0);
        if (v.material < city_->materials.size()) {
            tint = city_->materials[v.material].tint;
            emission = city_->materials[v.material].emission;
        }
        const glm::vec3 albedo = tint * inversePi;
        const float cosine = std::max(glm::dot(normal[k], lighting_.sunDirection), 0.0f);
        shaded[k] = albedo *
                    glm::mix(lighting_.groundIrradiance, lighting_.skyIrradiance, 0.5f + 0.5f * normal[k].z) *
                    skyShare;
        if (lighting_.lampsLit) shaded[k] += emission;
        sunlit[k] = albedo * lighting_.sunIrradiance * (cosine * sunShare);
        sunny = sunny || cosine > 0;
    }
    const std::uint32_t material = triangle.corner[2]->material;  // flat: of the provoking corner
    const std::uint32_t pattern = material < city_->materials.size()
                                      ? static_cast<std::uint32_t>(city_->materials[material].pattern)
                                      : 0;
    const glm::vec2 texcoord = blend(triangle.corner[0]->texcoord, triangle.corner[1]->texcoord,
                                     triangle.corner[2]->texcoord, weights);
    const glm::vec3 root(meshes_->patterns().at(pattern, texcoord, level));
    glm::vec3 light = blend(shaded[0], shaded[1], shaded[2], weights);
    if (sunny)
        light += blend(sunlit[0], sunlit[1], sunlit[2], weights) *
                 sunAt(triangle.at(weights), blend(normal[0], normal[1], normal[2], weights));
    return root * root * light;
}

std::optional<GlassPoint> RayShading::glass(const PlacedMesh& placed, const MetTriangle& triangle,
                                            const glm::vec2& weights, const glm::vec3& direction) const {
    if (placed.kind != PlacedMesh::Kind::city) return std::nullopt;
    const std::uint32_t material = triangle.corner[2]->material;
    if (material >= city_->materials.size()) return std::nullopt;
    const city::Pattern pattern = city_->materials[material].pattern;
    const auto panes = city::panesOf(pattern);
    if (panes.empty()) return std::nullopt;
    GlassPoint point;
    point.normal = triangle.facing();
    const float cosine = -glm::dot(point.normal, direction);
    if (!(cosine > 0)) return std::nullopt;  // panes are seen from the street
    point.at = triangle.at(weights) - direction * (city::paneOffset / cosine);
    if (!triangle.meet(point.at, point.normal, point.weights)) return std::nullopt;
    const glm::vec2 texcoord = blend(triangle.corner[0]->texcoord, triangle.corner[1]->texcoord,
                                     triangle.corner[2]->texcoord, point.weights);
    const glm::vec2 at = texcoord - glm::floor(texcoord);
    for (const city::PaneOfPattern& pane : panes)
        if (at.x >= pane.low.x && at.x <= pane.high.x && at.y >= pane.low.y && at.y <= pane.high.y) {
            point.glass = pane.surface;
            return point;
        }
    return std::nullopt;
}

std::optional<WetGround> RayShading::wetGround(const PlacedMesh& placed, const reflection::TracedHit& hit,
                                               const MetTriangle& triangle,
                                               const glm::vec3& direction) const {
    if (placed.kind != PlacedMesh::Kind::city || !meshes_->isGround(placed.mesh, hit.part, hit.triangle))
        return std::nullopt;
    const std::uint32_t material = triangle.corner[2]->material;
    const city::Pattern pattern =
        material < city_->materials.size() ? city_->materials[material].pattern : city::Pattern::plain;
    const glm::vec2 weights(hit.u, hit.v);
    const glm::vec3 normal =
        blend(triangle.corner[0]->normal, triangle.corner[1]->normal, triangle.corner[2]->normal, weights);
    return app::wetGround(pattern, normal, glm::vec2(triangle.at(weights)), -direction.z);
}

glm::vec3 RayShading::wetSurroundings(const MetTriangle& triangle, const glm::vec2& weights,
                                      const glm::vec3& direction, const WetGround& ground) const {
    const glm::vec3 normal =
        blend(triangle.corner[0]->normal, triangle.corner[1]->normal, triangle.corner[2]->normal, weights);
    return app::wetSurroundings(lighting_, {direction.x, direction.y, -direction.z}, ground.puddle,
                                sunAt(triangle.at(weights), normal));
}

void RayShading::cornerNormals(const PlacedMesh& placed, const MetTriangle& triangle,
                               std::array<glm::vec3, 3>& normals) {
    for (std::size_t k = 0; k < 3; ++k)
        normals[k] = glm::normalize(transformDirection(placed.worldFromMesh, triangle.corner[k]->normal));
}

VehiclePoint RayShading::vehicle(const PlacedMesh& placed, const MetTriangle& triangle,
                                 const glm::vec2& weights, const vehicles::VehiclePose& pose) const {
    std::array<glm::vec3, 3> n;
    cornerNormals(placed, triangle, n);
    CoatedVertex c[3];
    for (std::size_t k = 0; k < 3; ++k) {
        c[k] = coatedVertex(lighting_, static_cast<vehicles::Surface>(triangle.corner[k]->material), pose,
                            n[k], sunAt(triangle.position[k], n[k]));
    }
    VehiclePoint point;
    point.normal = glm::normalize(blend(n[0], n[1], n[2], weights));
    point.coat.diffuse = blend(c[0].diffuse, c[1].diffuse, c[2].diffuse, weights);
    point.coat.f0 = blend(c[0].f0, c[1].f0, c[2].f0, weights);
    point.coat.coat = blend(c[0].coat, c[1].coat, c[2].coat, weights);
    point.coat.sun = blend(c[0].sun, c[1].sun, c[2].sun, weights);
    return point;
}

}  // namespace app
