#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "city/import/OsmData.h"

namespace city {

/// What a building is, as far as its height and face depend on it.
enum class BuildingKind : std::uint8_t { block, house, office, civic, church, industrial, small, canopy };

/// From the value of `building` (or `building:part`) and the area on the ground, square metres.
BuildingKind buildingKind(const OsmTags& tags, double groundArea);

/// Metres from floor to floor.
double storeyHeight(BuildingKind kind);

/// Heights in metres above ground, as tagged; what is absent or absurd (negative, over a kilometre) is
/// nullopt.
struct TaggedHeights {
    std::optional<double> top;   ///< `height`, or from the levels
    std::optional<double> base;  ///< `min_height`, or from `building:min_level`
    std::optional<double> roof;  ///< `roof:height`, or from `roof:levels`: the part of `top` above the eaves
};
TaggedHeights taggedHeights(const OsmTags& tags, BuildingKind kind);

/// Guesses the heights that the file does not tell: the median of the nearest known ones of the same kind,
/// because neighbours were built under the same rules; without enough neighbours, what is usual for the kind.
class HeightGuess {
  public:
    void addKnown(glm::vec2 position, BuildingKind kind, double height);
    double guess(glm::vec2 position, BuildingKind kind) const;  ///< cost: linear in the known ones

  private:
    struct Known {
        glm::vec2 position;
        BuildingKind kind;
        double height;
    };
    std::vector<Known> known_;
};

}  // namespace city
