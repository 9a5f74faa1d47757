#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/raytrace/RayMeshes.h"
#include "reflection/truth/TracedScene.h"

namespace app {

/// What stands where in a traced scene.
struct PlacedMesh {
    enum class Kind : std::uint8_t { city, lamp, vehicle };
    Kind kind = Kind::city;
    std::uint32_t mesh = 0;     ///< of RayMeshes
    std::uint32_t vehicle = 0;  ///< index into FrameScene::vehicles
    glm::mat4 worldFromMesh{1};
    glm::vec3 radiance{0};  ///< of lamps
};

/// Which levels of detail are right for an eye: the rasteriser's rule.
struct DetailRule {
    glm::dvec3 eye{0};
    float pixelsPerRadian = 0;  ///< 0: everything as fine as it gets
    static DetailRule of(const View& view);
};

/// A frame's things placed for rays.
class RayScene {
  public:
    explicit RayScene(const RayMeshes& meshes) : meshes_(&meshes), traced_(meshes.traced()) {}

    void clear();
    /// The standing city; placements at the rule's level of detail.
    void addCity(const city::CityModel& city, const DetailRule& detail);
    /// The lit lamps of signals: those that a view with this rule shows.
    void addLamps(const city::CityModel& city, const FrameScene& frame, const DetailRule& detail);
    /// The vehicles of these indices, bodies and wheels, at the rule's level of detail.
    void addVehicles(const FrameScene& frame, std::span<const std::uint32_t> chosen,
                     const DetailRule& detail);
    void commit() { traced_.commit(); }

    const reflection::TracedScene& traced() const { return traced_; }
    const PlacedMesh& placed(std::uint32_t instance) const { return placed_[instance]; }

  private:
    void place(const PlacedMesh& thing);

    const RayMeshes* meshes_;
    reflection::TracedScene traced_;
    std::vector<PlacedMesh> placed_;
};

}  // namespace app
