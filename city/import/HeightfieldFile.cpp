#include "city/import/HeightfieldFile.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wextra"
#include <OpenImageIO/imageio.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "city/import/GeoTiffPlace.h"
#include "city/terrain/ExrHeader.h"

namespace city {

namespace {

namespace fs = std::filesystem;

constexpr int mostCellsAcross = 65536;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
    throw std::runtime_error("heightfield " + file.string() + ": " + what);
}

/// Messages of libraries end lines; ours are one sentence.
std::string oneLine(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '.' || text.back() == ' '))
        text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "unknown cause" : text;
}

bool isTiff(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    return ending == ".tif" || ending == ".tiff";
}

struct Described {
    float cellSize;
    glm::dvec2 origin;
};

/// Hexadecimal floats survive as they are.
std::string describe(const Heightfield& field) {
    char text[160];
    std::snprintf(text, sizeof text, "mirrorstreet heightfield: cell size %a m, south-west corner %a %a",
                  static_cast<double>(field.cellSize()), field.origin().x, field.origin().y);
    return text;
}

std::optional<Described> parseDescription(const std::string& text) {
    double cell = 0, x = 0, y = 0;
    if (std::sscanf(text.c_str(), "mirrorstreet heightfield: cell size %la m, south-west corner %la %la",
                    &cell, &x, &y) != 3)
        return std::nullopt;
    return Described{static_cast<float>(cell), {x, y}};
}

/// Values as they stand in the file, whatever their type.
template <class T>
void convert(const std::vector<unsigned char>& bytes, std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
        T value;
        std::memcpy(&value, bytes.data() + k * sizeof(T), sizeof(T));
        values[k] = static_cast<double>(value);
    }
}

