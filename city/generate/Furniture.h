#pragma once

#include <glm/mat4x4.hpp>

#include "city/generate/Palette.h"
#include "city/model/CityModel.h"

namespace city {

/// Street furniture, each a prototype with its foot at the origin and, where it has a front, its front
/// towards +x. None is thick enough to be a column of the heightfield, the kiosk, shelter and fountain apart.
Prototype makeStreetLamp(const Palette& palette);  ///< 7.5 m, arm over the road towards +x
Prototype makeSquareLamp(const Palette& palette);  ///< 4 m, lantern on a post
Prototype makeSignalPole(const Palette& palette);  ///< 3.3 m, with a dark backing board that faces +x
Prototype makeBench(const Palette& palette);
Prototype makeBollard(const Palette& palette);
Prototype makeLitterBin(const Palette& palette);
Prototype makeTramShelter(const Palette& palette);   ///< 9 m along y, open towards +x
Prototype makeCatenaryMast(const Palette& palette);  ///< 6.6 m, arms both ways along y
Prototype makeAdvertColumn(const Palette& palette, std::size_t poster);
Prototype makeKiosk(const Palette& palette);
Prototype makeFountain(const Palette& palette);  ///< basin of 7 m radius, two bowls
Prototype makeMonument(const Palette& palette);  ///< column with a figure, 17 m

/// Moves a prototype's foot to `foot` and turns its +x to the unit horizontal direction `front`.
glm::mat4 standing(const glm::vec3& foot, const glm::vec2& front, float scale = 1);

}  // namespace city
