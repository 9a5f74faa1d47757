#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "city/geodesy/LocalFrame.h"
#include "city/model/BuildingMesh.h"

namespace city {

/// The key-value pairs of one OpenStreetMap object.
class OsmTags {
  public:
    void add(std::string key, std::string value) { pairs_.emplace_back(std::move(key), std::move(value)); }
    /// The value, or "" where the key is absent. Cost: linear in the few tags an object has.
    std::string_view get(std::string_view key) const {
        for (const auto& [k, v] : pairs_)
            if (k == key) return v;
        return {};
    }
    bool has(std::string_view key) const { return !get(key).empty(); }
    bool is(std::string_view key, std::string_view value) const { return get(key) == value; }
    bool empty() const { return pairs_.empty(); }

  private:
    std::vector<std::pair<std::string, std::string>> pairs_;
};

struct OsmPoint {
    std::int64_t id = 0;
    glm::vec2 position{0};
    OsmTags tags;
};

/// A way with what the file knows of its nodes, in order; nodes the file does not hold are left out.
struct OsmLine {
    std::int64_t id = 0;
    std::vector<std::int64_t> nodes;
    std::vector<glm::vec2> points;  ///< one for each of `nodes`
    std::set<std::size_t> gaps;     ///< indices of points before which nodes are missing
    OsmTags tags;

    bool closed() const { return nodes.size() > 3 && nodes.front() == nodes.back(); }
};

/// A closed way or a multipolygon relation.
struct OsmArea {
    std::int64_t id = 0;  ///< of the way, or minus that of the relation
    std::vector<Footprint> polygons;
    OsmTags tags;
};

/// What an OpenStreetMap file says, in a local frame: x east, y north, metres from the middle of its bounds.
struct OsmData {
    LocalFrame frame{0, 0, 0};
    glm::vec2 halfSize{0};         ///< the city reaches from -halfSize to +halfSize
    std::vector<OsmPoint> points;  ///< nodes with tags
    std::vector<OsmLine> lines;    ///< ways with tags, at least two known nodes
    std::vector<OsmArea> areas;    ///< of tags that make areas (see readOsm)

    bool cutToWidest = false;  ///< the file covers more than a city may

    // What reading had to leave out.
    std::size_t missingNodeReferences = 0;
    std::size_t incompleteRelations = 0;  ///< multipolygons some of whose ways the file does not hold
    std::size_t areasWithoutNodes = 0;    ///< closed ways that lie outside the file but for their tags
    std::size_t brokenAreas = 0;          ///< rings that cross or do not close
    std::size_t innerRings = 0;           ///< within the building areas, counted
};

}  // namespace city
