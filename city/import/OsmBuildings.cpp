#include "city/import/OsmBuildings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "city/import/OsmFacades.h"
#include "city/import/OsmHeights.h"
#include "city/import/OsmValues.h"
#include "city/model/PolygonAlgebra.h"
#include "city/model/RoofPlanes.h"

namespace city {

namespace {

/// What the parts leave free of an outline is drawn when it is more than this share of it.
constexpr double leastRemainder = 0.08;

/// A shop's node lies inside the building or at its door, at most this far outside, metres.
constexpr float doorReach = 3;

/// A facade this near to a main street's axis stands at it, metres.
constexpr float mainStreetReach = 20;

/// The ground floor of a building with shops, and the least height of a building that has one, metres.
constexpr float shopFloorHeight = 4.2f;
constexpr double leastShopBuilding = 6.5;

/// A part that hangs in the air is drawn only if it is at least as large as a room, square metres.
constexpr double leastFloating = 6;

/// A canopy's thickness, metres.
constexpr double canopyThickness = 0.4;

struct Box {
    glm::vec2 low{1e30f};
    glm::vec2 high{-1e30f};
    bool holds(glm::vec2 p, float margin = 0) const {
        return p.x >= low.x - margin && p.y >= low.y - margin && p.x <= high.x + margin &&
               p.y <= high.y + margin;
    }
};

/// One outline or part after cleaning.
struct Candidate {
    const OsmArea* source = nullptr;
    std::vector<Footprint> polygons;
    double ground = 0;    ///< square metres
    glm::vec2 inside{0};  ///< a point within the largest polygon
    Box box;
    BuildingKind kind = BuildingKind::block;
    TaggedHeights heights;
    std::vector<std::size_t> parts;      ///< of an outline
    std::optional<std::size_t> outline;  ///< of a part
};

bool holds(const Candidate& candidate, glm::vec2 p) {
    return candidate.box.holds(p) && std::any_of(candidate.polygons.begin(), candidate.polygons.end(),
                                                 [&](const Footprint& f) { return contains(f, p); });
}

float distanceToSegment(glm::vec2 p, glm::vec2 a, glm::vec2 b) {
    const glm::vec2 ab = b - a;
    const float lengthSquared = glm::dot(ab, ab);
    const float t = lengthSquared > 0 ? std::clamp(glm::dot(p - a, ab) / lengthSquared, 0.0f, 1.0f) : 0.0f;
    return glm::distance(p, a + t * ab);
}

/// The middle of the largest triangle is inside, whatever the shape.
std::optional<glm::vec2> innerPoint(const std::vector<Footprint>& polygons) {
    double best = 0;
    std::optional<glm::vec2> point;
    for (const Footprint& polygon : polygons) {
        const std::vector<glm::vec2> triangles = triangulateClean(polygon);
        for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
            const double size = signedArea(std::span(triangles).subspan(i, 3));
            if (size <= best) continue;
            best = size;
            point = (triangles[i] + triangles[i + 1] + triangles[i + 2]) / 3.0f;
        }
    }
    return point;
}

std::optional<Candidate> candidateOf(const OsmArea& source) {
    Candidate candidate;
    candidate.source = &source;
    for (const Footprint& polygon : source.polygons)
        for (Footprint& part : cleanFootprint(polygon).parts) candidate.polygons.push_back(std::move(part));
    const std::optional<glm::vec2> inside = innerPoint(candidate.polygons);
    if (!inside) return std::nullopt;
    candidate.inside = *inside;
    for (const Footprint& polygon : candidate.polygons) {
        candidate.ground += area(polygon);
        for (const glm::vec2 p : polygon.outer) {
            candidate.box.low = glm::min(candidate.box.low, p);
            candidate.box.high = glm::max(candidate.box.high, p);
        }
    }
    candidate.kind = buildingKind(source.tags, candidate.ground);
    candidate.heights = taggedHeights(source.tags, candidate.kind);
    return candidate;
}

bool isPart(const OsmTags& tags) {
    return tags.has("building:part") && !tags.is("building:part", "no") && !tags.has("building");
}

bool isOutline(const OsmTags& tags) {
    return tags.has("building") && !tags.is("building", "no");
}

class Planner {
  public:
    Planner(const OsmData& data, const std::vector<std::vector<glm::vec2>>& mainStreets, std::uint64_t seed,
            MaterialTable& table)
        : data_(data), mainStreets_(mainStreets), seed_(seed), table_(table) {
        for (const OsmPoint& point : data.points)
            if (point.tags.has("shop") || isPublicHouse(point.tags)) shops_.push_back(point.position);
    }

