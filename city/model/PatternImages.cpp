#include "city/model/PatternImages.h"

#include "city/model/PatternPainters.h"

namespace city {

std::array<PatternImage, static_cast<std::size_t>(Pattern::count)> paintPatterns() {
    std::array<PatternImage, static_cast<std::size_t>(Pattern::count)> images;
    const auto put = [&](Pattern pattern, PatternImage image) {
        images[static_cast<std::size_t>(pattern)] = std::move(image);
    };
    put(Pattern::plain, paintPlain());
    put(Pattern::asphalt, paintAsphalt());
    put(Pattern::pavement, paintPavement());
    put(Pattern::cobbles, paintCobbles());
    put(Pattern::grass, paintGrass());
    put(Pattern::soil, paintSoil());
    put(Pattern::water, paintWater());
    put(Pattern::roofTiles, paintRoofTiles());
    put(Pattern::roofFlat, paintRoofFlat());
    put(Pattern::facadePlaster, paintPlasterFacade());
    put(Pattern::facadeBrick, paintBrickFacade());
    put(Pattern::facadeStone, paintStoneFacade());
    put(Pattern::facadeGlass, paintGlassFacade());
    put(Pattern::wall, paintWall());
    put(Pattern::shopFront, paintShopFront());
    put(Pattern::bark, paintBark());
    put(Pattern::foliage, paintFoliage());
    put(Pattern::metal, paintMetal());
    put(Pattern::marking, paintMarking());
    put(Pattern::rail, paintRail());
    put(Pattern::stoneFront, paintStoneFront());
    return images;
}

}  // namespace city
