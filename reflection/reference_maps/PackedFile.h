#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "reflection/reference_maps/PackedReferenceMap.h"

namespace reflection {

/// A packed reference map on disk: what a program needs at its start, a tenth of the time that unpacking the
/// OpenEXR file and packing it again takes. A copy for speed only: the OpenEXR file beside it is the one that
/// counts.
///
/// Little-endian: magic and version, the hash of what the map was made from, the size and time of the OpenEXR
/// file that it was packed from, position, radiance scale, face sizes, words and chroma of each level, and a
/// hash of all before it.
struct PackedFileKey {
    std::uint64_t contentHash = 0;
    std::uint64_t sourceSize = 0;  ///< bytes of the OpenEXR file
    std::int64_t sourceTime = 0;   ///< its last change, in the file clock's ticks
};

/// The key of a map whose OpenEXR file is `source`; nullopt when there is no such file.
std::optional<PackedFileKey> packedFileKey(const std::filesystem::path& source, std::uint64_t contentHash);

/// The hash that ends a file, of all bytes before it.
std::uint64_t packedFileHash(std::span<const std::uint8_t> bytes);

/// Nothing when the file is absent, damaged or belongs to another key. Never throws for a bad file.
std::optional<PackedReferenceMap> loadPacked(const std::filesystem::path& file, const PackedFileKey& key);

/// Written aside, then renamed. A copy for speed: returns false, and leaves nothing, when it cannot be
/// written.
bool savePacked(const std::filesystem::path& file, const PackedFileKey& key, const PackedReferenceMap& map);

}  // namespace reflection
