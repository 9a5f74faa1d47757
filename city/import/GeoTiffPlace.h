#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>

namespace city {

/// Where a GeoTIFF lies.
struct GeoTiffPlace {
    std::optional<double> cellSize;  ///< metres
    glm::dvec2 northWest{0};         ///< corner of the first pixel, metres; set with cellSize
    std::optional<double> noData;    ///< the value that stands for "nothing known"
    std::string coordinateSystem;    ///< "EPSG:n" or empty
};

/// Reads the tags of a TIFF file; none of them is required. Throws std::runtime_error, one sentence, for a
/// place that a heightfield cannot have (rotated, not square, in degrees, not finite).
GeoTiffPlace readGeoTiffPlace(const std::filesystem::path& file);

/// OpenImageIO fills in what is missing at the end of a TIFF file; this throws std::runtime_error, one
/// sentence, where the strips or tiles that the header names are not all within the file.
void requireWholeTiff(const std::filesystem::path& file);

}  // namespace city
