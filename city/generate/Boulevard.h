#pragma once

#include <cstdint>

#include "city/model/CityModel.h"

namespace city {

struct BoulevardOptions {
    std::uint64_t seed = 1;
    double size = 600;  ///< side of the city in metres, 200 to 2000
};

/// A city one wants to drive through: an avenue with a tram in the middle, a square, side streets, perimeter
/// blocks of 4 to 8 storeys with courtyards, shops with glass fronts, tree rows, lamps and signals. Throws
/// std::invalid_argument outside the range of sizes.
CityModel generateBoulevard(const BoulevardOptions& options = {});

}  // namespace city
