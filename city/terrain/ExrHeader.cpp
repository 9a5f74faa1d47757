#include "city/terrain/ExrHeader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace city {

static_assert(std::endian::native == std::endian::little, "OpenEXR files are little-endian");

namespace {

constexpr std::uint64_t longestHeader = std::uint64_t{4} << 20;
constexpr std::int64_t widest = 65536;
constexpr std::size_t longestName = 255;
constexpr std::uint64_t greatestRatio = 1376;
/// A tile may be larger than the image that it holds; up to here that is nobody's harm.
constexpr std::uint64_t harmlessTile = std::uint64_t{16} << 20;
constexpr std::uint32_t magic = 20000630;
constexpr std::uint32_t knownFlags = 0x600;  // tiles, long names; neither deep data nor several parts

using Bytes = std::span<const std::uint8_t>;

/// Takes values off the front; nullopt from there on once the bytes have run out.
class Cursor {
  public:
    explicit Cursor(Bytes bytes) : bytes_(bytes) {}

    template <class T>
    std::optional<T> number() {
        if (bytes_.size() < sizeof(T)) return std::nullopt;
        T value;
        std::memcpy(&value, bytes_.data(), sizeof value);
        bytes_ = bytes_.subspan(sizeof value);
        return value;
    }
    /// Up to a zero byte; empty at the end of a list.
    std::optional<std::string_view> name() {
        const auto end = std::find(bytes_.begin(), bytes_.end(), std::uint8_t{0});
        const auto length = static_cast<std::size_t>(end - bytes_.begin());
        if (end == bytes_.end() || length > longestName) return std::nullopt;
        const std::string_view text(reinterpret_cast<const char*>(bytes_.data()), length);
        bytes_ = bytes_.subspan(length + 1);
        return text;
    }
    std::optional<Bytes> piece(std::int64_t size) {
        if (size < 0 || static_cast<std::uint64_t>(size) > bytes_.size()) return std::nullopt;
        const Bytes front = bytes_.first(static_cast<std::size_t>(size));
        bytes_ = bytes_.subspan(front.size());
        return front;
    }
    bool atEnd() const { return bytes_.empty(); }

