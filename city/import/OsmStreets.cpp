#include "city/import/OsmStreets.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "city/import/OsmBuildings.h"
#include "city/import/OsmTrams.h"
#include "city/import/OsmValues.h"

namespace city {

namespace {

struct RoadClass {
    std::string_view name;
    int lanes;  ///< both directions together
    float laneWidth;
    float pavement;
    float speed;  ///< km/h
};

// Widths: the German guidelines for streets in towns (RASt 06) round to these.
constexpr RoadClass roadClasses[] = {
    {"motorway", 4, 3.75f, 0, 100},     {"motorway_link", 2, 3.5f, 0, 60},
    {"trunk", 4, 3.5f, 0, 70},          {"trunk_link", 2, 3.5f, 0, 50},
    {"primary", 2, 3.5f, 4, 50},        {"primary_link", 2, 3.5f, 3, 40},
    {"secondary", 2, 3.25f, 4, 50},     {"secondary_link", 2, 3.25f, 3, 40},
    {"tertiary", 2, 3.25f, 3, 40},      {"tertiary_link", 2, 3.25f, 3, 40},
    {"unclassified", 2, 3.0f, 3, 40},   {"residential", 2, 3.0f, 3, 30},
    {"living_street", 2, 2.75f, 2, 20}, {"road", 2, 3.0f, 2, 40},
};

constexpr int mostLanes = 6;  ///< a direction; more is a slip of the pen

const RoadClass* roadClass(std::string_view highway) {
    for (const RoadClass& road : roadClasses)
        if (road.name == highway) return &road;
    return nullptr;
}

bool yes(std::string_view value) {
    return value == "yes" || value == "true" || value == "1";
}

std::optional<int> lanesOf(const OsmTags& tags, std::string_view key) {
    const std::optional<double> value = parseNumber(tags.get(key));
    if (!value || *value < 1) return std::nullopt;
    return std::min(static_cast<int>(std::lround(*value)), 2 * mostLanes);
}

/// Attributes of the street along the way's direction of drawing.
StreetGraph::Edge attributesOf(const OsmTags& tags, const RoadClass& road) {
    StreetGraph::Edge edge;
    edge.name = tags.get("name");
    const std::string_view oneway = tags.get("oneway");
    const bool round = tags.is("junction", "roundabout") || tags.is("junction", "circular");
    const bool against = oneway == "-1" || oneway == "reverse";
    const bool one =
        yes(oneway) || against || ((round || road.name.starts_with("motorway")) && oneway != "no");
    const std::optional<int> total = lanesOf(tags, "lanes");
    if (one) {
        int lanes = total.value_or(std::max(1, road.lanes / 2));
        lanes = std::clamp(lanes, 1, mostLanes);
        edge.lanesForward = against ? 0 : lanes;
        edge.lanesBackward = against ? lanes : 0;
    } else {
        const int both = std::max(2, total.value_or(road.lanes));
        const std::optional<int> forward = lanesOf(tags, "lanes:forward");
        const std::optional<int> backward = lanesOf(tags, "lanes:backward");
        edge.lanesForward = forward.value_or(backward ? both - *backward : (both + 1) / 2);
        edge.lanesBackward = backward.value_or(both - edge.lanesForward);
        edge.lanesForward = std::clamp(edge.lanesForward, 1, mostLanes);
        edge.lanesBackward = std::clamp(edge.lanesBackward, 1, mostLanes);
    }
    edge.laneWidth = road.laneWidth;
    const int lanes = edge.lanesForward + edge.lanesBackward;
    const std::optional<double> width = parseLength(tags.get("width"));
    if (width && *width > 2)
        edge.laneWidth = std::clamp(static_cast<float>(*width) / static_cast<float>(lanes), 2.75f, 4.5f);
    else if (one && lanes == 1)
        edge.laneWidth = std::max(edge.laneWidth, 3.75f);  // a single lane has kerbs on both sides
    edge.pavementWidth = tags.is("sidewalk", "none") || tags.is("sidewalk", "no") ? 1.0f : road.pavement;
    edge.speedLimit = static_cast<float>(
        std::clamp(parseSpeed(tags.get("maxspeed")).value_or(double(road.speed) / 3.6), 2.0, 40.0));
    return edge;
}

/// The part of segment a-b within the box, as parameters; nullopt outside (Liang and Barsky 1984).
std::optional<std::pair<float, float>> clipSegment(glm::vec2 a, glm::vec2 b, glm::vec2 half) {
    float low = 0;
    float high = 1;
    for (int axis = 0; axis < 2; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            const float from = sign * a[axis] - half[axis];
            const float to = sign * b[axis] - half[axis];
            if (from > 0 && to > 0) return std::nullopt;
            if (from > 0) low = std::max(low, from / (from - to));
            if (to > 0) high = std::min(high, from / (from - to));
        }
    }
    if (!(low < high)) return std::nullopt;
    return std::pair{low, high};
}

class GraphBuilder {
  public:
    std::uint32_t node(std::int64_t id, glm::vec2 position) {
        const auto fresh = static_cast<std::uint32_t>(graph_.nodes.size());
        if (id != 0) {
            const auto [place, isNew] = index_.try_emplace(id, fresh);
            if (!isNew) return place->second;
        }
        graph_.nodes.push_back({glm::vec3(position, 0), false});
        return fresh;
    }
    /// Splits a piece at the nodes that `split` names and adds the edges.
    template <typename Split>
    void add(const OsmPiece& piece, const StreetGraph::Edge& attributes, const Split& split) {
        std::size_t start = 0;
        for (std::size_t i = 1; i < piece.nodes.size(); ++i) {
            if (i + 1 < piece.nodes.size() && !split(piece.nodes[i])) continue;
            StreetGraph::Edge edge = attributes;
            edge.from = node(piece.nodes[start], piece.points[start]);
            edge.to = node(piece.nodes[i], piece.points[i]);
            for (std::size_t k = start; k <= i; ++k) edge.shape.emplace_back(piece.points[k], 0);
            graph_.edges.push_back(std::move(edge));
            start = i;
        }
    }
    bool signal(std::int64_t id) {
        const auto found = index_.find(id);
        if (found == index_.end()) return false;
        graph_.nodes[found->second].signalled = true;
        return true;
    }
    StreetGraph& graph() { return graph_; }

