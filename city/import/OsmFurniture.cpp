#include "city/import/OsmFurniture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "city/generate/Furniture.h"
#include "city/generate/Random.h"
#include "city/import/OsmBuildings.h"
#include "city/import/OsmMaterials.h"
#include "city/import/OsmValues.h"
#include "city/model/PolygonAlgebra.h"

namespace city {

namespace {

constexpr float rowSpacing = 8;   ///< metres between trees of a row
constexpr float woodSpacing = 7;  ///< and of a wood
constexpr std::size_t mostWoodTrees = 3000;
constexpr float kerbHeight = 0.12f;  ///< furniture stands on pavements

/// From a point to the nearest street axis.
struct ToStreet {
    glm::vec2 direction{1, 0};
    float distance = 1e30f;
};
ToStreet toStreet(const StreetGraph& streets, glm::vec2 p) {
    ToStreet best;
    for (const StreetGraph::Edge& edge : streets.edges) {
        if (!edge.cars) continue;
        for (std::size_t i = 0; i + 1 < edge.shape.size(); ++i) {
            const glm::vec2 a(edge.shape[i]);
            const glm::vec2 d = glm::vec2(edge.shape[i + 1]) - a;
            const float lengthSquared = glm::dot(d, d);
            if (!(lengthSquared > 0)) continue;
            const glm::vec2 to = a + std::clamp(glm::dot(p - a, d) / lengthSquared, 0.0f, 1.0f) * d - p;
            const float distance = glm::length(to);
            if (distance >= best.distance || !(distance > 0)) continue;
            best = {to / distance, distance};
        }
    }
    return best;
}

/// Streets are as wide as their class where the map does not tell: what the map sets into such a carriageway
/// moves to its kerb.
glm::vec2 besideCarriageway(const StreetGraph& streets, glm::vec2 p) {
    constexpr float kerbDistance = 0.6f;
    float deepest = 0;
    glm::vec2 out = p;
    for (const StreetGraph::Edge& edge : streets.edges) {
        const float half =
            0.5f *
            (static_cast<float>(edge.lanesForward + edge.lanesBackward) * edge.laneWidth + edge.medianWidth);
        for (std::size_t i = 0; i + 1 < edge.shape.size(); ++i) {
            const glm::vec2 a(edge.shape[i]);
            const glm::vec2 d = glm::vec2(edge.shape[i + 1]) - a;
            const float lengthSquared = glm::dot(d, d);
            if (!(lengthSquared > 0)) continue;
            const float t = glm::dot(p - a, d) / lengthSquared;
            if (t < 0 || t > 1) continue;
            const glm::vec2 from = p - (a + t * d);
            const float distance = glm::length(from);
            const float depth = half + kerbDistance - distance;
            if (depth <= deepest) continue;
            const glm::vec2 side =
                distance > 0.01f ? from / distance : glm::vec2(d.y, -d.x) / std::sqrt(lengthSquared);
            deepest = depth;
            out = p + depth * side;
        }
    }
    return out;
}

class Furnisher {
  public:
    Furnisher(const OsmData& data, const StreetGraph& streets, const Standing& kinds, std::uint64_t seed,
              CityModel& model)
        : data_(data), streets_(streets), kinds_(kinds), seed_(seed), model_(model) {
        for (const auto* kind : {&kinds.avenueTrees, &kinds.parkTrees, &kinds.streetTrees})
            for (const std::uint32_t tree : *kind) {
                trees_.push_back(tree);
                heights_.push_back(model.prototypes[tree].levels.front().mesh.bounds().max.z);
            }
    }

    FurnitureCounts run(const GroundPlan& ground, const std::vector<Footprint>& buildings) {
        for (const OsmPoint& point : data_.points) {
            if (!inside(point.position) || isUnderground(point.tags)) continue;
            place(point);
        }
        for (const OsmLine& line : data_.lines)
            if (line.tags.is("natural", "tree_row")) plantRow(line);
        strewWoods(ground, buildings);
        return counts_;
    }

  private:
    bool inside(glm::vec2 p) const {
        return std::abs(p.x) < data_.halfSize.x && std::abs(p.y) < data_.halfSize.y;
    }

    void place(const OsmPoint& point) {
        const OsmTags& tags = point.tags;
        if (tags.is("natural", "tree")) {
            plant(point.position, point.id, tags);
            ++counts_.trees;
        } else if (tags.is("highway", "street_lamp")) {
            const ToStreet street = toStreet(streets_, point.position);
            // Lamps far from streets stand in parks and squares and have no arm.
            const bool atStreet = street.distance < 14;
            stand(atStreet ? kinds_.streetLamp : kinds_.squareLamp, point.position, street.direction);
            ++counts_.lamps;
        } else if (tags.is("amenity", "bench")) {
            small(point, kinds_.bench);
        } else if (tags.is("amenity", "waste_basket")) {
            small(point, kinds_.bin);
        } else if (tags.is("barrier", "bollard")) {
            small(point, kinds_.bollard);
        } else if (tags.is("advertising", "column")) {
            small(point, kinds_.advertColumns[static_cast<std::size_t>(mixed(seed_, point.id) %
                                                                       kinds_.advertColumns.size())]);
        }
    }

