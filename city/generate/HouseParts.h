#pragma once

#include "city/generate/House.h"

namespace city {

/// Parapet walls with an inside, and the deck behind them.
void appendParapet(const Lot& lot, const HouseDesign& design, const Palette& palette, float eaves,
                   float height, Mesh& mesh);

/// Pitched roofs, with gable walls where the ridge meets a party side.
void appendRoof(const Lot& lot, const HouseDesign& design, float eaves, Mesh& mesh);

/// What a street side shows beyond its wall: cornice, plinth and door or shop signs and awnings, balconies,
/// bay windows, dormers.
void appendFrontDetails(const Lot& lot, std::size_t side, const HouseDesign& design, const Palette& palette,
                        float base, Random& random, HouseMeshes& meshes);

/// A chimney that pierces the roof from `z0` to `z1`; ten triangles.
void appendChimney(glm::vec2 centre, glm::vec2 along, float z0, float z1, std::uint32_t material, Mesh& mesh);

}  // namespace city
