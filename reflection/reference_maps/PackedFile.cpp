#include "reflection/reference_maps/PackedFile.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <system_error>
#include <type_traits>
#include <vector>

namespace reflection {

static_assert(std::endian::native == std::endian::little, "the packed file is written as it lies in memory");

namespace {

constexpr std::uint64_t magic = 0x3170616d6b63616dull;  // "mackmap1": magic and version
constexpr std::uint32_t mostLevels = 16;
constexpr std::uint32_t greatestFace = 8192;

class Writer {
  public:
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(&value, sizeof value);
    }
    void put(const void* data, std::size_t size) {
        const auto* from = static_cast<const std::uint8_t*>(data);
        bytes.insert(bytes.end(), from, from + size);
    }
    std::vector<std::uint8_t> bytes;
};

class Reader {
  public:
    Reader(const std::vector<std::uint8_t>& bytes, std::size_t end) : bytes_(bytes), end_(end) {}
    template <class T>
    T get() {
        T value{};
        get(&value, sizeof value);
        return value;
    }
    void get(void* to, std::size_t size) {
        good = good && size <= end_ - at_;
        if (!good) return;
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }
    std::size_t left() const { return end_ - at_; }
    bool finished() const { return good && at_ == end_; }
    bool good = true;

  private:
    const std::vector<std::uint8_t>& bytes_;
    std::size_t end_, at_ = 0;
};

}  // namespace

/// Multiply-and-fold over 8-byte words: finds every truncation and flipped bit that a disk makes, at memory
/// speed.
std::uint64_t packedFileHash(std::span<const std::uint8_t> bytes) {
    std::uint64_t hash = 0x9e3779b97f4a7c15ull ^ bytes.size();
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        std::uint64_t word;
        std::memcpy(&word, bytes.data() + i, 8);
        hash = std::rotl((hash ^ word) * 0xbf58476d1ce4e5b9ull, 29);
    }
    for (; i < bytes.size(); ++i) hash = std::rotl((hash ^ bytes[i]) * 0xbf58476d1ce4e5b9ull, 29);
    return hash ^ (hash >> 32);
}

std::optional<PackedFileKey> packedFileKey(const std::filesystem::path& source, std::uint64_t contentHash) {
    std::error_code error;
    PackedFileKey key;
    key.contentHash = contentHash;
    key.sourceSize = std::filesystem::file_size(source, error);
    if (error) return std::nullopt;
    key.sourceTime = std::filesystem::last_write_time(source, error).time_since_epoch().count();
    if (error) return std::nullopt;
    return key;
}

std::optional<PackedReferenceMap> loadPacked(const std::filesystem::path& file, const PackedFileKey& key) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) return std::nullopt;
    const std::streamoff size = in.tellg();
    if (size < 64 || size > (std::streamoff{1} << 31)) return std::nullopt;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
    in.seekg(0);
    if (!in.read(reinterpret_cast<char*>(bytes.data()), size)) return std::nullopt;
    const std::size_t end = bytes.size() - sizeof(std::uint64_t);
    std::uint64_t sum;
    std::memcpy(&sum, bytes.data() + end, sizeof sum);
    if (sum != packedFileHash(std::span(bytes).first(end))) return std::nullopt;

    Reader reader(bytes, end);
    if (reader.get<std::uint64_t>() != magic || reader.get<std::uint64_t>() != key.contentHash ||
        reader.get<std::uint64_t>() != key.sourceSize || reader.get<std::int64_t>() != key.sourceTime)
        return std::nullopt;
    const auto position = reader.get<glm::dvec3>();
    const auto scale = reader.get<float>();
    const auto levelCount = reader.get<std::uint32_t>();
    if (!reader.good || levelCount < 1 || levelCount > mostLevels || !std::isfinite(scale) ||
        !std::isfinite(position.x + position.y + position.z))
        return std::nullopt;
    std::vector<PackedReferenceMap::Level> levels;
    for (std::uint32_t k = 0; k < levelCount; ++k) {
        const auto faceSize = reader.get<std::uint32_t>();
        if (!reader.good || faceSize < 4 || faceSize > greatestFace || faceSize % 2 != 0) return std::nullopt;
        const std::size_t wordBytes = PackedReferenceMap::Level::wordBytes(static_cast<int>(faceSize));
        const std::size_t chromaCount = PackedReferenceMap::Level::chromaCount(static_cast<int>(faceSize));
        // No memory for what the file does not hold.
        if (wordBytes + chromaCount * sizeof(std::uint16_t) > reader.left()) return std::nullopt;
        std::vector<std::uint8_t> words(wordBytes);
        std::vector<std::uint16_t> chroma(chromaCount);
        reader.get(words.data(), words.size());
        reader.get(chroma.data(), chroma.size() * sizeof(std::uint16_t));
        levels.emplace_back(static_cast<int>(faceSize), scale, std::move(words), std::move(chroma));
    }
    if (!reader.finished()) return std::nullopt;
    return PackedReferenceMap(position, scale, std::move(levels));
}

bool savePacked(const std::filesystem::path& file, const PackedFileKey& key, const PackedReferenceMap& map) {
    Writer writer;
    writer.put(magic);
    writer.put(key.contentHash);
    writer.put(key.sourceSize);
    writer.put(key.sourceTime);
    writer.put(map.position());
    writer.put(map.radianceScale());
    writer.put(static_cast<std::uint32_t>(map.levels().size()));
    for (const PackedReferenceMap::Level& level : map.levels()) {
        writer.put(static_cast<std::uint32_t>(level.faceSize()));
        writer.put(level.words(), PackedReferenceMap::Level::wordBytes(level.faceSize()));
        writer.put(level.chroma(),
                   PackedReferenceMap::Level::chromaCount(level.faceSize()) * sizeof(std::uint16_t));
    }
    writer.put(packedFileHash(writer.bytes));

    const std::filesystem::path aside = file.parent_path() / (file.filename().string() + ".partial");
    std::error_code error;
    {
        std::ofstream out(aside, std::ios::binary);
        out.write(reinterpret_cast<const char*>(writer.bytes.data()),
                  static_cast<std::streamsize>(writer.bytes.size()));
        if (!out.flush()) {
            out.close();
            std::filesystem::remove(aside, error);
            return false;
        }
    }
    std::filesystem::rename(aside, file, error);
    if (!error) return true;
    std::filesystem::remove(aside, error);
    return false;
}

}  // namespace reflection