    void small(const OsmPoint& point, std::uint32_t which) {
        stand(which, point.position, toStreet(streets_, point.position).direction);
        ++counts_.others;
    }

    void stand(std::uint32_t which, glm::vec2 mapped, glm::vec2 front, float scale = 1) {
        const glm::vec2 foot = besideCarriageway(streets_, mapped);
        const float z = toStreetHeight(foot);
        model_.placements.push_back({which, standing(glm::vec3(foot, z), front, scale)});
    }

    /// Near streets things stand on pavements, elsewhere on the ground; a foot a little too deep shows less
    /// than one in the air.
    float toStreetHeight(glm::vec2 foot) const {
        return toStreet(streets_, foot).distance < 9 ? kerbHeight - 0.05f : groundHeight;
    }

    void plant(glm::vec2 foot, std::int64_t id, const OsmTags& tags) {
        const std::uint64_t hash = mixed(seed_, id);
        const std::optional<double> height = parseLength(tags.get("height"));
        auto kind = static_cast<std::size_t>(uniform(hash, 1) * static_cast<double>(trees_.size()));
        auto scale = static_cast<float>(0.85 + 0.3 * uniform(hash, 2));
        if (height && *height > 1 && *height < 60) {
            // The kind whose size fits best is scaled the rest of the way.
            const auto misfit = [&](std::size_t k) {
                return std::abs(heights_[k] - static_cast<float>(*height));
            };
            for (std::size_t k = 0; k < trees_.size(); ++k)
                if (misfit(k) < misfit(kind)) kind = k;
            scale = static_cast<float>(*height) / heights_[kind];
        }
        const Turn turn(uniform(hash, 3));
        stand(trees_[kind], foot, {turn.cos, turn.sin}, scale);
    }

    void plantRow(const OsmLine& line) {
        float rest = 0;
        std::int64_t number = 0;
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
            const glm::vec2 d = line.points[i + 1] - line.points[i];
            const float length = glm::length(d);
            if (!(length > 0) || line.gaps.contains(i + 1)) continue;
            for (; rest < length; rest += rowSpacing) {
                const glm::vec2 foot = line.points[i] + d * (rest / length);
                if (!inside(foot)) continue;
                plant(foot, line.id * 1000 + number++, {});
                ++counts_.rowTrees;
            }
            rest -= length;
        }
    }

    void strewWoods(const GroundPlan& ground, const std::vector<Footprint>& buildings) {
        const auto& woods = ground.covers[static_cast<std::size_t>(Cover::wood)];
        for (std::size_t w = 0; w < woods.size(); ++w) {
            Aabb box;
            for (const glm::vec2 p : woods[w].outer) box.extend(glm::vec3(p, 0));
            const glm::vec2 low = glm::max(glm::vec2(box.min), -data_.halfSize);
            const glm::vec2 high = glm::min(glm::vec2(box.max), data_.halfSize);
            for (int row = 0; low.y + static_cast<float>(row) * woodSpacing < high.y; ++row) {
                for (int column = 0; low.x + static_cast<float>(column) * woodSpacing < high.x; ++column) {
                    if (counts_.woodTrees >= mostWoodTrees) return;
                    const auto id =
                        static_cast<std::int64_t>(w) * 1000003 + std::int64_t{row} * 2003 + column;
                    const std::uint64_t hash = mixed(seed_ + 1, id);
                    const glm::vec2 p = low + woodSpacing * (glm::vec2(column, row) +
                                                             glm::vec2(uniform(hash, 1), uniform(hash, 2)));
                    if (!inside(p) || !contains(woods[w], p) || toStreet(streets_, p).distance < 9) continue;
                    const auto covers = [&](const std::vector<Footprint>& all) {
                        return std::any_of(all.begin(), all.end(),
                                           [&](const Footprint& f) { return contains(f, p); });
                    };
                    if (covers(buildings) || covers(ground.covers[static_cast<std::size_t>(Cover::path)]) ||
                        covers(ground.covers[static_cast<std::size_t>(Cover::water)]) ||
                        covers(ground.covers[static_cast<std::size_t>(Cover::asphalt)]))
                        continue;
                    plant(p, id, {});
                    ++counts_.woodTrees;
                }
            }
        }
    }

    const OsmData& data_;
    const StreetGraph& streets_;
    const Standing& kinds_;
    std::uint64_t seed_;
    CityModel& model_;
    std::vector<std::uint32_t> trees_;
    std::vector<float> heights_;
    FurnitureCounts counts_;
};

}  // namespace

FurnitureCounts placeFurniture(const OsmData& data, const StreetGraph& streets, const GroundPlan& ground,
                               const std::vector<Footprint>& buildings, const Standing& kinds,
                               std::uint64_t seed, CityModel& model) {
    return Furnisher(data, streets, kinds, seed, model).run(ground, buildings);
}

}  // namespace city
