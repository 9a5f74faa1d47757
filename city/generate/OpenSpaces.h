#pragma once

#include "city/generate/ChunkCollector.h"
#include "city/generate/CityPlants.h"

namespace city {

/// Height of what lies behind the pavements: a little below them, so that the two may overlap without
/// fighting for the same depth.
inline constexpr float innerGround = 0.1f;

/// A paved square with a fountain, a monument, lawns, tree rows, benches, lamps and a kiosk. Convex ring at
/// the pavements' inner edges.
void addSquare(const std::vector<glm::vec2>& ring, const Palette& palette, const Standing& standing,
               Random& random, CityModel& model, ChunkCollector& chunks);

/// A park: lawn, hedges, gravel paths from side to side, trees and benches.
void addPark(const std::vector<glm::vec2>& ring, const Palette& palette, const Standing& standing,
             Random& random, CityModel& model, ChunkCollector& chunks);

/// The ground of a courtyard and a few trees.
void addCourt(const std::vector<glm::vec2>& ring, const Palette& palette, const Standing& standing,
              Random& random, CityModel& model, ChunkCollector& chunks);

/// The ground under a block's houses, drawn out a little under the pavement, so that no gap shows.
void addBlockGround(const std::vector<glm::vec2>& ring, std::uint32_t material, const Palette& palette,
                    ChunkCollector& chunks);

/// Meadows and hills around the city, out to 2.6 km: the horizon.
void addSurroundings(float half, const Palette& palette, Random& random, std::vector<Chunk>& chunks);

}  // namespace city
