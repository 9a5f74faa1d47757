#include "city/import/GeoTiffPlace.h"

#include <geotiff/geo_normalize.h>
#include <geotiff/geotiff.h>
#include <geotiff/geovalues.h>
#include <geotiff/xtiffio.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <span>
#include <stdexcept>

namespace city {

namespace {

constexpr ttag_t pixelScaleTag = 33550;
constexpr ttag_t tiePointTag = 33922;
constexpr ttag_t matrixTag = 34264;
constexpr ttag_t gdalNoDataTag = 42113;
/// Pixels whose sides differ by less are square: a hundredth of a cell over 65536 cells.
constexpr double squareTolerance = 1e-7;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw std::runtime_error("heightfield " + file.string() + ": " + what);
}

/// libtiff's complaints go nowhere while this lives; OpenImageIO has reported what matters.
class QuietTiff {
  public:
    QuietTiff() : error_(TIFFSetErrorHandler(nullptr)), warning_(TIFFSetWarningHandler(nullptr)) {}
    ~QuietTiff() {
        TIFFSetErrorHandler(error_);
        TIFFSetWarningHandler(warning_);
    }
    QuietTiff(const QuietTiff&) = delete;
    QuietTiff& operator=(const QuietTiff&) = delete;

  private:
    TIFFErrorHandler error_;
    TIFFErrorHandler warning_;
};

std::span<const double> doubles(TIFF* tiff, ttag_t tag) {
    std::uint16_t count = 0;
    const double* values = nullptr;
    if (TIFFGetField(tiff, tag, &count, &values) != 1 || values == nullptr) return {};
    return {values, count};
}

/// GDAL writes the value as text.
std::optional<double> gdalNoData(TIFF* tiff) {
    const TIFFField* field = TIFFFindField(tiff, gdalNoDataTag, TIFF_ANY);
    if (field == nullptr) return std::nullopt;
    const char* text = nullptr;
    std::uint32_t length = 0;
    // A tag that libtiff does not know by name comes with its length.
    const int found = TIFFFieldPassCount(field) != 0 ? TIFFGetField(tiff, gdalNoDataTag, &length, &text)
                                                     : TIFFGetField(tiff, gdalNoDataTag, &text);
    if (found != 1 || text == nullptr) return std::nullopt;
    const std::string value = TIFFFieldPassCount(field) != 0 ? std::string(text, length) : std::string(text);
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    return end != value.c_str() ? std::optional(number) : std::nullopt;
}

std::optional<unsigned short> shortKey(GTIF* keys, geokey_t key) {
    unsigned short value = 0;
    if (GTIFKeyGet(keys, key, &value, 0, 1) != 1) return std::nullopt;
    return value;
}

double metresPerUnit(const std::filesystem::path& file, GTIF* keys) {
    const auto unit = shortKey(keys, ProjLinearUnitsGeoKey);
    if (!unit || *unit == Linear_Meter || *unit == KvUserDefined) return 1;
    if (*unit == Linear_Foot) return 0.3048;
    if (*unit == Linear_Foot_US_Survey) return 1200.0 / 3937.0;
    refuse(file,
           "its unit of length (EPSG:" + std::to_string(*unit) +
               ", GeoTIFF key ProjLinearUnits) is not known here; convert it to metres with gdalwarp -t_srs");
}

}  // namespace

GeoTiffPlace readGeoTiffPlace(const std::filesystem::path& file) {
    const QuietTiff quiet;
    GeoTiffPlace place;
    const std::unique_ptr<TIFF, decltype(&XTIFFClose)> tiff(XTIFFOpen(file.c_str(), "r"), &XTIFFClose);
    if (!tiff) return place;

    place.noData = gdalNoData(tiff.get());

    const std::unique_ptr<GTIF, decltype(&GTIFFree)> keys(GTIFNew(tiff.get()), &GTIFFree);
    double metres = 1;
    double centre =
        0;  // pixels from the reference point to the corner: half a pixel where points, not areas, are stored
    if (keys) {
        const auto model = shortKey(keys.get(), GTModelTypeGeoKey);
        const auto code =
            shortKey(keys.get(), model == ModelTypeGeographic ? GeographicTypeGeoKey : ProjectedCSTypeGeoKey);
        if (code && *code != KvUserDefined && *code != 0)
            place.coordinateSystem = "EPSG:" + std::to_string(*code);
        if (model == ModelTypeGeographic)
            refuse(file, "its cells are in degrees (" +
                             (place.coordinateSystem.empty() ? "a geographic coordinate system"
                                                             : place.coordinateSystem) +
                             "); reproject it to metres with gdalwarp -t_srs EPSG:32633 or the like");
        metres = metresPerUnit(file, keys.get());
        if (shortKey(keys.get(), GTRasterTypeGeoKey) == RasterPixelIsPoint) centre = 0.5;
    }

    const auto scale = doubles(tiff.get(), pixelScaleTag);
    const auto tie = doubles(tiff.get(), tiePointTag);
    const auto matrix = doubles(tiff.get(), matrixTag);
    double across = 0, down = 0, west = 0, north = 0;
    if (scale.size() >= 2 && tie.size() >= 6) {
        across = scale[0];
        down = scale[1];
        west = tie[3] - (tie[0] + centre) * across;
        north = tie[4] + (tie[1] + centre) * down;
    } else if (matrix.size() >= 16) {
        if (matrix[1] != 0 || matrix[4] != 0)
            refuse(file, "its grid is rotated (tag 34264); turn it north up with gdalwarp");
        across = matrix[0];
        down = -matrix[5];
        west = matrix[3] - centre * across;
        north = matrix[7] + centre * down;
    } else {
        return place;
    }
    if (!std::isfinite(across) || !std::isfinite(down) || across <= 0 || down <= 0)
        refuse(file, "its cell size (tag 33550 or 34264) is " + std::to_string(across) + " by " +
                         std::to_string(down) +
                         ", which is not finite and positive; write it anew with gdal_translate -a_ullr");
    if (std::abs(across - down) > squareTolerance * across)
        refuse(file, "its cells are not square (" + std::to_string(across) + " by " + std::to_string(down) +
                         "); resample it with gdalwarp -tr");
    if (!std::isfinite(west) || !std::isfinite(north))
        refuse(file,
               "its corner (tag 33922 or 34264) is not finite; write it anew with gdal_translate -a_ullr");
    place.cellSize = across * metres;
    place.northWest = glm::dvec2(west, north) * metres;
    return place;
}

void requireWholeTiff(const std::filesystem::path& file) {
    const QuietTiff quiet;
    const std::unique_ptr<TIFF, decltype(&XTIFFClose)> tiff(XTIFFOpen(file.c_str(), "r"), &XTIFFClose);
    if (!tiff) refuse(file, "its TIFF header cannot be read; fetch or export it again");
    const std::uint64_t size = std::filesystem::file_size(file);
    const bool tiled = TIFFIsTiled(tiff.get()) != 0;
    const std::uint32_t count = tiled ? TIFFNumberOfTiles(tiff.get()) : TIFFNumberOfStrips(tiff.get());
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint64_t offset = TIFFGetStrileOffset(tiff.get(), k);
        const std::uint64_t bytes = TIFFGetStrileByteCount(tiff.get(), k);
        if (offset == 0 || bytes == 0 || offset > size || bytes > size - offset)
            refuse(file, std::string(tiled ? "tile " : "strip ") + std::to_string(k) + " of " +
                             std::to_string(count) +
                             " is not in the file, which is truncated; fetch or export it again");
    }
}

}  // namespace city
