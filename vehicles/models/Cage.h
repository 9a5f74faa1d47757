#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "vehicles/models/Shell.h"

namespace vehicles {

/// One cross-section of a vehicle's control cage, left half. The points run from the middle of the roof or
/// bonnet to the edge of the floor; the names say what the line through all stations becomes on a car.
struct Station {
    glm::vec2 centre{0};    ///< x and z on the plane of symmetry
    glm::vec3 rail{0};      ///< edge of the roof, pillars, edge of the bonnet
    glm::vec3 belt{0};      ///< lower edge of the side windows
    glm::vec3 shoulder{0};  ///< character line
    glm::vec3 waist{0};     ///< widest line of the doors
    glm::vec3 rocker{0};    ///< lower edge of the doors
    glm::vec3 sill{0};      ///< edge of the floor
};

/// A straight run of cage edges that the subdivision keeps sharper than the rest. Lattice coordinates:
/// station, column (0 the middle, 3 the rail and the side), level (0 the top, 1 belt ... 5 sill). Applies to
/// both sides.
struct Crease {
    std::array<int, 3> from{}, to{};
    float sharpness = 1;  ///< subdivision steps for which the edge stays sharp; 10 and more: a true edge
};

/// A vehicle body as a box-shaped lattice of quadrilaterals, bent into shape: stations from the front to the
/// rear, joined by a front and a rear face. Vehicle frame, metres.
struct Cage {
    static constexpr int columns = 3;        ///< from the middle to the rail
    static constexpr int levels = 5;         ///< from the rail to the sill
    std::vector<Station> stations;           ///< front first, at least three
    std::array<float, levels + 1> frontX{};  ///< x of the front face's middle at each level; [0] is not used
    std::array<float, levels + 1> rearX{};
    std::vector<Crease> creases;
};

/// The box into which the limit surface is stretched, so that the cage need not allow for what subdivision
/// rounds off.
struct Extent {
    float rear = 0, front = 0;  ///< x
    float width = 0;            ///< symmetric about y = 0
    float floor = 0, top = 0;   ///< z
};

/// The Catmull-Clark limit surface of the cage, sampled after `depth` subdivisions: positions and normals of
/// the limit (OpenSubdiv), the left half (y >= 0) only, all of surface paint. Linear in the number of faces,
/// 4^depth times the cage's.
Shell subdivide(const Cage& cage, const Extent& extent, int depth);

}  // namespace vehicles
