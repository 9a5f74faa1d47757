#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reflection/reference_maps/ReferenceMap.h"

namespace reflection {

/// Reference maps on disk: one OpenEXR file a map with the standard `envmap` cube attribute, channels R G B
/// (half) and Z (float distance, +infinity for sky), its position, the hash of what it was made from and a
/// checksum. Faces are oriented as OpenEXR's CubeMap asks; texel centres lie half a texel inside the face's
/// edges, as in OpenGL.
///
/// A file appears whole or not at all (written aside, then renamed), so a killed bake leaves only good files
/// and the next one finishes the rest. The bytes of a file depend on its map alone.
class ReferenceMapStore {
  public:
    /// `contentHash`: of everything the maps' pictures depend on; a file made from something else is not
    /// taken. The folder is made when the first map is saved.
    ReferenceMapStore(std::filesystem::path folder, std::uint64_t contentHash);

    struct Loaded {
        std::optional<ReferenceMap> map;
        std::string damage;  ///< why a file that is there cannot be used; empty if it is good or absent
    };
    /// Never throws for a bad file: says what is wrong with it, so that it can be rebuilt.
    Loaded load(std::size_t index) const;

    /// Throws std::runtime_error (file, cause, remedy) when the folder or file cannot be written.
    void save(std::size_t index, const ReferenceMap& map) const;

    /// The positions of the placed maps, so that a second start need not place again; nullopt when absent or
    /// damaged.
    struct Plan {
        std::vector<glm::dvec3> positions;
        double coverage = 0;
    };
    std::optional<Plan> loadPlan() const;
    /// Throws std::runtime_error (file, cause, remedy) when it cannot be written.
    void savePlan(const Plan& plan) const;
    std::filesystem::path planFile() const;

    std::filesystem::path file(std::size_t index) const;
    /// Where the packed copy of a map lies (see PackedFile).
    std::filesystem::path packedFile(std::size_t index) const;
    std::uint64_t contentHash() const { return contentHash_; }
    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
    std::uint64_t contentHash_;
};

}  // namespace reflection
