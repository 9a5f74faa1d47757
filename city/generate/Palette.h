#pragma once

#include <cstdint>
#include <vector>

#include "city/model/Material.h"
#include "city/roads/StreetSurfaces.h"

namespace city {

class Random;

/// One way to dress a house: indices into the material table.
struct FacadeStyle {
    std::uint32_t facade = 0;  ///< windowed storeys; one repeat = one bay by one storey
    std::uint32_t blank = 0;   ///< windowless wall of the same colour
    std::uint32_t trim = 0;    ///< cornices, sills, balconies
    bool glass = false;        ///< modern: flat roof, no ornament
};

/// The material table of a generated city with the names its parts go by. Albedos are linear RGB, from
/// measured ranges: asphalt 0.08-0.12, plaster 0.5-0.7, brick 0.2-0.35, grass 0.1-0.2, foliage 0.08-0.15.
struct Palette {
    std::vector<Material> materials;

    StreetMaterials streets;
    std::uint32_t grass = 0, meadow = 0, soil = 0, water = 0, cobbles = 0, slabs = 0, gravel = 0, hills = 0;
    std::uint32_t bark = 0, foliageBright = 0, foliageDark = 0, foliageWarm = 0, foliageShade = 0;
    std::uint32_t metalDark = 0, metalLight = 0, wood = 0, granite = 0, bronze = 0, copper = 0, lampGlass = 0;
    std::uint32_t roofFlat = 0, zinc = 0;
    std::uint32_t shelterGlass = 0;
    std::vector<std::uint32_t> roofTiles;
    std::vector<FacadeStyle> facades;  ///< old styles first: plaster, brick, stone
    std::size_t firstGlassFacade = 0;  ///< facades from here on are modern
    std::vector<std::uint32_t> shops;
    std::vector<std::uint32_t> stoneShops;  ///< some shops are of these instead; may be empty
    std::vector<std::uint32_t> awnings;
    std::vector<std::uint32_t> signs;

    const FacadeStyle& oldFacade(Random& random) const;
    const FacadeStyle& glassFacade(Random& random) const;
    /// Metres per repeat of a material's pattern.
    float repeat(std::uint32_t material) const { return materials[material].patternSize; }
};

/// The palette of built-in cities; always the same.
Palette makePalette();

/// Adds shop fronts with polished stone and frosted glass.
void addStoneShops(Palette& palette);

}  // namespace city
