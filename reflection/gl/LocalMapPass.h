#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "reflection/gl/LocalMapAtlas.h"
#include "reflection/local_map/LocalMapBuilder.h"
#include "reflection/local_map/LocalMapSlot.h"
#include "reflection/local_map/MovingObjects.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// A local map to build on the GPU.
struct LocalMapJob {
    LocalMapSlot slot;        ///< reserved in the atlas
    LocalMapRequest request;  ///< of the method `mem`; the slot's face size
    std::span<const MovingObject> objects;
};

/// Local maps made by the GPU from reference maps that live there: what LocalMapBuilder, drawMovingObjects
/// and packMips do with LocalMapMethod::mem, one invocation a texel. The processor traces the mesh's rays and
/// draws moving objects into boxes of texels of their own, with depth; the GPU starts from the mesh's
/// reciprocals, looks colours up as lookUpRefined does, puts objects before them by depth, and makes all
/// mipmap levels.
///
/// For a frame: one dispatch for each face size in use, and for those of 16 texels and more one of a group a
/// face for the coarse levels. Nothing is read back and nothing waited for. What travels each frame is 4
/// bytes a texel (the reciprocals), 16 bytes a texel of the objects' boxes, and 64 bytes a face. The
/// reciprocals rather than the mesh's quads: quads of 28 bytes stand for some 50 texels, so that they would
/// save most of the 4 bytes and the 0.7 ns a texel of filling in (measured); but a frame's 80,000 texels are
/// 0.3 MB and 0.06 ms of one core, half of what tracing their rays takes, and looking for each texel's quad,
/// or drawing quads into a target of their own with a barrier behind it, would tie the shader to the form of
/// the mesh.
///
/// Colours are those of lookUpRefined but for the rounding of its arithmetic.
///
/// Needs a current GL 4.5 context in every call and at destruction.
class LocalMapPass {
  public:
    /// Room for all of `maps`, or as many as `budget` bytes hold: see ReferenceMapBuffer. The maps must
    /// outlive this. Throws std::runtime_error when the shaders are missing or do not compile.
    LocalMapPass(std::span<const PackedReferenceMap> maps, std::size_t budget);
    ~LocalMapPass();
    LocalMapPass(const LocalMapPass&) = delete;
    LocalMapPass& operator=(const LocalMapPass&) = delete;

    /// False where there is no room on the GPU for even one of the reference maps: build local maps
    /// on the processor then.
    bool usable() const;

    /// Builds all maps. Where they ask for more reference maps than fit, in several batches, each once its
    /// maps are there; candidates beyond the places there are (the last) are left out. Returns the rays
    /// traced.
    std::uint64_t build(const GridTracer& tracer, std::span<const LocalMapJob> jobs,
                        const LocalMapAtlas& atlas);

    /// Call when skies that requests named (LookupOptions::sky) have changed or are gone: they are copied
    /// once.
    void forgetSkies();

    std::size_t bytes() const;         ///< allocated on the GPU for reference maps
    std::size_t skyBytes() const;      ///< and for skies
    double bytesPerTexel() const;      ///< of those there now; 0 when there are none
    std::size_t mapsUploaded() const;  ///< so far
    std::uint32_t dispatches() const;  ///< of the last build

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
