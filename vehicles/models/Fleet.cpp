#include "vehicles/models/Fleet.h"

#include <algorithm>
#include <future>

#include "vehicles/models/Bodies.h"

namespace vehicles {

std::vector<VehicleModel> builtInFleet() {
    std::vector<VehicleModel> fleet;
    // Each is a quarter of a second's work and none knows of the others.
    std::vector<std::future<VehicleModel>> builds;
    for (const auto build : {hatchback, saloon, van, bus, tram})
        builds.push_back(std::async(std::launch::async, build));
    fleet.reserve(builds.size());
    for (auto& build : builds) fleet.push_back(build.get());
    return fleet;
}

std::vector<VehicleKind> kindsOf(const std::vector<VehicleModel>& models) {
    struct Known {
        const char* name;
        float acceleration, deceleration, share;
    };
    // Comfortable rates: cars at what city drivers take without haste; standing passengers
    // ask for less.
    static constexpr Known known[] = {{"hatchback", 1.7f, 2.2f, 5},
                                      {"saloon", 1.6f, 2.2f, 4},
                                      {"van", 1.3f, 2.0f, 2},
                                      {"bus", 1.0f, 1.4f, 0.6f},
                                      {"tram", 1.0f, 1.3f, 1}};
    std::vector<VehicleKind> kinds;
    for (const VehicleModel& model : models) {
        VehicleKind kind;
        kind.length = model.length;
        kind.width = model.width;
        kind.wheelRadius = model.wheelRadius;
        kind.tram = model.name == "tram";
        kind.wheelbase = 0.6f * model.length;
        if (model.wheels.size() > 1) {
            const auto [rear, front] =
                std::minmax_element(model.wheels.begin(), model.wheels.end(),
                                    [](const VehicleModel::Wheel& a, const VehicleModel::Wheel& b) {
                                        return a.centre.x < b.centre.x;
                                    });
            if (front->centre.x - rear->centre.x > 0.3f * model.length)
                kind.wheelbase = front->centre.x - rear->centre.x;
        }
        for (const Known& k : known)
            if (model.name == k.name) {
                kind.acceleration = k.acceleration;
                kind.deceleration = k.deceleration;
                kind.share = k.share;
            }
        kinds.push_back(kind);
    }
    return kinds;
}

}  // namespace vehicles
