#pragma once

#include "city/model/PatternImages.h"

namespace city {

// Fronts of houses: one repeat = one window bay wide, one storey high (shop fronts: one shop bay, ground
// floor high).
PatternImage paintPlasterFacade();
PatternImage paintBrickFacade();
PatternImage paintStoneFacade();
PatternImage paintGlassFacade();
PatternImage paintShopFront();
PatternImage paintStoneFront();

// What one walks and drives on, and roofs.
PatternImage paintAsphalt();
PatternImage paintPavement();
PatternImage paintCobbles();
PatternImage paintGrass();
PatternImage paintSoil();
PatternImage paintWater();
PatternImage paintRoofTiles();
PatternImage paintRoofFlat();
PatternImage paintMarking();
PatternImage paintRail();

// Stuff.
PatternImage paintPlain();
PatternImage paintWall();
PatternImage paintBark();
PatternImage paintFoliage();
PatternImage paintMetal();

}  // namespace city
