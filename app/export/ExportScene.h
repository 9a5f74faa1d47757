#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "app/frame/CameraRig.h"
#include "city/model/CityModel.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/VehiclePose.h"

namespace app {

/// Writes the static city as binary glTF at its finest level: a mesh for each chunk, one for each prototype,
/// a node for each placement, one for each standing reflector; patterns embedded as PNG. Axes: x east, y up, -z north. Throws
/// std::runtime_error naming the file and the cause.
void exportCity(const city::CityModel& city, const std::filesystem::path& file);

/// Writes a vehicle as binary glTF: front towards +z, y up, origin on the road, wheels as nodes of their own.
/// The material "paint" is what an instance's colour replaces.
void exportVehicle(const vehicles::VehicleModel& model, const std::filesystem::path& file);

/// Camera and vehicles of one frame of a drive.
struct DriveFrame {
    CameraPose camera;
    std::vector<vehicles::VehiclePose> vehicles;
};

/// Writes {"camera":[{"eye","target"}], "cars":[[{"p","yaw"}]], "paint":[[r,g,b]], "fov_y_deg", "size",
/// "fps"}: one entry of camera and cars a frame, in glTF's axes. A vehicle file as written above, turned
/// about +y by `yaw` and put at `p`, stands as it does here. Vehicles keep their order from frame to frame;
/// `paint` is theirs, linear.
void exportDrive(std::span<const DriveFrame> frames, double fovYDegrees, glm::ivec2 size, std::uint32_t fps,
                 const std::filesystem::path& file);

}  // namespace app
