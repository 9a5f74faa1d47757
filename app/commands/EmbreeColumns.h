#pragma once

#include <memory>
#include <span>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"

namespace app {

/// A heightfield's columns as boxes of quads in an Embree scene: neighbouring cells of equal height share a
/// box. For comparison in `bench tracer`. Single-threaded queries. Throws std::runtime_error when Embree
/// cannot make the scene.
class EmbreeColumns {
  public:
    EmbreeColumns(const city::Heightfield& field, bool robust);
    ~EmbreeColumns();
    EmbreeColumns(EmbreeColumns&&) noexcept;
    EmbreeColumns& operator=(EmbreeColumns&&) noexcept;

    /// Ray parameter of the first hit, +infinity on a miss.
    void single(std::span<const city::Ray> rays, std::span<float> t) const;
    /// Sixteen coherent rays at a time.
    void packets(std::span<const city::Ray> rays, std::span<float> t) const;

  private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
};

}  // namespace app