/// OpenImageIO's name of the file's format.
const char* formatOf(const fs::path& file) {
    std::array<char, 4> first{};
    std::ifstream(file, std::ios::binary).read(first.data(), first.size());
    const std::string_view mark(first.data(), first.size());
    using namespace std::string_view_literals;
    if (mark == "\x76\x2f\x31\x01"sv) return "openexr";
    // Little- and big-endian, classic and BigTIFF.
    for (const std::string_view tiff : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
        if (mark == tiff) return "tiff";
    refuse(file, "it cannot be read as an image of heights; give an EXR or TIFF file");
}

class Reader {
  public:
    explicit Reader(const fs::path& file) : file_(file) {
        std::error_code error;
        if (!fs::exists(file, error)) refuse(file, "there is no such file; check the name");
        if (fs::is_directory(file, error)) refuse(file, "this is a folder; name a file in it");
        if (fs::file_size(file, error) == 0 && !error)
            refuse(file, "the file is empty (0 bytes); fetch or export it again");
        // By its first bytes, not by its name: OpenImageIO would try its thirty readers one after another.
        const char* format = formatOf(file);
        if (std::string_view(format) == "tiff") {
            requireWholeTiff(file);
        } else if (const ExrHeader header = readExrHeader(file); !header.fault.empty()) {
            refuse(file, header.fault + "; fetch or export it again");
        } else if (header.compression >= ExrHeader::Compression::b44) {
            refuse(file,
                   "it is packed as pictures are (B44 or DWA), which loses heights; export it with ZIP");
        }
        input_ = OIIO::ImageInput::create(format);
        OIIO::ImageSpec opened;
        if (!input_ || !input_->open(file.string(), opened))
            refuse(file, "it cannot be read as an image (" +
                             oneLine(input_ ? input_->geterror() : OIIO::geterror()) +
                             "); fetch or export it again");
        const OIIO::ImageSpec& s = input_->spec();
        if (s.width < 1 || s.height < 1 || s.depth > 1 || s.nchannels < 1)
            refuse(file, "its header names " + std::to_string(s.width) + " x " + std::to_string(s.height) +
                             " cells, which is no heightfield; export it again");
        if (s.width > mostCellsAcross || s.height > mostCellsAcross)
            refuse(file, "its header names " + std::to_string(s.width) + " x " + std::to_string(s.height) +
                             " cells, more than 65536 x 65536; cut it into pieces or use larger cells");
    }

    const OIIO::ImageSpec& spec() const { return input_->spec(); }
    const char* format() const { return input_->format_name(); }

    /// One image row of the first channel in the file's own type: OpenImageIO would divide integers by their
    /// range.
    void row(int y, std::vector<double>& values) {
        const OIIO::ImageSpec& s = spec();
        const OIIO::TypeDesc type = nativeType();
        if (band_.empty() || y < bandStart_ || y >= bandEnd_) readBand(y, type);
        const std::size_t rowBytes = static_cast<std::size_t>(s.width) * type.size();
        bytes_.assign(
            band_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y - bandStart_) * rowBytes),
            band_.begin() +
                static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y - bandStart_ + 1) * rowBytes));
        values.resize(static_cast<std::size_t>(s.width));
        switch (type.basetype) {
            case OIIO::TypeDesc::UINT8:
                convert<std::uint8_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::INT8:
                convert<std::int8_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::UINT16:
                convert<std::uint16_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::INT16:
                convert<std::int16_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::UINT32:
                convert<std::uint32_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::INT32:
                convert<std::int32_t>(bytes_, values);
                break;
            case OIIO::TypeDesc::DOUBLE:
                convert<double>(bytes_, values);
                break;
            default:
                convert<float>(bytes_, values);
                break;
        }
    }

  private:
    OIIO::TypeDesc nativeType() const {
        const auto base = static_cast<OIIO::TypeDesc::BASETYPE>(spec().format.basetype);
        switch (base) {
            case OIIO::TypeDesc::UINT8:
            case OIIO::TypeDesc::INT8:
            case OIIO::TypeDesc::UINT16:
            case OIIO::TypeDesc::INT16:
            case OIIO::TypeDesc::UINT32:
            case OIIO::TypeDesc::INT32:
            case OIIO::TypeDesc::DOUBLE:
                return base;
            default:
                return OIIO::TypeDesc::FLOAT;  // float itself, and half, which floats hold exactly
        }
    }

    void readBand(int y, const OIIO::TypeDesc& type) {
        const OIIO::ImageSpec& s = spec();
        const int rows = s.tile_height > 0 ? s.tile_height : 64;
        bandStart_ = y / rows * rows;
        bandEnd_ = std::min(s.height, bandStart_ + rows);
        band_.resize(static_cast<std::size_t>(bandEnd_ - bandStart_) * static_cast<std::size_t>(s.width) *
                     type.size());
        const int begin = s.y + bandStart_, end = s.y + bandEnd_;
        // As they stand where that can be: OpenImageIO makes room for 64 MiB to convert a row.
        const bool asTheyStand = s.channelformats.empty() && type == s.format;
        bool read = false;
        if (s.tile_width > 0)
            read = input_->read_tiles(0, 0, s.x, s.x + s.width, begin, end, 0, 1, 0, 1, type, band_.data());
        else if (asTheyStand)
            read = input_->read_native_scanlines(0, 0, begin, end, 0, 0, 1, band_.data());
        else
            read = input_->read_scanlines(0, 0, begin, end, 0, 0, 1, type, band_.data());
        if (!read)
            refuse(file_, "rows " + std::to_string(bandStart_) + " to " + std::to_string(bandEnd_ - 1) +
                              " cannot be read (" + oneLine(input_->geterror()) +
                              "), the file is truncated or damaged; fetch or export it again");
    }

    fs::path file_;
    std::unique_ptr<OIIO::ImageInput> input_;
    std::vector<unsigned char> band_, bytes_;
    int bandStart_ = 0, bandEnd_ = 0;
};

}  // namespace

