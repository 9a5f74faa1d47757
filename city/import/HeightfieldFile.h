#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "city/terrain/Heightfield.h"

namespace city {

/// A heightfield from a file, with what the file says about its place.
struct LoadedHeightfield {
    Heightfield field;  ///< row 0 at the south edge; metres of the file's coordinate system, or from (0, 0)
    std::string coordinateSystem;    ///< "EPSG:2154" where the file names one, else empty
    std::vector<std::string> notes;  ///< what was guessed or dropped, one sentence each
};

/// Loads a one-channel image of heights in metres: EXR and TIFF as `saveHeightfield` writes them, and others
/// of these formats that keep heights as they are (see requireWholeTiff and readExrHeader), whatever the
/// file's ending; integers taken as they stand (not divided by their range). GeoTIFF: cell
/// size and corner from the pixel scale and tie point (tags 33550, 33922) or the matrix (34264),
/// pixel-is-point honoured, feet converted, GDAL's NODATA (42113) becomes NaN. A file without place gets
/// cells of `cellSize` from (0, 0), and a note. Of several channels the first counts, and a note says so.
/// Throws std::runtime_error, one sentence with file, place, cause and remedy: unreadable, truncated, empty,
/// larger than 65536 x 65536 cells, rotated, cells that are not square, degrees in place of metres, a cell
/// size that is not finite and positive.
LoadedHeightfield loadHeightfield(const std::filesystem::path& file, float cellSize = 1);

/// Saves as .exr, .tif or .tiff, float, lossless; cell size and origin go into the description, so that
/// loading gives back the very same field, bit for bit. Written aside, then renamed: nothing half-written is
/// left. Throws std::runtime_error as above.
void saveHeightfield(const Heightfield& field, const std::filesystem::path& file);

}  // namespace city
