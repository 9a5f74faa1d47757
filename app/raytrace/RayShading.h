#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "app/frame/GlassShading.h"
#include "app/frame/SunMap.h"
#include "app/frame/VehicleShading.h"
#include "app/frame/WetGround.h"
#include "app/raytrace/RayScene.h"

namespace app {

/// Values at a triangle's corners, blended. Inline, as are the transforms: GLM's own are calls, and there is
/// one for each corner of each hit.
template <class T>
inline T blend(const T& a, const T& b, const T& c, const glm::vec2& w) {
    return a * (1 - w.x - w.y) + b * w.x + c * w.y;
}
inline glm::vec3 transformPoint(const glm::mat4& m, const glm::vec3& p) {
    return glm::vec3(m[0]) * p.x + glm::vec3(m[1]) * p.y + glm::vec3(m[2]) * p.z + glm::vec3(m[3]);
}
inline glm::vec3 transformDirection(const glm::mat4& m, const glm::vec3& d) {
    return glm::vec3(m[0]) * d.x + glm::vec3(m[1]) * d.y + glm::vec3(m[2]) * d.z;
}

/// A triangle that a ray met, in world coordinates.
struct MetTriangle {
    const city::Vertex* corner[3];
    glm::vec3 position[3];

    /// Barycentrics (weights of the second and third corner) where a line meets the triangle's plane, also
    /// outside the triangle; false for a line along the plane.
    bool meet(const glm::vec3& origin, const glm::vec3& direction, glm::vec2& weights) const;
    glm::vec3 at(const glm::vec2& weights) const {
        return position[0] * (1 - weights.x - weights.y) + position[1] * weights.x + position[2] * weights.y;
    }
    glm::vec3 facing() const;  ///< unit normal of the plane, towards the front; 0 for a degenerate triangle
};

/// A point of a vehicle, shaded but for what it mirrors.
struct VehiclePoint {
    CoatedVertex coat;
    glm::vec3 normal{0};  ///< unit, interpolated
};

/// A point of the city's glass.
struct GlassPoint {
    glm::vec3 normal{0};  ///< unit, into the street
    glm::vec3 at{0};      ///< on the pane, city::paneOffset before the wall
    glm::vec2 weights{
        0};  ///< of the wall's point behind it: what is painted there is what is seen through it
    city::GlassSurface glass;
};

/// Twins of city.vert, city.frag, vehicle.vert and vehicle.frag.
class RayShading {
  public:
    RayShading(const city::CityModel& city, const RayMeshes& meshes) : city_(&city), meshes_(&meshes) {}

    void setLighting(const Lighting& lighting) { lighting_ = lighting; }
    const Lighting& lighting() const { return lighting_; }
    /// The rasteriser's shadows; null: rays towards the sun against `blockers`.
    void setSun(const SunMap* map, const reflection::TracedScene* blockers) {
        sunMap_ = map;
        blockers_ = blockers;
    }

    MetTriangle triangle(const PlacedMesh& placed, const reflection::TracedHit& hit) const;

    /// Radiance of a point of the city. `level` from the footprint of the pixel or ray.
    /// `skyShare`, `sunShare`: of the light that falls on it.
    glm::vec3 city(const PlacedMesh& placed, const MetTriangle& triangle, const glm::vec2& weights,
                   PatternSampler::Level level, float skyShare = 1, float sunShare = 1) const;
    /// Whether a ray that met a point of the city passes a pane that mirrors just before, told by the wall's
    /// material and texture coordinates where it passes the panes' plane: see city::panesOf.
    std::optional<GlassPoint> glass(const PlacedMesh& placed, const MetTriangle& triangle,
                                    const glm::vec2& weights, const glm::vec3& direction) const;
    /// What rain makes of a point of the city that a ray met, whose light is as `city` says times `under`;
    /// nothing where rain changes nothing (walls, roofs, what stands on the ground).
    std::optional<WetGround> wetGround(const PlacedMesh& placed, const reflection::TracedHit& hit,
                                       const MetTriangle& triangle, const glm::vec3& direction) const;
    /// What it mirrors where no mirror ray goes on.
    glm::vec3 wetSurroundings(const MetTriangle& triangle, const glm::vec2& weights,
                              const glm::vec3& direction, const WetGround& ground) const;
    /// Texture level for a ray that is `footprint` metres wide and meets the triangle at this cosine.
    PatternSampler::Level levelOf(const MetTriangle& triangle, float footprint, float cosine) const;
    /// The same as the rasteriser chooses it: from three neighbouring pixels' rays from one point.
    PatternSampler::Level levelOf(const MetTriangle& triangle, const glm::vec3& apex,
                                  const std::array<glm::vec3, 3>& through, TextureFilter filter) const;

    VehiclePoint vehicle(const PlacedMesh& placed, const MetTriangle& triangle, const glm::vec2& weights,
                         const vehicles::VehiclePose& pose) const;
    /// The unit normals of a vehicle's triangle at its corners, in world axes: to be interpolated.
    static void cornerNormals(const PlacedMesh& placed, const MetTriangle& triangle,
                              std::array<glm::vec3, 3>& normals);
    /// Reflectance at normal incidence of the triangle's surface: its corners are of one.
    static bool brushed(const CoatedVertex& coat) { return coat.f0 > 0.3f && coat.f0 < 0.5f; }

    /// Share of the sun's light at a point, `normal` as interpolated.
    float sunAt(const glm::vec3& position, const glm::vec3& normal) const;

  private:
    const city::CityModel* city_;
    const RayMeshes* meshes_;
    Lighting lighting_;
    const SunMap* sunMap_ = nullptr;
    const reflection::TracedScene* blockers_ = nullptr;
};

}  // namespace app