LoadedHeightfield loadHeightfield(const fs::path& file, float cellSize) {
    Reader reader(file);
    const OIIO::ImageSpec& spec = reader.spec();
    std::vector<std::string> notes;
    std::string coordinateSystem;
    std::optional<double> noData;
    glm::dvec2 origin(0);

    const auto described = parseDescription(spec.get_string_attribute("ImageDescription"));
    GeoTiffPlace place;
    if (described) {
        cellSize = described->cellSize;
        origin = described->origin;
    } else if (std::string_view(reader.format()) == "tiff") {
        place = readGeoTiffPlace(file);
        noData = place.noData;
        coordinateSystem = place.coordinateSystem;
    }
    if (place.cellSize) {
        cellSize = static_cast<float>(*place.cellSize);
        origin = {place.northWest.x, place.northWest.y - *place.cellSize * spec.height};
    } else if (!described) {
        char note[120];
        std::snprintf(note, sizeof note,
                      "The file names no cell size or place; cells of %g m from (0, 0) were assumed.",
                      static_cast<double>(cellSize));
        notes.emplace_back(note);
    }
    if (!std::isfinite(cellSize) || cellSize <= 0 || !std::isfinite(origin.x) || !std::isfinite(origin.y))
        refuse(file, "its cell size is " + std::to_string(cellSize) + " m at corner (" +
                         std::to_string(origin.x) + ", " + std::to_string(origin.y) +
                         "), which is not finite and positive; save or export it again");
    if (spec.nchannels > 1)
        notes.push_back("The file has " + std::to_string(spec.nchannels) +
                        " channels; the first was taken as height.");

    // The last row before the memory for all: a damaged header may tell of far more than the file holds.
    std::vector<double> row;
    reader.row(spec.height - 1, row);
    Heightfield field(spec.width, spec.height, cellSize, origin);
    std::size_t unknown = 0;
    for (int y = 0; y < spec.height; ++y) {
        reader.row(y, row);
        for (int i = 0; i < spec.width; ++i) {
            const double value = row[static_cast<std::size_t>(i)];
            const bool missing =
                noData && (value == *noData || static_cast<float>(value) == static_cast<float>(*noData));
            unknown += missing;
            field.set(i, spec.height - 1 - y,
                      missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value));
        }
    }
    if (unknown > 0)
        notes.push_back(std::to_string(unknown) + " cells have no height (NODATA) and are empty.");
    return {std::move(field), std::move(coordinateSystem), std::move(notes)};
}

void saveHeightfield(const Heightfield& field, const fs::path& file) {
    std::string ending = file.extension().string();
    if (!isTiff(file) && ending != ".exr" && ending != ".EXR")
        refuse(file, "heightfields are saved as .exr, .tif or .tiff; choose one of these endings");
    if (field.width() > mostCellsAcross || field.height() > mostCellsAcross)
        refuse(file, "more than 65536 x 65536 cells cannot be saved; use larger cells");
    fs::path aside = file;
    aside.replace_extension(".partial" + ending);
    const auto fail = [&](const std::string& cause) {
        std::error_code ignored;
        fs::remove(aside, ignored);
        refuse(file, "it cannot be written (" + oneLine(cause) +
                         "); check the folder, its permissions and the free space");
    };
    auto output = OIIO::ImageOutput::create(aside.string());
    if (!output) fail(OIIO::geterror());
    OIIO::ImageSpec spec(field.width(), field.height(), 1, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"Y"};
    spec.attribute("ImageDescription", describe(field));
    spec.attribute("compression", "zip");
    if (!output->open(aside.string(), spec)) fail(output->geterror());
    // North first in the image.
    for (int y = 0; y < field.height(); ++y)
        if (!output->write_scanline(y, 0, OIIO::TypeDesc::FLOAT,
                                    &field.cells()[static_cast<std::size_t>(field.height() - 1 - y) *
                                                   static_cast<std::size_t>(field.width())]))
            fail(output->geterror());
    if (!output->close()) fail(output->geterror());
    output.reset();
    std::error_code error;
    fs::rename(aside, file, error);
    if (error) fail(error.message());
}

}  // namespace city