    BuildingPlans run() {
        for (const OsmArea& source : data_.areas) {
            const bool part = isPart(source.tags);
            if (!part && !isOutline(source.tags)) continue;
            if (isUnderground(source.tags)) {
                ++result_.underground;
                continue;
            }
            std::optional<Candidate> candidate = candidateOf(source);
            if (!candidate) continue;
            if (std::abs(candidate->inside.x) > data_.halfSize.x ||
                std::abs(candidate->inside.y) > data_.halfSize.y) {
                ++result_.outside;
                continue;
            }
            if (!part && candidate->heights.top)
                guess_.addKnown(candidate->inside, candidate->kind, *candidate->heights.top);
            (part ? parts_ : outlines_).push_back(std::move(*candidate));
        }
        sortAmbiguous();
        assignParts();
        rankParts();
        for (const Candidate& outline : outlines_) planOutline(outline);
        for (const Candidate& part : parts_) planPart(part);
        result_.buildings = outlines_.size();
        result_.parts = parts_.size();
        return std::move(result_);
    }

  private:
    static bool isPublicHouse(const OsmTags& tags) {
        const std::string_view amenity = tags.get("amenity");
        return amenity == "cafe" || amenity == "restaurant" || amenity == "bar" || amenity == "pub" ||
               amenity == "fast_food" || amenity == "bank" || amenity == "pharmacy" || amenity == "cinema";
    }

    /// What is tagged as a building and as a part at once is a part where it lies in a larger building.
    void sortAmbiguous() {
        std::vector<Candidate> outlines;
        for (Candidate& candidate : outlines_) {
            const bool within =
                candidate.source->tags.has("building:part") &&
                !candidate.source->tags.is("building:part", "no") &&
                std::any_of(outlines_.begin(), outlines_.end(), [&](const Candidate& other) {
                    return other.ground > 1.1 * candidate.ground && holds(other, candidate.inside);
                });
            if (within)
                parts_.push_back(candidate);
            else
                outlines.push_back(candidate);
        }
        outlines_ = std::move(outlines);
    }

