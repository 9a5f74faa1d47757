#include "city/import/OsmHeights.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "city/import/OsmValues.h"

namespace city {

namespace {

/// No building is higher, metres.
constexpr double highest = 1000;
constexpr double mostLevels = 250;

/// A building of no named use on less ground than this is a shed or an annexe, square metres.
constexpr double smallGround = 45;

/// How far neighbours count, and how many of them make (and at most enter) a median.
constexpr float neighbourReach = 250;
constexpr std::size_t leastNeighbours = 3;
constexpr std::size_t mostNeighbours = 9;

bool oneOf(std::string_view value, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), value) != names.end();
}

double usualHeight(BuildingKind kind) {
    switch (kind) {
        case BuildingKind::block:
            return 15;
        case BuildingKind::house:
            return 7;
        case BuildingKind::office:
            return 20;
        case BuildingKind::civic:
            return 14;
        case BuildingKind::church:
            return 18;
        case BuildingKind::industrial:
            return 9;
        case BuildingKind::small:
            return 3.2;
        case BuildingKind::canopy:
            return 5;
    }
    return 12;
}

/// Kinds whose heights follow their neighbours'.
bool followsNeighbours(BuildingKind kind) {
    return kind == BuildingKind::block || kind == BuildingKind::house || kind == BuildingKind::office ||
           kind == BuildingKind::civic;
}

/// Blocks, offices and civic buildings stand in one row and share their cornice height.
int family(BuildingKind kind) {
    return kind == BuildingKind::house ? 1 : 0;
}

std::optional<double> within(std::optional<double> value, double low, double high) {
    return value && *value > low && *value <= high ? value : std::nullopt;
}

}  // namespace

BuildingKind buildingKind(const OsmTags& tags, double groundArea) {
    std::string_view use = tags.get("building");
    if (use.empty() || use == "yes") {
        const std::string_view part = tags.get("building:part");
        if (!part.empty() && part != "yes") use = part;
    }
    if (oneOf(use, {"roof", "carport", "canopy", "bridge"}) || tags.is("man_made", "canopy"))
        return BuildingKind::canopy;
    if (oneOf(use, {"garage", "garages", "shed", "hut", "kiosk", "toilets", "service", "cabin", "greenhouse",
                    "container", "utility", "pavilion", "guardhouse", "booth", "transformer_tower"}))
        return BuildingKind::small;
    if (oneOf(use, {"house", "detached", "semidetached_house", "terrace", "bungalow", "farm", "villa",
                    "static_caravan", "allotment_house"}))
        return BuildingKind::house;
    if (oneOf(use, {"church", "chapel", "cathedral", "mosque", "temple", "synagogue", "shrine", "religious",
                    "monastery", "bell_tower"}))
        return BuildingKind::church;
    if (oneOf(use, {"industrial", "warehouse", "hangar", "barn", "manufacture", "farm_auxiliary", "depot"}))
        return BuildingKind::industrial;
    if (oneOf(use, {"office", "commercial", "hotel", "skyscraper", "tower"})) return BuildingKind::office;
    if (oneOf(use, {"public", "civic", "government", "school", "university", "college", "hospital", "museum",
                    "library", "theatre", "train_station", "transportation", "station", "kindergarten",
                    "palace", "townhall", "sports_hall", "stadium"}))
        return BuildingKind::civic;
    if ((use.empty() || use == "yes") && groundArea < smallGround && !tags.has("building:part"))
        return BuildingKind::small;
    return BuildingKind::block;
}

double storeyHeight(BuildingKind kind) {
    switch (kind) {
        case BuildingKind::house:
        case BuildingKind::small:
            return 2.9;
        case BuildingKind::office:
            return 3.7;
        case BuildingKind::civic:
            return 4.0;
        case BuildingKind::church:
            return 6.0;
        case BuildingKind::industrial:
            return 4.5;
        default:
            return 3.4;
    }
}

TaggedHeights taggedHeights(const OsmTags& tags, BuildingKind kind) {
    TaggedHeights heights;
    const double storey = storeyHeight(kind);
    heights.roof = within(parseLength(tags.get("roof:height")), 0, highest);
    const std::optional<double> roofLevels = within(parseNumber(tags.get("roof:levels")), 0, mostLevels);
    if (!heights.roof && roofLevels) heights.roof = *roofLevels * storey;

    heights.top = within(parseLength(tags.get("height")), 0.1, highest);
    if (!heights.top) heights.top = within(parseLength(tags.get("building:height")), 0.1, highest);
    if (!heights.top)
        if (const auto levels = within(parseNumber(tags.get("building:levels")), 0, mostLevels))
            heights.top = *levels * storey + heights.roof.value_or(0);

    heights.base = within(parseLength(tags.get("min_height")), 0, highest);
    if (!heights.base) heights.base = within(parseLength(tags.get("building:min_height")), 0, highest);
    if (!heights.base)
        if (const auto level = within(parseNumber(tags.get("building:min_level")), 0, mostLevels))
            heights.base = *level * storey;
    // A dome on a drum tells only where it begins and how high it is.
    if (!heights.top && heights.base && heights.roof) heights.top = *heights.base + *heights.roof;
    if (heights.top && heights.base && *heights.base >= *heights.top) heights.base.reset();
    if (heights.top && heights.roof)
        heights.roof = std::min(*heights.roof, *heights.top - heights.base.value_or(0));
    return heights;
}

void HeightGuess::addKnown(glm::vec2 position, BuildingKind kind, double height) {
    if (followsNeighbours(kind)) known_.push_back({position, kind, height});
}

double HeightGuess::guess(glm::vec2 position, BuildingKind kind) const {
    if (!followsNeighbours(kind)) return usualHeight(kind);
    std::vector<std::pair<float, double>> near;
    for (const Known& known : known_) {
        const float distance = glm::distance(known.position, position);
        if (family(known.kind) == family(kind) && distance < neighbourReach)
            near.emplace_back(distance, known.height);
    }
    if (near.size() < leastNeighbours) return usualHeight(kind);
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), mostNeighbours));
    std::vector<double> heights;
    heights.reserve(near.size());
    for (const auto& [distance, height] : near) heights.push_back(height);
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    return *middle;
}

}  // namespace city
