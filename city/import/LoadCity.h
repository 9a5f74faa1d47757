#pragma once

#include <filesystem>
#include <optional>

#include "city/model/CityModel.h"

namespace city {

struct ImportOptions {
    std::uint64_t seed = 1;      ///< for what the file leaves open (colours, inferred heights)
    std::optional<double> size;  ///< clip to a square of this side around the centre, metres
};

/// Loads a city file by its ending (.osm, .osm.pbf, ...). Throws std::runtime_error: one sentence with file,
/// place in it, cause and remedy. What was dropped or guessed is in CityModel::notes.
CityModel loadCity(const std::filesystem::path& file, const ImportOptions& options);

}  // namespace city
