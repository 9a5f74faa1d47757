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

/// What OpenImageIO and libtiff must not be given. Throws std::runtime_error, one sentence, where the strips
/// or tiles that the header names are not all within the file (OpenImageIO fills in what is missing) or could
/// not unpack to as many cells as it names; where values are not numbers of 8, 16, 32 or 64 bits, but colours
/// of a palette or ink; where they are packed by other means than those that keep heights as they are (LZW,
/// deflate, PackBits, Zstandard): for pictures, faxes and films there are decoders in libtiff that nobody
/// needs here.
void requireWholeTiff(const std::filesystem::path& file);

}  // namespace city
