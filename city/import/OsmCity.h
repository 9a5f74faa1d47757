#pragma once

#include "city/import/LoadCity.h"

namespace city {

/// A city from an OpenStreetMap file: see loadCity.
CityModel loadOsmCity(const std::filesystem::path& file, const ImportOptions& options);

}  // namespace city
