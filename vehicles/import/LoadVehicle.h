#pragma once

#include <filesystem>

#include "vehicles/import/ReadGltf.h"
#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// Loads a vehicle from a binary glTF file (y up, +z forward, as glTF asks), scaled to a length in metres,
/// with levels of detail. Materials are mapped to surfaces by name and properties; paint is replaced by the
/// instance's. Throws std::runtime_error: one sentence with file, place in it, cause and remedy
/// (Draco-compressed files are named as such).
VehicleModel loadVehicle(const std::filesystem::path& file, float length);

/// What `loadVehicle` makes of the file's triangles, once read. `file`: for messages and the name.
VehicleModel vehicleFrom(const GltfScene& scene, const std::filesystem::path& file, float length);

}  // namespace vehicles
