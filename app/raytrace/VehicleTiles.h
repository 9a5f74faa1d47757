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

    bool covers(int x, int y) const {
        return marked_[static_cast<std::size_t>(y / side) * static_cast<std::size_t>(grid_.x) +
                       static_cast<std::size_t>(x / side)] != 0;
    }

  private:
    glm::ivec2 grid_{0};
    std::vector<unsigned char> marked_;
    std::vector<Tile> tiles_;
};

/// Pixels within [low, high) that are next to known ones take the mean of their light: where the rasteriser's
/// outlines differ by a rounding, or a pixel is covered in part. Only pixels that are not known are written,
/// and only known ones for which `covered` holds are read.
template <class Covered>
void fillOutlines(MirroredLight& light, std::span<const unsigned char> known, const glm::ivec2& low,
                  const glm::ivec2& high, Covered covered) {
    const auto index = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(light.size.x) +
               static_cast<std::size_t>(x);
    };
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
            if (known[index(x, y)] != 0) continue;
            glm::vec3 sum(0);
            float count = 0;
            for (int k = 0; k < 9; ++k) {
                const int nx = x + k % 3 - 1, ny = y + k / 3 - 1;
                if (nx < 0 || ny < 0 || nx >= light.size.x || ny >= light.size.y || !covered(nx, ny) ||
                    known[index(nx, ny)] == 0)
                    continue;
                sum += light.radiance[index(nx, ny)];
                ++count;
            }
            if (count > 0) light.radiance[index(x, y)] = sum / count;
        }
}

}  // namespace app
