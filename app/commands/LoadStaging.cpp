#include "app/commands/LoadStaging.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
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

/// How a file tells places, and where they are in the scene.
class Ground {
  public:
    Ground(const city::CityModel& city, bool geographic) : city_(city), geographic_(geographic) {}

    /// On the ground, as high as the nearest lane.
    glm::dvec3 point(const JsonPlace& p, double above) const {
        const std::vector<JsonPlace> two = p.items();
        if (two.size() != 2)
            p.refuse("has " + std::to_string(two.size()) + " numbers", "write two, " + pair());
        return placed(p, two[0], two[1], above);
    }
    /// In the air: up is the city's own height in metres, or, in degrees, over the nearest lane.
    glm::dvec3 airborne(const JsonPlace& p) const {
        if (!geographic_) return p.vector();
        const std::vector<JsonPlace> three = p.items();
        if (three.size() != 3)
            p.refuse("has " + std::to_string(three.size()) + " numbers",
                     "write three, [longitude, latitude, metres above the road]");
        return placed(p, three[0], three[1], three[2].number(-100, 10000));
    }

  private:
    std::string pair() const { return geographic_ ? "[longitude, latitude]" : "[east, north]"; }
    glm::dvec3 placed(const JsonPlace& p, const JsonPlace& first, const JsonPlace& second,
                      double above) const {
        glm::dvec3 flat(0);
        if (geographic_) {
            const double longitude = first.number(-360, 360), latitude = second.number(-90, 90);
            flat = city_.frame->localFromGeodetic(latitude, longitude, city_.frame->height());
        } else {
            flat = glm::dvec3(first.number(-1e6, 1e6), second.number(-1e6, 1e6), 0);
        }
        const city::Aabb& box = city_.bounds;
        const glm::dvec2 off =
            glm::max(glm::max(glm::dvec2(box.min) - glm::dvec2(flat), glm::dvec2(flat) - glm::dvec2(box.max)),
                     glm::dvec2(0));
        if (!box.empty() && glm::length(off) > 0)
            p.refuse("lies " + std::to_string(std::lround(std::min(glm::length(off), 1e9))) +
                         " m outside the city",
                     "check the order, " + pair() + ", and the city");
        return {flat.x, flat.y, roadHeightNear(city_.roads, flat).value_or(0) + above};
    }

    const city::CityModel& city_;
    bool geographic_;
};

Ground groundOf(const JsonPlace& top, const city::CityModel& city) {
    if (!top.has("coordinates")) return {city, false};
    const JsonPlace p = top.at("coordinates");
    const std::string way = p.text();
    if (way != "metres" && way != "degrees")
        p.refuse("'" + way + "' is no way to tell places", "write metres or degrees");
    if (way == "degrees" && !city.frame)
        p.refuse("this city has no place on Earth", "write metres, and places in them");
    return {city, way == "degrees"};
}

StagedVehicle vehicleOf(const JsonPlace& p, const Ground& ground, Scene& scene) {
    p.only({"model", "paint", "at", "facing", "path", "speed", "above"});
    StagedVehicle vehicle;
    vehicle.model = modelOf(p.at("model"), scene);
    vehicle.wheelRadius = scene.models[vehicle.model].wheelRadius;
    if (p.has("paint")) vehicle.paint = p.at("paint").share();
    const double above = p.has("above") ? p.at("above").number(-100, 100) : 0;
    if (p.has("at") == p.has("path")) p.refuse("stands or drives", "write one of 'at' and 'path'");
    if (p.has("at")) {
        if (p.has("speed")) p.at("speed").refuse("what stands has none", "write 'path' in place of 'at'");
        vehicle.path = {ground.point(p.at("at"), above)};
        // A compass knows no other way round.
        vehicle.heading = glm::radians(90 - p.at("facing").number(-360, 360));
        return vehicle;
    }
    if (p.has("facing")) p.at("facing").refuse("what drives faces its path", "leave it out");
    for (const JsonPlace& point : p.at("path").items()) vehicle.path.push_back(ground.point(point, above));
    if (vehicle.path.size() < 2) p.at("path").refuse("has fewer than two points", "add where it leads");
    if (vehicle.path.front() == vehicle.path.back() && vehicle.path.size() == 2)
        p.at("path").refuse("both points are the same", "move one of them");
    vehicle.speed = p.at("speed").number(0, 100);
    vehicle.since = settlingTime;
    return vehicle;
}

std::vector<city::TourStop> tourOf(const std::vector<JsonPlace>& views, const Ground& ground) {
    std::vector<city::TourStop> tour;
    float time = 0;
    for (const JsonPlace& p : views) {
        p.only({"name", "eye", "target"});
        city::TourStop stop;
        stop.eye = ground.airborne(p.at("eye"));
        stop.target = ground.airborne(p.at("target"));
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
    const JsonPlace top(document, name, "data/staged/README.md");
    top.only({"name", "coordinates", "vehicles", "views"});
    top.at("name").text();
    const Ground ground = groundOf(top, scene.city);
    for (const JsonPlace& p : top.at("vehicles").items()) scene.staged.push_back(vehicleOf(p, ground, scene));
    if (top.has("views")) {
        const std::vector<city::TourStop> tour = tourOf(top.at("views").items(), ground);
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
