#pragma once

#include <cstdint>

#include "city/model/CityModel.h"

namespace city {

/// The benchmark city of Meyer & Loscos 2003, section 7: 1 km2, 8 roads, buildings of 25,600 triangles in
/// all, 8 trees of 59,100 triangles each, 500,000 triangles with ground and roads.
CityModel generatePaperCity(std::uint64_t seed = 1);

}  // namespace city
