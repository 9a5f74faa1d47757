#include "city/import/GeoTiffPlace.h"

#include <geotiff/geo_normalize.h>
#include <geotiff/geotiff.h>
#include <geotiff/geovalues.h>
#include <geotiff/xtiffio.h>

#include <algorithm>
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

/// A tile may be larger than the image that it holds; up to here that is nobody's harm. Bytes.
constexpr double harmlessTile = 16 << 20;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw std::runtime_error("heightfield " + file.string() + ": " + what);
}

/// libtiff's complaints go nowhere while this lives; what matters is said in our own words.
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

/// For libgeotiff, which would write to the terminal.
__attribute__((format(printf, 3, 4))) void saidNothing(GTIF*, int, const char*, ...) {}

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

/// A tag's value, or its default as libtiff knows it.
template <class T>
T field(TIFF* tiff, ttag_t tag) {
    T value{};
    return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : T{};
}

/// How many times its size a file can unpack to; nullopt for what is not taken.
std::optional<std::uint64_t> greatestRatio(std::uint16_t compression) {
    switch (compression) {
        case COMPRESSION_NONE:
            return 1;
        case COMPRESSION_PACKBITS:
            return 64;  // 128 bytes from two
        case COMPRESSION_LZW:
            return 2731;  // a table of 4096 strings, each a byte longer than one before: 4096 bytes from 12
                          // bits
        case COMPRESSION_DEFLATE:
        case COMPRESSION_ADOBE_DEFLATE:
            return 1032;  // zlib's documentation
        case COMPRESSION_ZSTD:
            return 32768;  // RFC 8878: blocks of 128 KiB from a header of three bytes and one byte
        default:
            return std::nullopt;
    }
}

}  // namespace

GeoTiffPlace readGeoTiffPlace(const std::filesystem::path& file) {
    const QuietTiff quiet;
    GeoTiffPlace place;
    const std::unique_ptr<TIFF, decltype(&XTIFFClose)> tiff(XTIFFOpen(file.c_str(), "r"), &XTIFFClose);
    if (!tiff) return place;

    place.noData = gdalNoData(tiff.get());

    const std::unique_ptr<GTIF, decltype(&GTIFFree)> keys(GTIFNewEx(tiff.get(), &saidNothing, nullptr),
                                                          &GTIFFree);
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
    const auto ratio = greatestRatio(field<std::uint16_t>(tiff.get(), TIFFTAG_COMPRESSION));
    if (!ratio)
        refuse(file, "it is packed as pictures or faxes are (TIFF compression " +
                         std::to_string(field<std::uint16_t>(tiff.get(), TIFFTAG_COMPRESSION)) +
                         "); write it anew with gdal_translate -co COMPRESS=DEFLATE");
    const std::uint16_t bits = field<std::uint16_t>(tiff.get(), TIFFTAG_BITSPERSAMPLE);
    const std::uint16_t samples = field<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLESPERPIXEL);
    const std::uint16_t meaning = field<std::uint16_t>(tiff.get(), TIFFTAG_PHOTOMETRIC);
    const std::uint16_t kind = field<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLEFORMAT);
    if ((bits != 8 && bits != 16 && bits != 32 && bits != 64) || kind > SAMPLEFORMAT_IEEEFP || samples < 1 ||
        (meaning != PHOTOMETRIC_MINISBLACK && meaning != PHOTOMETRIC_RGB))
        refuse(file, "its values are no heights (" + std::to_string(samples) + " of " + std::to_string(bits) +
                         " bits, sample format " + std::to_string(kind) + ", photometric " +
                         std::to_string(meaning) + "); write it anew with gdal_translate -ot Float32");

    const std::uint64_t size = std::filesystem::file_size(file);
    const std::uint64_t width = field<std::uint32_t>(tiff.get(), TIFFTAG_IMAGEWIDTH),
                        height = field<std::uint32_t>(tiff.get(), TIFFTAG_IMAGELENGTH);
    const bool tiled = TIFFIsTiled(tiff.get()) != 0;
    const std::uint64_t pixel = std::uint64_t{samples} * bits / 8;
    // The header's own limits: 2^32 each, of 2^19 bytes; as floating point numbers they do not overflow.
    const double most = static_cast<double>(*ratio) * static_cast<double>(size);
    const double tile = tiled
                            ? static_cast<double>(field<std::uint32_t>(tiff.get(), TIFFTAG_TILEWIDTH)) *
                                  static_cast<double>(field<std::uint32_t>(tiff.get(), TIFFTAG_TILELENGTH)) *
                                  static_cast<double>(pixel)
                            : 0;
    const std::uint64_t count = tiled ? TIFFNumberOfTiles(tiff.get()) : TIFFNumberOfStrips(tiff.get());
    if (static_cast<double>(width) * static_cast<double>(height) * static_cast<double>(pixel) > most ||
        tile > std::max(most, harmlessTile) || count > size)
        refuse(file, "its header names " + std::to_string(width) + " x " + std::to_string(height) +
                         " cells, more than the file can hold; fetch or export it again");
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
