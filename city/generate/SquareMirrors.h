#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "city/generate/ChunkCollector.h"
#include "city/generate/Palette.h"
#include "city/model/CityModel.h"

namespace city {

class Random;

/// Stands a chrome sphere and a pillar of chrome or polished black granite on the square, each on a plinth, on opposite
/// sides of its walk where it opens towards the avenue: clear of what is placed in `model` already, of the
/// square's border, and of the eye of `tour`. Plinths lie on whole metres, as the heightfield's cells do.
/// What finds no place is left out.
/// `ring`: the square's border, convex, counter-clockwise.
void addSquareMirrors(const std::vector<glm::vec2>& ring, std::span<const TourStop> tour,
                      const Palette& palette, Random& random, CityModel& model, ChunkCollector& chunks);

}  // namespace city
