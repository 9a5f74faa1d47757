#include "city/import/LoadCity.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "city/import/OsmCity.h"

namespace city {

CityModel loadCity(const std::filesystem::path& file, const ImportOptions& options) {
    if (options.size && !(std::isfinite(*options.size) && *options.size >= 10))
        throw std::runtime_error(file.string() + ": cannot be cut to a square of " +
                                 std::to_string(*options.size) + " m; ask for at least 10 m");
    std::string name = file.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    for (const char* ending : {".osm", ".osm.pbf", ".pbf", ".osm.gz", ".osm.bz2"})
        if (name.ends_with(ending)) return loadOsmCity(file, options);
    throw std::runtime_error(
        file.string() +
        ": unknown kind of city file; supported endings are .osm, .osm.pbf, .osm.gz and .osm.bz2");
}

}  // namespace city
