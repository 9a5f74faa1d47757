#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "city/import/OsmData.h"

namespace city {

/// Reads .osm and .osm.pbf files (also .gz and .bz2 of them) through libosmium; the objects may come in any
/// order. The local frame's origin is the middle of the file's bounds, or, where the header has none, of the
/// box that holds the middle 98 per cent of the nodes of buildings and streets: stray ways run far outside.
/// Poles and antimeridian are places like any others. `size`: clip to a square of this side; without, to
/// 32,768 m. Throws std::runtime_error for files that are missing, damaged or
/// hold nothing. Cost: about 0.2 s for 50,000 nodes.
OsmData readOsm(const std::filesystem::path& file, std::optional<double> size);

/// The same of what stands in memory. `format`: "osm" or "pbf".
OsmData readOsm(std::string_view bytes, const std::string& format, std::optional<double> size);

}  // namespace city
