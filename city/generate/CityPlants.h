#pragma once

#include <cstdint>
#include <vector>

#include "city/generate/Palette.h"
#include "city/model/CityModel.h"

namespace city {

class Random;

/// The things that stand in the boulevard city many times, by their index in CityModel::prototypes.
struct Standing {
    std::vector<std::uint32_t> avenueTrees, streetTrees, parkTrees;
    std::uint32_t streetLamp = 0, squareLamp = 0, signalPole = 0, bench = 0, bollard = 0, bin = 0,
                  shelter = 0, mast = 0, kiosk = 0, fountain = 0, monument = 0;
    std::vector<std::uint32_t> advertColumns;
};

/// Makes the prototypes and adds them to the model. Trees: crowns of 2.9 m (avenue), 1.9 m (street) and 3.6 m
/// (park) radius.
Standing addPrototypes(const Palette& palette, Random& random, CityModel& model);

/// Stands a prototype at `foot`, its front towards `front` (unit).
void place(CityModel& model, std::uint32_t prototype, const glm::vec3& foot, const glm::vec2& front,
           float scale = 1);
/// Stands one of the trees at `foot`, turned and scaled (by 0.9 to 1.08) at random.
void placeTree(CityModel& model, const std::vector<std::uint32_t>& trees, const glm::vec3& foot,
               Random& random);

}  // namespace city
