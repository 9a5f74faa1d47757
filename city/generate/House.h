#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "city/generate/Palette.h"
#include "city/geometry/Mesh.h"

namespace city {

class Random;

enum class Side : std::uint8_t {
    street,  ///< main front: shops, ornament
    court,   ///< windows without ornament
    party,   ///< shared with a neighbour: windowless, drawn only above the neighbour
};

/// Ground on which a house stands: a convex counter-clockwise ring, side i from corner i to corner i + 1.
struct Lot {
    struct Corner {
        glm::vec2 position{0};
        Side side = Side::street;  ///< of the side that starts here
        float hiddenBelow = 0;     ///< party sides: world z up to which the neighbour covers the wall
    };
    std::vector<Corner> corners;

    glm::vec2 centre() const;
    float length(std::size_t side) const;
};

enum class HouseRoof : std::uint8_t {
    flat,     ///< behind a parapet
    gabled,   ///< ridge along side 0; four corners needed
    mansard,  ///< steep below, shallow above; ridge along side 0 with four corners, all round otherwise
    tent,     ///< all sides up to a point
};

struct HouseDesign {
    FacadeStyle style;
    std::uint32_t roofMaterial = 0;
    std::uint32_t shop = 0;  ///< material of the street side's ground floor
    bool shops = false;      ///< shop fronts; otherwise a plinth and windows
    bool awnings = false;
    bool balconies = false;
    bool bayWindow = false;
    bool cornice = true;
    bool dormers = false;
    int storeys = 5;                 ///< with the ground floor
    float storeyHeight = 3.2f;       ///< metres
    float groundFloorHeight = 4.2f;  ///< metres
    float bayWidth = 3;              ///< metres, rounded so that whole bays fit
    HouseRoof roof = HouseRoof::gabled;
    float roofHeight = 4;  ///< metres above the eaves

    float eaves() const { return groundFloorHeight + static_cast<float>(storeys - 1) * storeyHeight; }
};

/// What is solid down to the ground, and what juts out over the pavement (cornices, balconies, awnings): the
/// latter must not become columns of the heightfield.
struct HouseMeshes {
    Mesh solid;
    Mesh details;
};

/// Appends the house on its lot; walls stand on `base` (world z). Lots with fewer than three corners add
/// nothing.
void appendHouse(const Lot& lot, const HouseDesign& design, const Palette& palette, float base,
                 Random& random, HouseMeshes& meshes);

}  // namespace city
