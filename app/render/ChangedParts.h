#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "city/geometry/Aabb.h"
#include "city/model/CityModel.h"
#include "vehicles/traffic/Traffic.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// The pixels x0 y0 .. x1 y1 (these not included) that a box (world) may touch in a picture of this size, and
/// some more; nothing where it lies outside or behind the eye. Precondition: the matrix is a perspective
/// view's.
std::optional<glm::ivec4> pixelsOf(const city::Aabb& box, const glm::dvec3& eye,
                                   const glm::mat4& clipFromRelative, glm::ivec2 size);

/// Of a view that stands, what changes by itself.
struct MovingParts {
    std::vector<vehicles::VehiclePose> poses;
    std::vector<vehicles::SignalColour> colours;
};

/// Calls back with a name, which stays with the thing, and with the box (world) of each thing that looks
/// otherwise than before: vehicles that move, come and go, with their shadows, where they were and where they
/// are, and signals. `boundsOf`: a vehicle's box. `towardsSun`: of length 1. Cost: sorts the vehicles.
void findChanges(
    const MovingParts& before, std::span<const vehicles::VehiclePose> poses,
    std::span<const vehicles::SignalColour> colours, std::span<const city::SignalHead> heads,
    const glm::vec3& towardsSun, const std::function<city::Aabb(const vehicles::VehiclePose&)>& boundsOf,
    const std::function<bool(const vehicles::VehiclePose&, const vehicles::VehiclePose&)>& noticed,
    const std::function<void(std::uint64_t, const city::Aabb&)>& changed);

}  // namespace app
