#include "app/frame/StandingReflectors.h"

namespace app {

namespace {

/// Levels of detail: the finest has 5,120 triangles of a sphere, 96 sides of a pillar.
constexpr int finest = 4;
/// A mirror's outline and the bend of what it shows are looked at: its levels count as so much more wrong
/// than their surface is.
constexpr float mirrorShows = 3;

vehicles::Surface surfaceOf(city::StandingReflector::Stuff stuff) {
    return stuff == city::StandingReflector::Stuff::granite ? vehicles::Surface::polishedStone
                                                            : vehicles::Surface::chrome;
}

}  // namespace

std::vector<vehicles::VehicleModel> standingModels(const city::CityModel& city) {
    std::vector<vehicles::VehicleModel> models;
    for (const city::StandingReflector& reflector : city.reflectors) {
        vehicles::VehicleModel& model = models.emplace_back();
        model.name = reflector.name;
        model.length = model.width = 2 * reflector.radius;
        model.height = reflector.height;
        model.reflectionCentre = 0.5f;
        model.wheelRadius = 0;
        for (int detail = finest; detail >= 1; --detail) {
            vehicles::VehicleModel::Level& level = model.levels.emplace_back();
            level.body = city::reflectorMesh(reflector, detail);
            for (city::Vertex& v : level.body.vertices)
                v.material = static_cast<std::uint32_t>(surfaceOf(reflector.stuff));
            level.wheelsInBody = true;
            level.error = detail == finest ? 0 : mirrorShows * city::reflectorMeshError(reflector, detail);
        }
    }
    return models;
}

std::vector<vehicles::VehiclePose> standingPoses(const city::CityModel& city, std::uint32_t firstModel) {
    std::vector<vehicles::VehiclePose> poses;
    for (std::uint32_t i = 0; i < city.reflectors.size(); ++i) {
        vehicles::VehiclePose& pose = poses.emplace_back();
        pose.id = firstStandingId + i;
        pose.model = firstModel + i;
        pose.position = glm::dvec3(city.reflectors[i].foot);
    }
    return poses;
}

}  // namespace app
