#include "city/import/OsmFacades.h"

#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "city/import/OsmValues.h"

namespace city {

namespace {

using Colours = std::span<const std::string_view>;

// Colours as painters name them: sRGB.
constexpr std::array<std::string_view, 10> plasterColours{"#e6d6a6", "#d8b980", "#e0c2b0", "#cfcdc6",
                                                          "#e8e4da", "#c4cdb8", "#d8c8a8", "#d6ab8e",
                                                          "#bcc5ca", "#dcc9a0"};
// The brick picture is reddish itself.
constexpr std::array<std::string_view, 6> brickColours{"#bcaa9e", "#ad958b", "#cec2ad",
                                                       "#c4a295", "#b59384", "#c9b39c"};
constexpr std::array<std::string_view, 7> stoneColours{"#b9b1a5", "#a59e95", "#c8bead", "#94908b",
                                                       "#b59a88", "#d0c8bb", "#a8a49c"};
constexpr std::array<std::string_view, 4> glassColours{"#a4b4bb", "#93a3a8", "#b2bcbc", "#9aaab5"};
constexpr std::array<std::string_view, 4> plainColours{"#b8b4aa", "#a09a90", "#c9bfa8", "#8f8c86"};
constexpr std::array<std::string_view, 5> tileColours{"#9a5a44", "#84503f", "#a8674c", "#6d6a68", "#7a4a3c"};
constexpr std::array<std::string_view, 5> flatRoofColours{"#5c5d5f", "#6c6c6a", "#4e5052", "#77756f",
                                                          "#63605a"};
constexpr std::array<std::string_view, 5> shopColours{"#d8d4cc", "#b9b3a8", "#8d8a86", "#c6b9a2", "#a3a9ac"};

glm::vec3 draw(Colours colours, std::uint64_t hash, std::uint32_t number) {
    const auto index = static_cast<std::size_t>(uniform(hash, number) * static_cast<double>(colours.size()));
    return parseColour(colours[index]).value_or(glm::vec3(0.5f));
}

/// Tags name a colour as one calls it ("red"), not as it is painted: walls are paler and never reflect all
/// light.
glm::vec3 asPainted(glm::vec3 named, Pattern pattern) {
    const float grey = glm::dot(named, glm::vec3(0.2126f, 0.7152f, 0.0722f));
    glm::vec3 painted = glm::mix(named, glm::vec3(grey), 0.4f);
    if (pattern == Pattern::facadeBrick) painted /= glm::vec3(0.635f, 0.536f, 0.486f);  // the picture's mean
    return glm::clamp(painted, 0.03f, 0.75f);
}

std::string_view either(const OsmTags& tags, const OsmTags& outline, std::string_view key) {
    const std::string_view own = tags.get(key);
    return own.empty() ? outline.get(key) : own;
}

std::optional<Pattern> taggedPattern(std::string_view material) {
    if (material == "brick" || material == "bricks") return Pattern::facadeBrick;
    if (material == "stone" || material == "granite" || material == "sandstone" || material == "limestone" ||
        material == "marble" || material == "concrete")
        return Pattern::facadeStone;
    if (material == "glass" || material == "mirror") return Pattern::facadeGlass;
    if (material == "plaster" || material == "stucco" || material == "render" || material == "wood")
        return Pattern::facadePlaster;
    if (material == "metal" || material == "steel" || material == "plastic") return Pattern::wall;
    return std::nullopt;
}

Pattern drawnPattern(BuildingKind kind, std::uint64_t hash) {
    const double x = uniform(hash, 1);
    switch (kind) {
        case BuildingKind::office:
            return x < 0.4 ? Pattern::facadeGlass : x < 0.8 ? Pattern::facadeStone : Pattern::facadeBrick;
        case BuildingKind::civic:
            return x < 0.6 ? Pattern::facadeStone : x < 0.8 ? Pattern::facadePlaster : Pattern::facadeBrick;
        case BuildingKind::church:
            return x < 0.5 ? Pattern::facadeStone : Pattern::facadePlaster;
        case BuildingKind::industrial:
            return x < 0.6 ? Pattern::facadeBrick : Pattern::wall;
        case BuildingKind::small:
        case BuildingKind::canopy:
            return Pattern::wall;
        case BuildingKind::house:
            return x < 0.7 ? Pattern::facadePlaster : Pattern::facadeBrick;
        case BuildingKind::block:
            break;
    }
    return x < 0.55 ? Pattern::facadePlaster : x < 0.8 ? Pattern::facadeStone : Pattern::facadeBrick;
}

Colours coloursOf(Pattern pattern) {
    switch (pattern) {
        case Pattern::facadeBrick:
            return brickColours;
        case Pattern::facadeStone:
            return stoneColours;
        case Pattern::facadeGlass:
            return glassColours;
        case Pattern::wall:
            return plainColours;
        default:
            return plasterColours;
    }
}

}  // namespace

Facade chooseFacade(const OsmTags& tags, const OsmTags& outline, BuildingKind kind, bool pitched,
                    std::uint64_t hash, MaterialTable& table) {
    Facade facade;
    const Pattern pattern =
        taggedPattern(either(tags, outline, "building:material")).value_or(drawnPattern(kind, hash));
    std::optional<glm::vec3> colour = parseColour(either(tags, outline, "building:colour"));
    if (!colour) colour = parseColour(either(tags, outline, "building:color"));
    // Mesh makers put one repeat to a bay and a storey; the pattern's size only says how large that is.
    facade.wall =
        table.add(pattern, colour ? asPainted(*colour, pattern) : draw(coloursOf(pattern), hash, 2), 3);
    facade.trim =
        table.add(Pattern::plain, glm::mix(table[facade.wall].tint, glm::vec3(0.6f, 0.58f, 0.55f), 0.6f));
    facade.groundFloor = table.add(Pattern::shopFront, draw(shopColours, hash, 3), 4);

    const std::string_view roofMaterial = either(tags, outline, "roof:material");
    const bool tiled =
        roofMaterial == "roof_tiles" || roofMaterial == "tile" || (pitched && roofMaterial.empty());
    const bool metal = roofMaterial == "metal" || roofMaterial == "copper" || roofMaterial == "tin";
    const Pattern roofPattern = metal ? Pattern::metal : tiled ? Pattern::roofTiles : Pattern::roofFlat;
    std::optional<glm::vec3> roofColour = parseColour(either(tags, outline, "roof:colour"));
    if (!roofColour && roofMaterial == "copper") roofColour = parseColour("#6d9a86");
    facade.roof =
        table.add(roofPattern,
                  roofColour ? asPainted(*roofColour, roofPattern)
                             : draw(tiled ? Colours(tileColours) : Colours(flatRoofColours), hash, 4),
                  2);
    return facade;
}

}  // namespace city
