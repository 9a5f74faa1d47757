#include "app/commands/LoadScene.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "app/commands/LoadStaging.h"
#include "app/frame/StandingReflectors.h"
#include "app/report/Timing.h"
#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "city/import/LoadCity.h"
#include "vehicles/import/LoadVehicle.h"
#include "vehicles/models/Fleet.h"

namespace app {

namespace {

constexpr double tramSpacing = 400;  // metres of tram lane a tram

city::CityModel makeCity(const Options& options) {
    if (options.city == "paper") {
        if (options.size) spdlog::warn("the city 'paper' has a size of its own: --size is ignored");
        return city::generatePaperCity(options.seed);
    }
    if (options.city == "boulevard") {
        city::BoulevardOptions boulevard;
        boulevard.seed = options.seed;
        if (options.size) boulevard.size = *options.size;
        return city::generateBoulevard(boulevard);
    }
    city::ImportOptions import;
    import.seed = options.seed;
    import.size = options.size;
    return city::loadCity(options.city, import);
}

}  // namespace

double laneLength(const city::Lane& lane) {
    double length = 0;
    for (std::size_t i = 1; i < lane.centreLine.size(); ++i)
        length += glm::distance(lane.centreLine[i - 1], lane.centreLine[i]);
    return length;
}

city::CityModel loadCityOf(const Options& options, bool tellNotes) {
    const Stopwatch watch;
    city::CityModel city = makeCity(options);
    const std::string name = std::filesystem::path(options.city).filename().string();
    if (tellNotes)
        for (const std::string& note : city.notes) spdlog::info("{}: {}", name, note);
    spdlog::info("{}: {} triangles, {} lanes, ready after {:.1f} s", name, city.triangleCount(),
                 city.roads.lanes.size(), watch.elapsed() / 1000);
    return city;
}

Scene loadScene(const Options& options) {
    Scene scene;
    scene.city = loadCityOf(options);
    scene.glass = city::glassFronts(scene.city);
    scene.models = vehicles::builtInFleet();
    scene.kinds = vehicles::kindsOf(scene.models);
    if (options.car) {
        std::vector<vehicles::VehicleModel> models{
            vehicles::loadVehicle(*options.car, static_cast<float>(options.carLength))};
        for (std::size_t i = 0; i < scene.models.size(); ++i)
            if (scene.kinds[i].tram) models.push_back(std::move(scene.models[i]));
        scene.models = std::move(models);
        scene.kinds = vehicles::kindsOf(scene.models);
    }
    if (options.staged) loadStaging(*options.staged, scene);
    for (vehicles::VehicleModel& model : standingModels(scene.city)) scene.models.push_back(std::move(model));
    const double latitude = scene.city.frame ? scene.city.frame->latitude() : 50;
    scene.lighting = lightingAt(options.hour, latitude);
    return scene;
}

vehicles::Traffic startTraffic(const Scene& scene, std::uint64_t seed, std::uint32_t cars) {
    double tramMetres = 0;
    for (const city::Lane& lane : scene.city.roads.lanes)
        if (lane.kind == city::LaneKind::tram) tramMetres += laneLength(lane);
    const bool haveTram =
        std::any_of(scene.kinds.begin(), scene.kinds.end(), [](const auto& kind) { return kind.tram; });
    vehicles::TrafficOptions options;
    options.seed = seed;
    options.cars = cars;
    options.trams =
        haveTram && cars > 0 ? static_cast<std::uint32_t>(std::ceil(tramMetres / tramSpacing)) : 0;
    vehicles::Traffic traffic(scene.city.roads, scene.kinds, options);
    if (traffic.size() < cars) spdlog::warn("only {} of {} cars fit on the lanes", traffic.size(), cars);
    while (traffic.time() < settlingTime) traffic.step();
    return traffic;
}

}  // namespace app
