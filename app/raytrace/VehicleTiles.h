#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "app/raytrace/RayMeshes.h"
#include "app/raytrace/RayTracer.h"

namespace app {

/// The blocks of a view in which vehicles may be seen, with a pixel to spare around each.
class VehicleTiles {
  public:
    static constexpr int side = 16;  ///< pixels
    struct Tile {
        glm::ivec2 low{0}, high{0};  ///< pixels, top left origin, high excluded
    };

    VehicleTiles(const FrameScene& frame, std::span<const std::uint32_t> chosen, const RayMeshes& meshes,
                 const View& view);

    std::size_t size() const { return tiles_.size(); }
    const Tile& operator[](std::size_t i) const { return tiles_[i]; }

    /// `known` is asked of pixels within tiles alone. Pixels next to known ones take their light: where the
    /// rasteriser's outlines differ by a rounding, or a pixel is covered in part.
    void fillOutlines(MirroredLight& light, std::span<const unsigned char> known) const;

  private:
    bool covers(int x, int y) const {
        return marked_[static_cast<std::size_t>(y / side) * static_cast<std::size_t>(grid_.x) +
                       static_cast<std::size_t>(x / side)] != 0;
    }

    glm::ivec2 grid_{0};
    std::vector<unsigned char> marked_;
    std::vector<Tile> tiles_;
};

}  // namespace app
