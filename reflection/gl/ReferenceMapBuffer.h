#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "reflection/reference_maps/PackedReferenceMap.h"

namespace reflection {

/// Where a level of a map lies in the buffer, in uints.
struct BufferedLevel {
    std::uint32_t words = 0;
    std::uint32_t chroma = 0;
};

/// Packed reference maps on the GPU, as they are in memory (2.8 bytes a texel): one buffer of equal places, a
/// map with all its levels in each. A map is uploaded when it is first asked for; where there are fewer
/// places than maps, the one asked for longest ago gives up its place.
///
/// A buffer texture of words rather than a storage block: both cost the same on llvmpipe, and 2^27 words (512
/// MiB) are commonly allowed where storage blocks may end at 128 MiB.
///
/// Uploads are ordered by the GPU behind what still reads the old content: nothing waits. Needs a current
/// GL 4.5 context in every call and at destruction.
class ReferenceMapBuffer {
  public:
    /// Room for `maps` within `budget` bytes, what the implementation allows a buffer texture, and what
    /// memory there is: one map however small the budget, none where not even that can be had. The maps must
    /// outlive this.
    ReferenceMapBuffer(std::span<const PackedReferenceMap> maps, std::size_t budget);
    ~ReferenceMapBuffer();
    ReferenceMapBuffer(const ReferenceMapBuffer&) = delete;
    ReferenceMapBuffer& operator=(const ReferenceMapBuffer&) = delete;

    /// Places there are: more different maps cannot be held at once.
    std::size_t places() const;

    /// From here on, maps asked for keep their places until the next call.
    void startBatch();

    /// Puts a map on the GPU if it is not there. False: all places hold maps of this batch. Precondition: one
    /// of the maps of the constructor.
    bool hold(const PackedReferenceMap& map);

    /// Of a map that is held. Precondition: `level` is one of its levels.
    BufferedLevel levelOf(const PackedReferenceMap& map, const PackedReferenceMap::Level& level) const;

    std::uint32_t name() const;      ///< GL name of a buffer texture of GL_R32UI
    std::size_t bytes() const;       ///< allocated on the GPU
    std::size_t heldBytes() const;   ///< of maps that are there
    std::size_t heldTexels() const;  ///< all levels
    std::size_t uploads() const;     ///< maps copied so far

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