  private:
    Bytes bytes_;
};

/// Types whose values have one size. Those of other names OpenEXR keeps as they are.
std::optional<std::size_t> sizeOfType(std::string_view type) {
    constexpr std::pair<std::string_view, std::size_t> sizes[] = {
        {"box2i", 16},      {"box2f", 16},    {"chromaticities", 32},
        {"compression", 1}, {"double", 8},    {"deepImageState", 1},
        {"envmap", 1},      {"float", 4},     {"int", 4},
        {"keycode", 28},    {"lineOrder", 1}, {"m33f", 36},
        {"m33d", 72},       {"m44f", 64},     {"m44d", 128},
        {"rational", 8},    {"tiledesc", 9},  {"timecode", 8},
        {"v2i", 8},         {"v2f", 8},       {"v2d", 16},
        {"v3i", 12},        {"v3f", 12},      {"v3d", 24},
    };
    for (const auto& [name, size] : sizes)
        if (name == type) return size;
    return std::nullopt;
}

/// The lists of strings, each after its length.
bool stringsFit(Cursor cursor) {
    while (!cursor.atEnd()) {
        const auto length = cursor.number<std::int32_t>();
        if (!length || !cursor.piece(*length)) return false;
    }
    return true;
}

bool previewFits(Bytes value) {
    Cursor cursor(value);
    const auto width = cursor.number<std::uint32_t>(), height = cursor.number<std::uint32_t>();
    return width && height && *width <= widest && *height <= widest &&
           value.size() == 8 + 4 * std::uint64_t{*width} * *height;
}

/// Bytes of a pixel; 0 for a broken list.
std::uint64_t pixelBytesOf(Cursor cursor) {
    std::uint64_t bytes = 0;
    for (;;) {
        const auto name = cursor.name();
        if (!name) return 0;
        if (name->empty()) return cursor.atEnd() ? bytes : 0;
        const auto type = cursor.number<std::int32_t>();
        const auto linearAndPadding = cursor.number<std::uint32_t>();
        const auto across = cursor.number<std::int32_t>(), down = cursor.number<std::int32_t>();
        if (!type || *type < 0 || *type > 2 || !linearAndPadding || !across || *across < 1 || !down ||
            *down < 1)
            return 0;
        bytes += *type == 1 ? 2 : 4;
    }
}

std::uint64_t rowsPerBlock(ExrHeader::Compression compression) {
    constexpr std::array<std::uint64_t, 10> rows{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    return rows[static_cast<std::size_t>(compression)];
}

std::uint64_t pieces(std::uint64_t whole, std::uint64_t part) {
    return (whole + part - 1) / part;
}

class HeaderReader {
  public:
    HeaderReader(Bytes front, std::uint64_t fileSize) : cursor_(front), fileSize_(fileSize) {}

    ExrHeader read() {
        header_.fault = faultOfHeader();
        if (header_.fault.empty()) header_.fault = faultOfSizes();
        return header_;
    }

  private:
    std::string faultOfHeader() {
        const auto mark = cursor_.number<std::uint32_t>(), version = cursor_.number<std::uint32_t>();
        if (!mark || *mark != magic || !version) return "it is no OpenEXR file";
        if ((*version & 0xff) != 2 || (*version & ~(0xffu | knownFlags)) != 0)
            return "it has several parts or deep data";
        tiled_ = (*version & 0x200) != 0;
        for (;;) {
            const auto name = cursor_.name();
            if (!name) return "its header does not end";
            if (name->empty()) return {};
            const std::string said = "attribute " + std::string(*name);
            const auto type = cursor_.name();
            const auto size = cursor_.number<std::int32_t>();
            const auto value = type && size ? cursor_.piece(*size) : std::nullopt;
            if (!value) return said + " reaches out of the header";
            if (!take(*name, *type, *value)) return said + " is no " + std::string(*type);
        }
    }

    /// False when the value is none of its type.
    bool take(std::string_view name, std::string_view type, Bytes value) {
        if (const auto size = sizeOfType(type); size && *size != value.size()) return false;
        if (type == "stringvector" && !stringsFit(Cursor(value))) return false;
        if (type == "preview" && !previewFits(value)) return false;
        if (type == "floatvector" && value.size() % 4 != 0) return false;
        if (type == "idmanifest") return false;  // packed, of any size once unpacked; no image here has one
        Cursor cursor(value);
        if (name == "dataWindow") {
            if (type != "box2i") return false;
            const auto x0 = cursor.number<std::int32_t>(), y0 = cursor.number<std::int32_t>();
            const auto x1 = cursor.number<std::int32_t>(), y1 = cursor.number<std::int32_t>();
            header_.width = std::int64_t{*x1} - *x0 + 1;
            header_.height = std::int64_t{*y1} - *y0 + 1;
        } else if (name == "channels") {
            if (type != "chlist") return false;
            header_.pixelBytes = pixelBytesOf(cursor);
            return header_.pixelBytes > 0;
        } else if (name == "compression") {
            if (type != "compression" || value[0] > 9) return false;
            header_.compression = static_cast<ExrHeader::Compression>(value[0]);
        } else if (name == "tiles") {
            if (type != "tiledesc") return false;
            tileWidth_ = *cursor.number<std::uint32_t>();
            tileHeight_ = *cursor.number<std::uint32_t>();
        } else if (name == "chunkCount") {
            if (type != "int") return false;
            chunks_ = *cursor.number<std::int32_t>();
            return chunks_ >= 0;
        } else if (type == "chlist") {
            return pixelBytesOf(cursor) > 0;
        }
        return true;
    }

    std::string faultOfSizes() const {
        if (header_.width < 1 || header_.width > widest || header_.height < 1 || header_.height > widest)
            return "its header names " + std::to_string(header_.width) + " x " +
                   std::to_string(header_.height) + " pixels, not 1 to 65536 each way";
        if (header_.pixelBytes == 0) return "its header names no channels";
        const auto width = static_cast<std::uint64_t>(header_.width),
                   height = static_cast<std::uint64_t>(header_.height);
        // At most 2^32 pixels of 2^22 bytes.
        const std::uint64_t mostBytes = greatestRatio * fileSize_;
        std::uint64_t blocks = pieces(height, rowsPerBlock(header_.compression));
        if (tiled_) {
            if (tileWidth_ < 1 || tileWidth_ > widest || tileHeight_ < 1 || tileHeight_ > widest ||
                tileWidth_ * tileHeight_ * header_.pixelBytes > std::max(harmlessTile, mostBytes))
                return "its header names tiles of " + std::to_string(tileWidth_) + " x " +
                       std::to_string(tileHeight_) + " pixels";
            blocks = pieces(width, tileWidth_) * pieces(height, tileHeight_);
        }
        blocks = std::max(blocks, static_cast<std::uint64_t>(chunks_));
        if (width * height * header_.pixelBytes > mostBytes || blocks * sizeof(std::uint64_t) > fileSize_)
            return "its header names " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels, more than the file can hold";
        return {};
    }

    Cursor cursor_;
    std::uint64_t fileSize_;
    bool tiled_ = false;
    std::uint64_t tileWidth_ = 0, tileHeight_ = 0;
    std::int32_t chunks_ = 0;
    ExrHeader header_;
};

}  // namespace

ExrHeader readExrHeader(const std::filesystem::path& file) {
    ExrHeader unreadable;
    unreadable.fault = "it cannot be read";
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(file, error);
    if (error) return unreadable;
    std::vector<std::uint8_t> front(static_cast<std::size_t>(std::min(size, longestHeader)));
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(front.data()), static_cast<std::streamsize>(front.size())))
        return unreadable;
    return HeaderReader(front, size).read();
}

}  // namespace city
