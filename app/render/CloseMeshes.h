#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "app/frame/ChromeParts.h"
#include "app/frame/CloseCity.h"
#include "app/frame/VehicleLevels.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// A mesh near chrome, ready to become virtual meshes: what is searched for, and what is drawn with it.
struct CloseMesh {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    std::vector<int> attributes;  ///< floats of each attribute of `values`, as shaders with VIRTUAL take them
    std::vector<float> values;    ///< of all vertices
    city::Aabb box;               ///< of the positions
    bool cutout = false;          ///< with holes where its pattern is transparent
    /// Its vertices stand too far apart for a grid to be between them: each is searched for.
    bool exact = false;
};

/// A patch of the city, in its own frame: around its place, axes of the world.
std::vector<CloseMesh> closeMeshes(const CloseCityPatch& patch);

/// Vehicles near chrome, in the levels of VehicleLevels; each is made when it is first asked for.
class CloseVehicles {
  public:
    explicit CloseVehicles(std::span<const vehicles::VehicleModel> models) : models_(models) {}

    struct Placed {
        const CloseMesh* mesh = nullptr;
        glm::dmat4 worldFromMesh{1};
    };
    /// Body and wheels at the coarsest levels that are off by no more than `allowed` metres. The span is good
    /// until the next call, the meshes as long as this.
    std::span<const Placed> of(const vehicles::VehiclePose& pose, float allowed);
    /// A body as one of its own parts of chrome (not on a wheel) sees it: what is near the part, without the
    /// part itself and what lies within it, at the coarsest level that is off by no more than `allowed`
    /// metres. In the vehicle's frame; null where that is nothing. `number`: the part's, in its model.
    const CloseMesh* besides(std::size_t model, const ChromePart& part, std::uint32_t number,
                             const reflection::Reflector& reflector, float allowed);
    /// What a vehicle fills, wide enough for its wheels, in its own frame.
    city::Aabb boxOf(const vehicles::VehiclePose& pose);

  private:
    const CloseMesh& meshOf(const VehicleLevels::Level& level);
    const VehicleLevels& levelsOf(std::size_t model);

    std::span<const vehicles::VehicleModel> models_;
    std::map<std::size_t, VehicleLevels> levels_;
    std::map<const VehicleLevels::Level*, std::unique_ptr<CloseMesh>> meshes_;
    std::map<std::tuple<const VehicleLevels::Level*, std::uint32_t>, std::unique_ptr<CloseMesh>> besides_;
    std::vector<Placed> placed_;
};

}  // namespace app
