#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "city/model/CityModel.h"

namespace app {

/// What stands close to a place, cut off at the box of a ball around it.
struct CloseCityPatch {
    /// Around `place`, axes of the world, of meshes with at most `CloseCity::mostTriangles` each. Every
    /// placed thing has its own, so that those that are not seen can be left out.
    std::vector<city::Mesh> solid, cutout;  ///< opaque; with holes where their pattern is transparent
    glm::dvec3 place{0};
    double reach = 0;  ///< half the box's side, metres
    std::size_t triangles() const;
};

/// Finds the standing city's triangles near a place: ground, kerbs, walls, and the things placed on them.
class CloseCity {
  public:
    static constexpr std::size_t mostTriangles = 1024;

    /// Keeps a reference. Cost: the bounds of chunks and placements.
    explicit CloseCity(const city::CityModel& city);

    /// Metres by which a placed thing's level may be off, by its box around the place, axes of the world.
    using Allowed = std::function<double(const city::Aabb&)>;
    /// Everything within a ball of radius `reach` (metres, > 0), and little more: polygons that may reach
    /// into it, cut off at its box. Placed things at the coarsest level that is allowed. Cost: linear in the
    /// triangles of the chunks that the box touches.
    CloseCityPatch gather(const glm::dvec3& place, double reach, const Allowed& allowed) const;

  private:
    const city::CityModel& city_;
    std::vector<city::Aabb> placements_;  ///< world bounds
};

}  // namespace app
