#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "app/frame/VehicleLevels.h"
#include "app/raytrace/PatternSampler.h"
#include "city/model/CityModel.h"
#include "reflection/truth/TracedScene.h"

namespace app {

/// The meshes of a city and its vehicles as rays meet them, with the vertices as the rasteriser has them
/// (normals of ten bits), each part drawn in one way: solid, two-sided, cut out.
class RayMeshes {
  public:
    RayMeshes(const city::CityModel& city, std::span<const vehicles::VehicleModel> models);
    ~RayMeshes();

    static constexpr std::uint32_t none = 0xffffffffu;

    struct Prototype {
        struct Level {
            std::uint32_t mesh = none;
            float error = 0;  ///< metres
        };
        std::vector<Level> levels;
        glm::vec3 centre{0};  ///< bounding sphere, the prototype's frame
        float radius = 0;
    };
    struct Vehicle {
        VehicleLevels levels;
        std::vector<std::uint32_t> bodies, wheels;  ///< meshes, one for each level
    };

    std::uint32_t chunks() const { return chunks_; }  ///< the city without placements; none: it is empty
    /// The city with all placements as fine as they get, as one mesh; none where that were too large: then
    /// chunks and placements are to be placed one by one.
    std::uint32_t whole() const { return whole_; }
    /// Whether a triangle of `chunks` or `whole` is of the ground, which rain wets.
    bool isGround(std::uint32_t mesh, std::uint32_t part, std::uint32_t triangle) const {
        return part == 0 && triangle < groundTriangles_ && (mesh == chunks_ || mesh == whole_);
    }
    std::uint32_t lamp() const { return lamp_; }  ///< a disc of radius 1 that faces +x
    const std::vector<Prototype>& prototypes() const { return prototypes_; }
    const std::vector<Vehicle>& vehicles() const { return vehicles_; }

    const city::Mesh& part(std::uint32_t mesh, std::uint32_t part) const;
    const PatternSampler& patterns() const { return patterns_; }
    const reflection::TracedMeshes& traced() const { return traced_; }

  private:
    struct Parts;
    class Cutout;
    std::uint32_t add(std::unique_ptr<Parts> parts);
    void append(Parts& parts, const city::Mesh& mesh, const glm::mat4* worldFromMesh) const;

    const city::CityModel& city_;
    PatternSampler patterns_;
    reflection::TracedMeshes traced_;
    std::vector<std::unique_ptr<Parts>> parts_;
    std::uint32_t chunks_ = none, whole_ = none, lamp_ = none;
    std::uint32_t groundTriangles_ = 0;  ///< solid ones: the first of `chunks` and `whole`
    std::vector<Prototype> prototypes_;
    std::vector<Vehicle> vehicles_;
};

}  // namespace app
