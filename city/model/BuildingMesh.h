#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "city/geometry/Mesh.h"

namespace city {

/// A polygon with holes, world metres; rings are not closed (the last point is not the first), any
/// orientation.
struct Footprint {
    std::vector<glm::vec2> outer;
    std::vector<std::vector<glm::vec2>> holes;
};

enum class RoofShape : std::uint8_t { flat, gabled, hipped, pyramidal, dome };

/// A prismatic building or part of one.
struct BuildingShape {
    Footprint footprint;
    float base = 0;    ///< metres, world z of the walls' foot (above ground for parts with min_height)
    float eaves = 12;  ///< world z where the walls end
    float ridge = 12;  ///< world z of the roof's top; equal to eaves for flat roofs
    RoofShape roof = RoofShape::flat;
    float storeyHeight = 3.2f;    ///< metres; facade texture coordinates count storeys upwards
    float bayWidth = 3.0f;        ///< metres; rounded per wall so that whole bays fit
    float groundFloorHeight = 0;  ///< metres of wall above base that take `groundFloorMaterial`; 0: none
    float roofPatternSize = 2;    ///< metres per repeat of the roof's pattern
    std::uint32_t wallMaterial = 0;
    std::uint32_t groundFloorMaterial = 0;
    std::uint32_t roofMaterial = 0;
};

enum class BuildStatus : std::uint8_t {
    built,
    repaired,    ///< the footprint crossed itself and was mended
    degenerate,  ///< fewer than three distinct corners, no area, or a non-finite number: nothing added
};

/// Appends walls (outward normals; courtyards' walls face the court) and roof, flat-shaded and closed but for
/// the floor. Gabled, hipped and pyramidal roofs are built on quadrilateral-like footprints (without holes,
/// filling most of their oriented bounding rectangle, whose longer axis the ridge follows), domes on
/// footprints that can be seen whole from their middle; all fall back to flat, at the eaves, elsewhere.
/// Texture coordinates: along walls, u counts bays, a whole number from corner to corner (corners that turn
/// by less than 25 degrees belong to one curved wall; walls under a metre get a strip of blank pier); v
/// counts storeys, a whole number from the ground floor's top to the eaves. The ground floor's v runs from 0
/// to 1. Gables above the eaves are blank. Cost: O(n log n) in corners, about 30 microseconds for a plain
/// house.
BuildStatus appendBuilding(const BuildingShape& shape, Mesh& mesh);

/// Triangles of a footprint, as corner triples, counter-clockwise seen from above; empty when degenerate.
std::vector<glm::vec2> triangulate(const Footprint& footprint);

}  // namespace city
