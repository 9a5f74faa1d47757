#include "app/commands/LoadStaging.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <glm/trigonometric.hpp>
#include <map>
#include <sstream>
#include <stdexcept>

#include "app/frame/WetRoad.h"
#include "app/report/JsonPlace.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Fleet.h"

namespace app {

namespace {

constexpr float viewSeconds = 4, changeSeconds = 2, stillAfter = 0.01f;

const std::map<std::string, std::function<vehicles::VehicleModel()>>& builtIn() {
    static const std::map<std::string, std::function<vehicles::VehicleModel()>> models{
        {"hatchback", vehicles::hatchback},
        {"saloon", vehicles::saloon},
        {"van", vehicles::van},
        {"bus", vehicles::bus},
        {"tram", vehicles::tram},
        {"cyclist", vehicles::cyclist}};
    return models;
}

std::uint32_t modelOf(const JsonPlace& p, Scene& scene) {
    const std::string name = p.text();
    const auto has = [&](const vehicles::VehicleModel& m) { return m.name == name; };
    auto found = std::find_if(scene.models.begin(), scene.models.end(), has);
    if (found == scene.models.end()) {
        const auto built = builtIn().find(name);
        if (built == builtIn().end()) {
            std::string names;
            for (const auto& [known, make] : builtIn()) names += (names.empty() ? "" : ", ") + known;
            p.refuse("there is no vehicle '" + name + "'", "choose one of " + names);
        }
        scene.models.push_back(built->second());
        vehicles::VehicleKind kind = vehicles::kindsOf({scene.models.back()}).front();
        kind.share = 0;
        scene.kinds.push_back(kind);
        found = scene.models.end() - 1;
    }
    return static_cast<std::uint32_t>(found - scene.models.begin());
}

glm::dvec3 onTheGround(const JsonPlace& p, const Scene& scene, double above) {
    const std::vector<JsonPlace> two = p.items();
    if (two.size() != 2)
        p.refuse("has " + std::to_string(two.size()) + " numbers", "write two, [east, north]");
    const glm::dvec3 flat(two[0].number(-1e6, 1e6), two[1].number(-1e6, 1e6), 0);
    return {flat.x, flat.y, roadHeightNear(scene.city.roads, flat).value_or(0) + above};
}

StagedVehicle vehicleOf(const JsonPlace& p, Scene& scene) {
    p.only({"model", "paint", "at", "facing", "path", "speed", "above"});
    StagedVehicle vehicle;
    vehicle.model = modelOf(p.at("model"), scene);
    vehicle.wheelRadius = scene.models[vehicle.model].wheelRadius;
    if (p.has("paint")) vehicle.paint = p.at("paint").share();
    const double above = p.has("above") ? p.at("above").number(-100, 100) : 0;
    if (p.has("at") == p.has("path")) p.refuse("stands or drives", "write one of 'at' and 'path'");
    if (p.has("at")) {
        if (p.has("speed")) p.at("speed").refuse("what stands has none", "write 'path' in place of 'at'");
        vehicle.path = {onTheGround(p.at("at"), scene, above)};
        // A compass knows no other way round.
        vehicle.heading = glm::radians(90 - p.at("facing").number(-360, 360));
        return vehicle;
    }
    if (p.has("facing")) p.at("facing").refuse("what drives faces its path", "leave it out");
    for (const JsonPlace& point : p.at("path").items())
        vehicle.path.push_back(onTheGround(point, scene, above));
    if (vehicle.path.size() < 2) p.at("path").refuse("has fewer than two points", "add where it leads");
    if (vehicle.path.front() == vehicle.path.back() && vehicle.path.size() == 2)
        p.at("path").refuse("both points are the same", "move one of them");
    vehicle.speed = p.at("speed").number(0, 100);
    vehicle.since = settlingTime;
    return vehicle;
}

std::vector<city::TourStop> tourOf(const std::vector<JsonPlace>& views) {
    std::vector<city::TourStop> tour;
    float time = 0;
    for (const JsonPlace& p : views) {
        p.only({"name", "eye", "target"});
        city::TourStop stop;
        stop.eye = p.at("eye").vector();
        stop.target = p.at("target").vector();
        if (stop.eye == stop.target) p.refuse("'eye' and 'target' are the same point", "move one of them");
        // Tours are smooth curves: two stops at each end of a view, so that it stands still between them.
        for (const float held : {0.0f, stillAfter, viewSeconds - stillAfter, viewSeconds}) {
            stop.time = time + held;
            tour.push_back(stop);
        }
        time += viewSeconds + changeSeconds;
    }
    return tour;
}

}  // namespace

void readStaging(const std::string& text, const std::string& name, Scene& scene) {
    const nlohmann::json document = parseJson(text, name);
    const JsonPlace top(document, name, "data/scenes/README.md");
    top.only({"name", "vehicles", "views"});
    top.at("name").text();
    for (const JsonPlace& p : top.at("vehicles").items()) scene.staged.push_back(vehicleOf(p, scene));
    if (top.has("views")) {
        const std::vector<city::TourStop> tour = tourOf(top.at("views").items());
        if (!tour.empty()) scene.city.tour = tour;
    }
}

void loadStaging(const std::filesystem::path& file, Scene& scene) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf()))
        throw std::runtime_error(file.string() +
                                 ": cannot be read, or is empty; check the name and its permissions.");
    readStaging(text.str(), file.string(), scene);
}

}  // namespace app
