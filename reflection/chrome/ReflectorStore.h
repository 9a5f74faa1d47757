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
///
/// The folder is held within a size: what is saved makes room by removing the files that were least recently
/// loaded or saved, as files' times tell, never itself; and what an interrupted program left aside, after a
/// day. Several programs may use one folder: what another removes first is gone just as well, and a reader
/// either has a file open, and reads it to its end, or makes the reflector anew.
class ReflectorStore {
  public:
    /// Some hundred vehicles' chrome: a reflector takes half a megabyte a piece.
    static constexpr std::uintmax_t defaultMostBytes = std::uintmax_t{256} << 20;

    /// Makes nothing yet.
    explicit ReflectorStore(std::filesystem::path folder, std::uintmax_t mostBytes = defaultMostBytes)
        : folder_(std::move(folder)), mostBytes_(mostBytes) {}

    static std::uint64_t hashOf(const city::Mesh& part, const CutOptions& options = {});
    std::filesystem::path fileOf(std::uint64_t hash) const;

    struct Loaded {
        std::optional<Reflector> reflector;
        std::string refused;  ///< one sentence on why a file that is there is of no use; empty otherwise
    };
    /// Any bytes at all are either a reflector or refused. What is loaded counts as used now. Cost: reading a
    /// file of a megabyte a piece.
    Loaded load(std::uint64_t hash) const;
    /// Throws std::runtime_error naming file, cause and remedy.
    void save(std::uint64_t hash, const Reflector& reflector) const;

    const std::filesystem::path& folder() const { return folder_; }

  private:
    void makeRoom(const std::filesystem::path& saved) const;

    std::filesystem::path folder_;
    std::uintmax_t mostBytes_;
};

}  // namespace reflection