  private:
    StreetGraph graph_;
    std::unordered_map<std::int64_t, std::uint32_t> index_;
};

bool isSignal(const OsmTags& tags) {
    return tags.is("highway", "traffic_signals");
}

/// Counts how often each node begins, ends or lies within pieces: twice means that something is shared there.
std::unordered_map<std::int64_t, int> nodeUses(const std::vector<OsmPiece>& pieces) {
    std::unordered_map<std::int64_t, int> uses;
    for (const OsmPiece& piece : pieces)
        for (const std::int64_t id : piece.nodes) ++uses[id];
    return uses;
}

}  // namespace

std::vector<OsmPiece> piecesWithin(const OsmLine& way, glm::vec2 halfSize) {
    std::vector<OsmPiece> pieces;
    OsmPiece current{&way, {}, {}};
    const auto finish = [&] {
        if (current.points.size() > 1) pieces.push_back(current);
        current.nodes.clear();
        current.points.clear();
    };
    for (std::size_t i = 0; i + 1 < way.points.size(); ++i) {
        const glm::vec2 a = way.points[i];
        const glm::vec2 b = way.points[i + 1];
        const auto part = way.gaps.contains(i + 1) ? std::nullopt : clipSegment(a, b, halfSize);
        if (!part) {
            finish();
            continue;
        }
        if (current.points.empty() || part->first > 0) {
            finish();
            current.nodes.push_back(part->first > 0 ? 0 : way.nodes[i]);
            current.points.push_back(a + part->first * (b - a));
        }
        current.nodes.push_back(part->second < 1 ? 0 : way.nodes[i + 1]);
        current.points.push_back(part->second < 1 ? a + part->second * (b - a) : b);
        if (part->second < 1) finish();
    }
    finish();
    return pieces;
}

WayUse wayUse(const OsmTags& tags) {
    const std::string_view railway = tags.get("railway");
    if (railway == "tram") return WayUse::tram;
    if (railway == "rail" || railway == "light_rail" || railway == "narrow_gauge") return WayUse::rail;
    const std::string_view highway = tags.get("highway");
    if (highway.empty() || tags.is("area", "yes")) return WayUse::none;
    if (highway == "steps") return WayUse::steps;
    if (highway == "service" || highway == "track" || highway == "busway") return WayUse::service;
    if (highway == "footway" || highway == "path" || highway == "cycleway" || highway == "pedestrian" ||
        highway == "bridleway" || highway == "trail" || highway == "platform")
        return WayUse::path;
    if (!roadClass(highway)) return WayUse::none;
    if (tags.is("access", "no") || tags.is("motor_vehicle", "no") || tags.is("vehicle", "no"))
        return WayUse::path;
    return WayUse::cars;
}

bool isMainStreet(const OsmTags& tags) {
    const std::string_view highway = tags.get("highway");
    return highway == "primary" || highway == "secondary" || highway == "tertiary" ||
           highway == "pedestrian" || highway == "trunk";
}

StreetPlan planStreets(const OsmData& data) {
    StreetPlan plan;
    std::vector<OsmPiece> cars;
    std::vector<OsmPiece> trams;
    for (const OsmLine& way : data.lines) {
        const WayUse use = wayUse(way.tags);
        if (use == WayUse::none) continue;
        std::vector<OsmPiece> pieces = piecesWithin(way, data.halfSize);
        if (pieces.empty()) continue;
        if (isUnderground(way.tags)) {
            ++plan.tunnels;
            continue;
        }
        if (way.tags.has("bridge") && !way.tags.is("bridge", "no")) ++plan.bridges;
        if (isMainStreet(way.tags))
            for (const OsmPiece& piece : pieces) plan.mainStreets.push_back(piece.points);
        if (use == WayUse::cars) {
            ++plan.carWays;
            if (!lanesOf(way.tags, "lanes")) ++plan.guessedLanes;
            std::move(pieces.begin(), pieces.end(), std::back_inserter(cars));
        } else if (use == WayUse::tram) {
            ++plan.tramWays;
            std::move(pieces.begin(), pieces.end(), std::back_inserter(trams));
        }
    }

    std::unordered_set<std::int64_t> signals;
    for (const OsmPoint& point : data.points)
        if (isSignal(point.tags)) signals.insert(point.id);
    GraphBuilder builder;
    const auto carUses = nodeUses(cars);
    for (const OsmPiece& piece : cars)
        builder.add(piece, attributesOf(piece.way->tags, *roadClass(piece.way->tags.get("highway"))),
                    [&](std::int64_t id) { return id != 0 && (carUses.at(id) > 1 || signals.contains(id)); });
    for (const OsmPoint& point : data.points) {
        if (!isSignal(point.tags)) continue;
        if (builder.signal(point.id))
            ++plan.signals;
        else if (std::abs(point.position.x) < data.halfSize.x && std::abs(point.position.y) < data.halfSize.y)
            ++plan.strandedSignals;
    }
    plan.graph = std::move(builder.graph());
    addTrams(trams, plan.graph);
    return plan;
}

}  // namespace city
