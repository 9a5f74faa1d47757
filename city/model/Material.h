#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace city {

/// What a surface is made of; each names one tileable picture (see PatternImages). A texture coordinate of 1
/// is one repeat of the picture; `Material::patternSize` says how many metres that is where the mesh maker
/// has a choice.
enum class Pattern : std::uint8_t {
    plain,
    asphalt,
    pavement,
    cobbles,
    grass,
    soil,
    water,
    roofTiles,
    roofFlat,
    facadePlaster,  ///< one repeat: one window bay wide, one storey high
    facadeBrick,
    facadeStone,
    facadeGlass,
    wall,       ///< windowless plaster
    shopFront,  ///< one repeat: one shop bay, ground floor high
    bark,
    foliage,
    metal,
    marking,
    rail,
    stoneFront,  ///< a shop front on a base of polished granite, its panes partly frosted
    count
};

/// A diffuse (view-independent) surface of the static city: its colour must not depend on the viewer, so that
/// what a reference map saw is what a car sees.
struct Material {
    Pattern pattern = Pattern::plain;
    glm::vec3 tint{0.8f};   ///< linear RGB albedo, multiplied with the pattern
    float patternSize = 1;  ///< metres per repeat
    float roughness = 1;    ///< for later specular use; 1 = diffuse
    bool twoSided = false;  ///< leaf cards
    bool cutout = false;    ///< the pattern's alpha below 0.5 is open
    glm::vec3 emission{0};  ///< linear RGB radiance
};

}  // namespace city
