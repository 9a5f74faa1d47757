#include "city/generate/StreetFurnishing.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

// Metres from the kerb, on the pavement.
constexpr float lampRow = 0.7f;
constexpr float avenueTreeRow = 3.3f;  // crowns of 2.9 m, scaled up to 1.08, stay behind the kerb
constexpr float streetTreeRow = 2.25f;
constexpr float squareOpening = 9;  // metres to each side of its middle
constexpr float cornerClearance =
    7;  // metres beyond the crossing street's houses that stay free for sight and crossings

/// A street side: s along, d from the kerb onto the pavement.
struct SideFrame {
    glm::vec2 start, along, away;  ///< away: from the carriageway
    float length;
    float kerb;  ///< axis to kerb
    glm::vec3 at(float s, float d, float z = pavementHeight) const {
        return {start + s * along + (kerb + d) * away, z};
    }
};

void addTreePit(const SideFrame& side, float s, float d, const Palette& palette, ChunkCollector& chunks) {
    constexpr float half = 0.65f, lift = 0.012f;
    const glm::vec3 c = side.at(s, d);
    const glm::vec2 u = half * side.along, v = half * glm::vec2(-side.along.y, side.along.x), p(c);
    addDeck(chunks.at(ChunkKind::ground, p.x, p.y), std::array{p - u - v, p + u - v, p + u + v, p - u + v},
            pavementHeight + lift, palette.soil, 2);
}

void furnishAvenueSide(const SideFrame& side, glm::vec2 square, const Palette& palette,
                       const Standing& standing, Random& random, CityModel& model, ChunkCollector& chunks) {
    constexpr float treeStep = 9.5f;
    const int trees = static_cast<int>(side.length / treeStep);
    const float step = side.length / static_cast<float>(std::max(trees, 1));
    const int shelterAt = trees > 6 ? trees / 2 : -1;
    for (int k = 0; k < trees; ++k) {
        const float s = (static_cast<float>(k) + 0.5f) * step;
        // The square opens towards the avenue.
        const glm::vec2 spot(side.at(s, avenueTreeRow));
        if (spot.y > 0 && std::abs(spot.x - square.x) < squareOpening) continue;
        placeTree(model, standing.avenueTrees, {spot, pavementHeight}, random);
        addTreePit(side, s, avenueTreeRow, palette, chunks);
        const float between = s + 0.5f * step;
        if (k + 1 == trees) break;
        if (k == shelterAt) {
            place(model, standing.shelter, side.at(between, 2.1f), -side.away);
        } else if (k % 3 == 0) {
            place(model, standing.streetLamp, side.at(between, lampRow), -side.away);
            if (random.chance(0.5))
                place(model, standing.bin, side.at(between + 1, lampRow + 0.1f), -side.away);
        } else if (k % 3 == 1) {
            place(model, standing.bench, side.at(between, avenueTreeRow), side.away);
        } else if (random.chance(0.2)) {
            place(model, standing.advertColumns[random.index(standing.advertColumns.size())],
                  side.at(between, avenueTreeRow), side.away);
        }
    }
    for (const float s : {0.5f, side.length - 0.5f}) {
        for (int k = 0; k < 4; ++k) {
            const float shift = 1.6f * static_cast<float>(k) * (s < 1 ? -1.0f : 1.0f);
            place(model, standing.bollard, side.at(s + shift, 0.45f), -side.away);
        }
    }
}

void furnishStreetSide(const SideFrame& side, bool trees, bool lamps, const Palette& palette,
                       const Standing& standing, Random& random, CityModel& model, ChunkCollector& chunks) {
    if (trees) {
        const int count = static_cast<int>(side.length / 10.5f);
        const float step = side.length / static_cast<float>(std::max(count, 1));
        for (int k = 0; k < count; ++k) {
            const float s = (static_cast<float>(k) + 0.5f) * step;
            placeTree(model, standing.streetTrees, side.at(s, streetTreeRow), random);
            addTreePit(side, s, streetTreeRow, palette, chunks);
        }
    }
    if (lamps) {
        const int count = std::max(1, static_cast<int>(side.length / 27));
        const float step = side.length / static_cast<float>(count);
        for (int k = 0; k < count; ++k)
            place(model, standing.streetLamp, side.at((static_cast<float>(k) + 0.5f) * step + 2.5f, lampRow),
                  -side.away);
    }
    constexpr float bollardStep = 4;
    for (int k = 0; k < static_cast<int>((side.length - 3) / bollardStep); ++k) {
        const float s = 3 + bollardStep * static_cast<float>(k);
        if (!trees && random.chance(0.2)) place(model, standing.bollard, side.at(s, 0.4f), -side.away);
    }
}

}  // namespace

void furnishStreets(const BoulevardPlan& plan, const Palette& palette, const Standing& standing,
                    Random& random, CityModel& model, ChunkCollector& chunks) {
    for (const BoulevardPlan::Street& street : plan.streets) {
        const glm::vec2 whole = street.to - street.from;
        const float length = glm::length(whole);
        const glm::vec2 along = whole / length;
        const float from = street.trimFrom + cornerClearance, to = length - street.trimTo - cornerClearance;
        if (to - from < 8) continue;
        for (const float hand : {1.0f, -1.0f}) {
            SideFrame side;
            side.start = street.from + from * along;
            side.along = along;
            side.away = hand * glm::vec2(-along.y, along.x);
            side.length = to - from;
            side.kerb = kerbLine(street.rank);
            if (street.rank == StreetRank::avenue) {
                furnishAvenueSide(side, plan.square, palette, standing, random, model, chunks);
            } else {
                const bool trees = street.rank == StreetRank::street && hand < 0;
                const bool lamps = hand > 0 || street.rank == StreetRank::tramStreet;
                furnishStreetSide(side, trees, lamps, palette, standing, random, model, chunks);
            }
        }
        if (street.rank == StreetRank::avenue || street.rank == StreetRank::tramStreet) {
            const int masts = std::max(1, static_cast<int>((to - from) / 30));
            const float step = (to - from) / static_cast<float>(masts);
            for (int k = 0; k < masts; ++k) {
                const glm::vec2 p = street.from + (from + (static_cast<float>(k) + 0.5f) * step) * along;
                place(model, standing.mast, {p, 0}, along);
            }
        }
    }
}

}  // namespace city
