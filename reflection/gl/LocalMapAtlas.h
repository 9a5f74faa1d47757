#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>

#include "reflection/gl/LocalMapTextures.h"
#include "reflection/gl/SceneDrawer.h"
#include "reflection/local_map/LocalMapSlot.h"
#include "reflection/local_map/PackedMips.h"

namespace reflection {

/// Local maps on the GPU: a cube map array of R11F_G11F_B10F with all mipmaps for each size class, and one of
/// nearness (LocalMapTextures) where parallax is wanted, grown on demand. Needs a current GL 4.5 context in
/// every call and at destruction.
class LocalMapAtlas {
  public:
    LocalMapAtlas();
    ~LocalMapAtlas();
    LocalMapAtlas(LocalMapAtlas&&) noexcept;
    LocalMapAtlas& operator=(LocalMapAtlas&&) noexcept;

    /// From now on keeps nearness as well, 2 bytes a texel; that of maps which are there already is
    /// undefined.
    void keepNearness();
    bool keepsNearness() const;

    /// Makes room for layers 0 .. layers-1 of a class; contents of layers that were there stay. GL names may
    /// change.
    void reserve(int sizeClass, int layers);

    /// Replaces a map. The slot must be reserved and the mips' face size that of its class. Nearness travels
    /// where it is kept.
    void upload(LocalMapSlot slot, const PackedMips& mips);

    /// Where the map of a slot was made, world metres: for parallax.
    void setCentre(LocalMapSlot slot, const glm::dvec3& centre);

    /// Reads a map back, all levels. Waits for the GPU: for tests and measurements.
    void download(LocalMapSlot slot, PackedMips& mips) const;

    /// Where SceneDrawer::drawCube may draw a map; call `finishDrawn` afterwards to make its mipmaps.
    CubeTarget target(LocalMapSlot slot) const;
    void finishDrawn(LocalMapSlot slot);

    LocalMapTextures textures() const;
    /// GL name of the same texels as a GL_R32UI cube map array, for shaders that write them whole; 0 where
    /// the class is empty.
    std::uint32_t wordArray(int sizeClass) const;
    /// GL name of a class's nearness, GL_R16F; 0 where it is not kept or the class is empty.
    std::uint32_t nearnessArray(int sizeClass) const;
    std::size_t bytes() const;  ///< on the GPU, mipmaps included

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
