#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "reflection/gl/LocalMapTextures.h"
#include "reflection/local_map/LocalMapMesh.h"

namespace app {

/// The layout of an unfolded local map: four faces round the horizon (west, north, east, south), up above and
/// down below north, each upright. Columns and rows of faces.
inline constexpr glm::ivec2 mapViewFaces{4, 3};

/// A line of the mesh, in the unfolded picture: 0..1, from its top left.
struct MapLine {
    glm::vec2 from{0};
    glm::vec2 to{0};
};

/// Where a point of a cube face lies in the unfolded picture. `s`, `t`: 0..1 as OpenGL addresses the face;
/// `face`: 0..5.
glm::vec2 unfolded(int face, double s, double t);

/// Outlines of a face's quads in the unfolded picture.
std::vector<MapLine> unfoldedMesh(int face, std::span<const reflection::LocalMapMesh::Quad> quads,
                                  int latticeSize);

/// Draws local maps unfolded into a texture to be looked at. Needs the same OpenGL context current
/// throughout.
class MapView {
  public:
    MapView();
    ~MapView();
    MapView(const MapView&) = delete;
    MapView& operator=(const MapView&) = delete;

    /// GL name of a texture (RGBA8, display values, first row at the bottom) that shows this slot's map; 0
    /// for an invalid slot.
    std::uint32_t draw(const reflection::LocalMapTextures& textures, const reflection::LocalMapSlot& slot,
                       float exposure);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
