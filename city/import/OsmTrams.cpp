#include "city/import/OsmTrams.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace city {

namespace {

constexpr float sampleStep = 4;  ///< metres along streets and tracks
constexpr float parallelCosine =
    0.9f;  ///< a track that turns off by 25 degrees crosses a street rather than following it
constexpr float trackedShare = 0.7f;  ///< of a street's length, for the street to have a tram
constexpr float shortestTrack = 30;   ///< metres; shorter rests of tracks are lost in crossings
constexpr float beyondKerb = 0.5f;    ///< metres by which maps draw a track beside the carriageway it is in

struct Sample {
    glm::vec2 position;
    glm::vec2 direction;
    std::uint32_t owner;
};

/// Points every few metres, found by where they are.
class SampleGrid {
  public:
    void add(const Sample& sample) {
        cells_[key(cell(sample.position.x), cell(sample.position.y))].push_back(sample);
    }
    template <typename Visit>
    void near(glm::vec2 p, const Visit& visit) const {
        for (int x = cell(p.x) - 1; x <= cell(p.x) + 1; ++x)
            for (int y = cell(p.y) - 1; y <= cell(p.y) + 1; ++y)
                if (const auto found = cells_.find(key(x, y)); found != cells_.end())
                    for (const Sample& sample : found->second) visit(sample);
    }

  private:
    static constexpr float size = 20;
    static int cell(float v) { return static_cast<int>(std::floor(v / size)); }
    static std::int64_t key(int x, int y) { return static_cast<std::int64_t>(x) * 1000003 + y; }
    std::unordered_map<std::int64_t, std::vector<Sample>> cells_;
};

template <typename Point>
std::vector<Sample> samplesOf(const std::vector<Point>& points, std::uint32_t owner) {
    std::vector<Sample> samples;
    float rest = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const glm::vec2 a(points[i]);
        const glm::vec2 d = glm::vec2(points[i + 1]) - a;
        const float length = glm::length(d);
        if (!(length > 0)) continue;
        for (; rest < length; rest += sampleStep)
            samples.push_back({a + d * (rest / length), d / length, owner});
        rest -= length;
    }
    return samples;
}

/// Distance to a sample's tangent: samples are some metres apart, tangents are not.
bool besides(const Sample& sample, glm::vec2 p, glm::vec2 direction, float reach) {
    const glm::vec2 d = p - sample.position;
    return std::abs(glm::dot(d, sample.direction)) < sampleStep &&
           std::abs(d.x * sample.direction.y - d.y * sample.direction.x) < reach &&
           std::abs(glm::dot(direction, sample.direction)) > parallelCosine;
}

float halfCarriageway(const StreetGraph::Edge& edge) {
    return 0.5f *
           (static_cast<float>(edge.lanesForward + edge.lanesBackward) * edge.laneWidth + edge.medianWidth);
}

}  // namespace

void addTrams(const std::vector<OsmPiece>& tracks, StreetGraph& graph) {
    SampleGrid rails;
    for (const OsmPiece& track : tracks)
        for (const Sample& sample : samplesOf(track.points, 0)) rails.add(sample);

    SampleGrid tramStreets;
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
        StreetGraph::Edge& edge = graph.edges[e];
        const float reach = halfCarriageway(edge) + beyondKerb;
        const std::vector<Sample> samples = samplesOf(edge.shape, e);
        std::size_t tracked = 0;
        for (const Sample& sample : samples) {
            bool hit = false;
            rails.near(sample.position, [&](const Sample& rail) {
                hit = hit || besides(rail, sample.position, sample.direction, reach);
            });
            tracked += hit;
        }
        if (samples.empty() ||
            static_cast<float>(tracked) < trackedShare * static_cast<float>(samples.size()))
            continue;
        edge.tram = true;
        for (const Sample& sample : samples) tramStreets.add(sample);
    }

    // What no street has taken over.
    std::unordered_map<std::int64_t, std::uint32_t> nodes;
    const auto nodeAt = [&](std::int64_t id, glm::vec2 position) {
        const auto fresh = static_cast<std::uint32_t>(graph.nodes.size());
        if (id != 0) {
            const auto [place, isNew] = nodes.try_emplace(id, fresh);
            if (!isNew) return place->second;
        }
        graph.nodes.push_back({glm::vec3(position, 0), false});
        return fresh;
    };
    std::unordered_map<std::int64_t, int> uses;
    for (const OsmPiece& track : tracks)
        for (const std::int64_t id : track.nodes) ++uses[id];
    for (const OsmPiece& track : tracks) {
        std::vector<bool> taken;
        for (std::size_t i = 0; i + 1 < track.points.size(); ++i) {
            const glm::vec2 d = track.points[i + 1] - track.points[i];
            const float length = glm::length(d);
            bool inStreet = false;
            if (length > 0) {
                const glm::vec2 middle = 0.5f * (track.points[i] + track.points[i + 1]);
                tramStreets.near(middle, [&](const Sample& street) {
                    inStreet =
                        inStreet || besides(street, middle, d / length,
                                            halfCarriageway(graph.edges[street.owner]) + 2 * beyondKerb);
                });
            }
            taken.push_back(inStreet);
        }
        for (std::size_t i = 0; i < taken.size();) {
            if (taken[i]) {
                ++i;
                continue;
            }
            std::size_t end = i;
            float length = 0;
            while (end < taken.size() && !taken[end]) {
                length += glm::distance(track.points[end], track.points[end + 1]);
                ++end;
            }
            const std::size_t first = i;
            i = end;
            const bool whole = first == 0 && end == taken.size();
            if (length < shortestTrack && !whole) continue;
            std::size_t start = first;
            for (std::size_t k = first + 1; k <= end; ++k) {
                if (k < end && (track.nodes[k] == 0 || uses[track.nodes[k]] < 2)) continue;
                StreetGraph::Edge edge;
                edge.cars = false;
                edge.tram = true;
                edge.lanesForward = 1;
                edge.lanesBackward = 0;
                edge.laneWidth = 3;
                edge.pavementWidth = 0;
                edge.crossingAtEnds = false;
                edge.speedLimit = 11;
                edge.from = nodeAt(track.nodes[start], track.points[start]);
                edge.to = nodeAt(track.nodes[k], track.points[k]);
                for (std::size_t p = start; p <= k; ++p) edge.shape.emplace_back(track.points[p], 0);
                graph.edges.push_back(std::move(edge));
                start = k;
            }
        }
    }
}

}  // namespace city
