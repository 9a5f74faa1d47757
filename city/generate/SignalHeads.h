#pragma once

#include <vector>

#include "city/model/CityModel.h"

namespace city {

/// A signal pole at the kerb beside an approach to a signalled crossing.
struct SignalPole {
    glm::vec3 foot{0};
    glm::vec3 facing{1, 0, 0};  ///< unit, horizontal, towards the drivers
};

struct SignalLayout {
    std::vector<SignalHead> heads;
    std::vector<SignalPole> poles;
};

/// Where signals stand: for every approach (the lanes that end side by side at a signalled junction) a pole
/// to the right of the outermost lane, beside the stop line, with one head for each signal group of the
/// approach, at `height` metres above the road. Tram lanes of a median get a pole of their own. `kerbOffset`:
/// metres from the lane's edge to the pole.
SignalLayout layOutSignals(const RoadNetwork& roads, float kerbOffset = 0.6f, float height = 2.75f);

}  // namespace city
