#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "reflection/chrome/ReflectorPieces.h"

namespace reflection {

/// Reflectors on disk, by the content of what they were made from: the part's triangles, how it was to be
/// cut, and the very code that cuts and makes maps. Little-endian; magic, the content's hash, the pieces, and
/// a hash of all before it. Files are written aside, then renamed: a reader never sees half of one, and of
/// several that write the same the last one wins.
class ReflectorStore {
  public:
    /// Makes nothing yet.
    explicit ReflectorStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

    static std::uint64_t hashOf(const city::Mesh& part, const CutOptions& options = {});
    std::filesystem::path fileOf(std::uint64_t hash) const;

    struct Loaded {
        std::optional<Reflector> reflector;
        std::string refused;  ///< one sentence on why a file that is there is of no use; empty otherwise
    };
    /// Any bytes at all are either a reflector or refused. Cost: reading a file of a megabyte a piece.
    Loaded load(std::uint64_t hash) const;
    /// Throws std::runtime_error naming file, cause and remedy.
    void save(std::uint64_t hash, const Reflector& reflector) const;

    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
};

}  // namespace reflection