    /// Parts of one building often share walls in their lower storeys: the higher of two is drawn in by a
    /// hair, or they would flicker.
    void rankParts() {
        constexpr double hair = 0.02;  // metres
        constexpr std::size_t mostRanks = 8;
        for (const Candidate& outline : outlines_) {
            std::vector<std::size_t> order = outline.parts;
            std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
                return parts_[a].heights.top.value_or(0) < parts_[b].heights.top.value_or(0);
            });
            for (std::size_t rank = 1; rank < order.size(); ++rank) {
                std::vector<Footprint> smaller;
                for (const Footprint& polygon : parts_[order[rank]].polygons)
                    for (Footprint& piece : offset(polygon, -hair * double(std::min(rank, mostRanks))))
                        smaller.push_back(std::move(piece));
                if (!smaller.empty()) parts_[order[rank]].polygons = std::move(smaller);
            }
        }
    }

    /// Whether a part that begins above the ground has something below it.
    bool isBorne(const Candidate& part) const {
        const double base = part.heights.base.value_or(0);
        if (base < 1 || !part.outline) return true;
        const Candidate& outline = outlines_[*part.outline];
        return std::any_of(outline.parts.begin(), outline.parts.end(), [&](std::size_t p) {
            const Candidate& other = parts_[p];
            return &other != &part && other.heights.base.value_or(0) < base && other.heights.top &&
                   *other.heights.top > base - 1.5 && holds(other, part.inside);
        });
    }

    void assignParts() {
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            for (std::size_t o = 0; o < outlines_.size(); ++o) {
                if (!holds(outlines_[o], parts_[p].inside)) continue;
                if (!parts_[p].outline || outlines_[o].ground < outlines_[*parts_[p].outline].ground)
                    parts_[p].outline = o;
            }
            if (parts_[p].outline) outlines_[*parts_[p].outline].parts.push_back(p);
        }
    }

    double topOf(const Candidate& candidate) {
        if (candidate.heights.top) return *candidate.heights.top;
        ++result_.guessedHeights;
        return guess_.guess(candidate.inside, candidate.kind) + candidate.heights.base.value_or(0);
    }

    void planOutline(const Candidate& outline) {
        if (outline.parts.empty()) {
            plan(outline, outline, outline.polygons, topOf(outline));
            return;
        }
        ++result_.replacedOutlines;
        std::vector<Footprint> covered;
        std::vector<double> tops;
        for (const std::size_t p : outline.parts) {
            covered.insert(covered.end(), parts_[p].polygons.begin(), parts_[p].polygons.end());
            if (parts_[p].heights.top && !parts_[p].heights.base) tops.push_back(*parts_[p].heights.top);
        }
        double rest = 0;
        // A little wider, so that no blade of outline stands between parts that do not quite touch.
        std::vector<Footprint> grown;
        for (const Footprint& footprint : covered)
            for (Footprint& wide : offset(footprint, 0.3)) grown.push_back(std::move(wide));
        const std::vector<Footprint> remainder = difference(outline.polygons, grown);
        for (const Footprint& footprint : remainder) rest += area(footprint);
        if (rest <= leastRemainder * outline.ground) return;
        ++result_.keptRemainders;
        // An outline's height is that of its highest part: what is left is as high as most parts, at most.
        double top = topOf(outline);
        if (!tops.empty()) {
            std::sort(tops.begin(), tops.end());
            top = std::min(top, tops[tops.size() / 2]);
        }
        plan(outline, outline, remainder, top);
    }

    void planPart(const Candidate& part) {
        // Crosses and flags whose tower the file lacks.
        if (part.ground < leastFloating && !isBorne(part)) {
            ++result_.floating;
            return;
        }
        const Candidate& outline = part.outline ? outlines_[*part.outline] : part;
        double top = 0;
        if (!part.heights.top && part.outline && outline.heights.top &&
            *outline.heights.top > part.heights.base.value_or(0))
            top = *outline.heights.top;
        else
            top = topOf(part);
        plan(part, outline, part.polygons, top);
    }

    bool hasShop(const Candidate& building) const {
        const OsmTags& tags = building.source->tags;
        if (tags.has("shop") || tags.is("building", "retail") || tags.is("building", "supermarket"))
            return true;
        return std::any_of(shops_.begin(), shops_.end(), [&](glm::vec2 shop) {
            if (!building.box.holds(shop, doorReach)) return false;
            for (const Footprint& polygon : building.polygons) {
                if (contains(polygon, shop)) return true;
                for (std::size_t i = 0, n = polygon.outer.size(); i < n; ++i)
                    if (distanceToSegment(shop, polygon.outer[i], polygon.outer[(i + 1) % n]) < doorReach)
                        return true;
            }
            return false;
        });
    }

    bool atMainStreet(const Candidate& building) const {
        for (const auto& street : mainStreets_) {
            for (std::size_t i = 0; i + 1 < street.size(); ++i) {
                const glm::vec2 low = glm::min(street[i], street[i + 1]) - mainStreetReach;
                const glm::vec2 high = glm::max(street[i], street[i + 1]) + mainStreetReach;
                if (high.x < building.box.low.x || high.y < building.box.low.y ||
                    low.x > building.box.high.x || low.y > building.box.high.y)
                    continue;
                for (const Footprint& polygon : building.polygons)
                    for (std::size_t k = 0, n = polygon.outer.size(); k < n; ++k)
                        if (distanceToSegment(0.5f * (polygon.outer[k] + polygon.outer[(k + 1) % n]),
                                              street[i], street[i + 1]) < mainStreetReach)
                            return true;
            }
        }
        return false;
    }

    static RoofShape roofShape(const OsmTags& tags, BuildingKind kind) {
        const std::string_view shape = tags.get("roof:shape");
        if (shape == "gabled" || shape == "gambrel" || shape == "round" || shape == "saltbox")
            return RoofShape::gabled;
        if (shape == "hipped" || shape == "half-hipped" || shape == "mansard" || shape == "side_hipped")
            return RoofShape::hipped;
        if (shape == "pyramidal" || shape == "cone" || shape == "conical") return RoofShape::pyramidal;
        if (shape == "dome" || shape == "onion") return RoofShape::dome;
        if (shape.empty() && kind == BuildingKind::house) return RoofShape::gabled;
        return RoofShape::flat;
    }

    /// Metres from eaves to ridge where the file does not say: the usual pitch over half the depth.
    static double usualRise(const Footprint& polygon, RoofShape roof, double wallAndRoof) {
        constexpr double usualPitch = 0.6;  // 31 degrees
        const auto rectangle = orientedRectangle(polygon);
        if (!rectangle) return 0;
        const double half = rectangle->half.y;
        return std::min((roof == RoofShape::dome ? 1.0 : usualPitch) * half,
                        (roof == RoofShape::dome ? 0.9 : 0.4) * wallAndRoof);
    }

    /// Old houses of some height have a cornice, and a string course above their shops; glass and sheds have
    /// none.
    void addLedges(BuildingPlan& planned, BuildingKind kind, std::uint32_t trim) const {
        const BuildingShape& shape = planned.shape;
        const bool windows = kind == BuildingKind::block || kind == BuildingKind::civic ||
                             kind == BuildingKind::office || kind == BuildingKind::church;
        const Pattern wall = table_[shape.wallMaterial].pattern;
        if (!windows || wall == Pattern::facadeGlass || wall == Pattern::wall ||
            shape.eaves - shape.base < 6 || area(shape.footprint) < 60)
            return;
        if (shape.roof == RoofShape::flat)
            planned.ledges.push_back({shape.eaves - 0.45f, shape.eaves + 0.25f, 0.3f, 0.4f, trim});
        else
            planned.ledges.push_back({shape.eaves - 0.35f, shape.eaves, 0.25f, 0, trim});
        const float course = shape.base + shape.groundFloorHeight;
        if (shape.groundFloorHeight > 0 && course + 2 < shape.eaves)
            planned.ledges.push_back({course - 0.12f, course + 0.14f, 0.14f, 0, trim});
    }

    void plan(const Candidate& own, const Candidate& outline, const std::vector<Footprint>& polygons,
              double top) {
        const OsmTags& tags = own.source->tags;
        const std::uint64_t hash = mixed(seed_, outline.source->id);
        const BuildingKind kind = own.kind == BuildingKind::block ? outline.kind : own.kind;
        double base = own.heights.base.value_or(0);
        if (kind == BuildingKind::canopy && !own.heights.base) base = std::max(top - canopyThickness, 0.0);
        if (top <= base) return;
        const RoofShape roof = roofShape(tags, kind);
        const bool floor = base < 0.5 && top >= leastShopBuilding && kind != BuildingKind::house &&
                           kind != BuildingKind::church && kind != BuildingKind::industrial &&
                           (hasShop(own) || ((kind == BuildingKind::block || kind == BuildingKind::office) &&
                                             atMainStreet(own)));
        const Facade facade =
            chooseFacade(tags, outline.source->tags, kind, roof != RoofShape::flat, hash, table_);
        for (const Footprint& polygon : polygons) {
            BuildingPlan planned;
            planned.id = own.source->id;
            BuildingShape& shape = planned.shape;
            shape.footprint = polygon;
            shape.base = static_cast<float>(base);
            shape.roof = roof;
            double rise = 0;
            if (roof != RoofShape::flat)
                rise = std::min(own.heights.roof.value_or(usualRise(polygon, roof, top - base)),
                                top - base - 0.1);
            // Where no such roof can be built, the flat one lies in the middle of its height.
            const bool pitched = rise > 0 && carriesRoof(polygon, roof);
            if (roof != RoofShape::flat && !pitched) {
                shape.roof = RoofShape::flat;
                rise /= 2;
            }
            shape.eaves = static_cast<float>(top - std::max(rise, 0.0));
            shape.ridge = pitched ? static_cast<float>(top) : shape.eaves;
            shape.storeyHeight = static_cast<float>(storeyHeight(kind));
            shape.bayWidth = static_cast<float>(2.6 + 1.2 * uniform(hash, 5));
            shape.groundFloorHeight = floor ? shopFloorHeight : 0;
            shape.wallMaterial = facade.wall;
            shape.groundFloorMaterial = facade.groundFloor;
            shape.roofMaterial = facade.roof;
            addLedges(planned, kind, facade.trim);
            result_.plans.push_back(std::move(planned));
        }
    }

    const OsmData& data_;
    const std::vector<std::vector<glm::vec2>>& mainStreets_;
    std::uint64_t seed_;
    MaterialTable& table_;
    std::vector<glm::vec2> shops_;
    std::vector<Candidate> outlines_;
    std::vector<Candidate> parts_;
    HeightGuess guess_;
    BuildingPlans result_;
};

}  // namespace

bool isUnderground(const OsmTags& tags) {
    if (tags.is("location", "underground") || tags.is("location", "indoor")) return true;
    if (tags.has("tunnel") && !tags.is("tunnel", "no")) return true;
    if (parseNumber(tags.get("layer")).value_or(0) < 0) return true;
    return parseNumber(tags.get("level")).value_or(0) < 0;
}

BuildingPlans planBuildings(const OsmData& data, const std::vector<std::vector<glm::vec2>>& mainStreets,
                            std::uint64_t seed, MaterialTable& table) {
    return Planner(data, mainStreets, seed, table).run();
}

}  // namespace city
