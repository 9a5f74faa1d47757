#pragma once

#include <vector>

#include "app/commands/Options.h"
#include "app/frame/Lighting.h"
#include "app/frame/StagedVehicles.h"
#include "city/model/CityModel.h"
#include "city/model/GlassFronts.h"
#include "vehicles/models/VehicleModel.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// The city and the vehicles that may drive in it.
struct Scene {
    city::CityModel city;
    city::GlassFronts glass;  ///< the city's windows that mirror
    /// The traffic's, then one for each of the city's standing reflectors.
    std::vector<vehicles::VehicleModel> models;
    std::vector<vehicles::VehicleKind> kinds;  ///< of the traffic: kinds[i] speaks of models[i]
    std::vector<StagedVehicle> staged;         ///< beside the traffic, see --staged
    Lighting lighting;
};

/// The city that the options name: built in or from a file, with its importer's notes on stderr unless the
/// caller tells them otherwise. Throws
/// std::runtime_error or std::invalid_argument, one sentence, when it cannot be had.
city::CityModel loadCityOf(const Options& options, bool tellNotes = true);

/// The whole scene. `--car` takes the place of every model but the trams.
Scene loadScene(const Options& options);

/// Seconds of driving before anybody looks: drives begin at this time.
inline constexpr double settlingTime = 15;

/// Traffic in a scene, which must outlive it: `cars` cars and as many trams as the tram lanes are long (one
/// every 400 m), after a quarter of a minute's driving, so that nobody stands where he was put. Says on
/// stderr when fewer cars fit.
vehicles::Traffic startTraffic(const Scene& scene, std::uint64_t seed, std::uint32_t cars);

/// Length of a lane's centre line, metres.
double laneLength(const city::Lane& lane);

}  // namespace app
