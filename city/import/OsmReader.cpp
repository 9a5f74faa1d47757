#include "city/import/OsmReader.h"

#include <osmium/area/assembler.hpp>
#include <osmium/io/any_input.hpp>
#include <osmium/osm.hpp>
#include <osmium/visitor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace city {

namespace {

/// Keys (and, after '=', values) of closed ways and multipolygons that are areas rather than lines.
constexpr const char* areaKeys[] = {"building", "building:part", "natural",  "landuse", "leisure",
                                    "water",    "amenity",       "man_made", "place"};

/// A box wider than this is not a city: the header's bounds are taken to be wrong.
constexpr double widestHeaderDegrees = 0.5;
/// Metres. Up to here a float is a position to half a millimetre (2^-11 m): cities are cut to it.
constexpr float widestHalf = 16384;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw std::runtime_error(file.string() + ": " + what);
}

/// The file's objects, in memory; of several versions of an object the newest.
struct Objects {
    std::vector<osmium::memory::Buffer> buffers;
    std::unordered_map<osmium::object_id_type, osmium::Location> locations;
    std::unordered_map<osmium::object_id_type, osmium::Node*> taggedNodes;
    std::unordered_map<osmium::object_id_type, osmium::Way*> ways;
    std::unordered_map<osmium::object_id_type, osmium::Relation*> relations;
    osmium::Box headerBox;
    std::size_t invalidNodes = 0;
};

template <typename T>
void keepNewest(std::unordered_map<osmium::object_id_type, T*>& map, T& object) {
    const auto [place, fresh] = map.try_emplace(object.id(), &object);
    if (!fresh && place->second->version() < object.version()) place->second = &object;
}

/// libosmium takes strings from .pbf files as they come, also with zero bytes within, then takes these for
/// the ends of keys and values, and after an odd number of them reads on behind the list.
bool inPairs(const osmium::TagList& tags) {
    const unsigned char* const end = tags.data() + tags.byte_size();
    const auto ends = std::count(tags.data() + sizeof(osmium::TagList), end, static_cast<unsigned char>(0));
    return tags.empty() || (ends % 2 == 0 && end[-1] == 0);
}

Objects readObjects(const osmium::io::File& file) {
    Objects objects;
    osmium::io::Reader reader{file};
    objects.headerBox = reader.header().joined_boxes();
    while (osmium::memory::Buffer buffer = reader.read()) {
        for (auto& item : buffer.select<osmium::OSMObject>()) {
            if (!item.visible()) continue;
            if (!inPairs(item.tags()))
                throw std::runtime_error("there is a zero byte in a tag of object " +
                                         std::to_string(item.id()));
            if (item.type() == osmium::item_type::node) {
                auto& node = static_cast<osmium::Node&>(item);
                if (!node.location().valid()) {
                    ++objects.invalidNodes;
                    continue;
                }
                objects.locations[node.id()] = node.location();
                if (!node.tags().empty()) keepNewest(objects.taggedNodes, node);
            } else if (item.type() == osmium::item_type::way) {
                keepNewest(objects.ways, static_cast<osmium::Way&>(item));
            } else if (item.type() == osmium::item_type::relation) {
                keepNewest(objects.relations, static_cast<osmium::Relation&>(item));
            }
        }
        objects.buffers.push_back(std::move(buffer));
    }
    reader.close();
    return objects;
}

/// Objects in the order of their ids: hash tables have none, and the same file must give the same city.
template <typename T>
std::vector<T*> inOrder(const std::unordered_map<osmium::object_id_type, T*>& map) {
    std::vector<T*> all;
    all.reserve(map.size());
    for (const auto& [id, object] : map) all.push_back(object);
    std::sort(all.begin(), all.end(), [](const T* a, const T* b) { return a->id() < b->id(); });
    return all;
}

bool isArea(const osmium::TagList& tags) {
    if (tags.has_tag("area", "no")) return false;
    if (tags.has_tag("area", "yes") || tags.has_tag("waterway", "riverbank")) return true;
    // natural=coastline closes around islands but is a line: what it encloses is land.
    if (tags.has_tag("natural", "coastline") || tags.has_tag("natural", "tree_row")) return false;
    if (tags.has_key("highway") || tags.has_key("railway") || tags.has_key("barrier"))
        return tags.has_key("building") || tags.has_key("building:part");
    return std::any_of(std::begin(areaKeys), std::end(areaKeys),
                       [&](const char* key) { return tags.has_key(key); });
}

OsmTags tagsOf(const osmium::TagList& list) {
    OsmTags tags;
    for (const osmium::Tag& tag : list) tags.add(tag.key(), tag.value());
    return tags;
}

struct GeoBox {
    double west = 0, south = 0, east = 0, north = 0;
};

/// Where the city lies: the middle of what it covers, and half of that, metres east and north of it.
struct Extent {
    LocalFrame frame;
    glm::vec2 half{0};
};

/// The rectangle inside the trapezium between two meridians.
Extent extentOf(const GeoBox& box) {
    const LocalFrame frame((box.south + box.north) / 2, (box.west + box.east) / 2, 0);
    const glm::vec2 corner(glm::abs(frame.localFromGeodetic(box.north, box.east, 0)));
    const glm::vec2 other(glm::abs(frame.localFromGeodetic(box.south, box.east, 0)));
    return {frame, glm::min(corner, other)};
}

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The rectangle of the middle 98 per cent of the nodes that buildings and streets use, in each direction.
/// Measured in metres around their median on the globe: degrees say nothing at a pole, and jump at the
/// antimeridian.
std::optional<Extent> robustExtent(const Objects& objects) {
    std::vector<osmium::Location> places;
    for (const auto& [id, way] : objects.ways) {
        if (!way->tags().has_key("building") && !way->tags().has_key("highway")) continue;
        for (const osmium::NodeRef& node : way->nodes())
            if (const auto found = objects.locations.find(node.ref()); found != objects.locations.end())
                places.push_back(found->second);
    }
    if (places.empty())
        for (const auto& [id, location] : objects.locations) places.push_back(location);
    if (places.empty()) return std::nullopt;

    constexpr double degree = std::numbers::pi / 180;
    std::array<std::vector<double>, 3> globe;
    for (const osmium::Location& place : places) {
        const double latitude = place.lat() * degree, longitude = place.lon() * degree;
        globe[0].push_back(std::cos(latitude) * std::cos(longitude));
        globe[1].push_back(std::cos(latitude) * std::sin(longitude));
        globe[2].push_back(std::sin(latitude));
    }
    const double x = median(globe[0]), y = median(globe[1]), z = median(globe[2]);
    const LocalFrame near(std::atan2(z, std::hypot(x, y)) / degree, std::atan2(y, x) / degree, 0);
    std::vector<double> east, north;
    for (const osmium::Location& place : places) {
        const glm::dvec3 local = near.localFromGeodetic(place.lat(), place.lon(), 0);
        east.push_back(local.x);
        north.push_back(local.y);
    }
    std::sort(east.begin(), east.end());
    std::sort(north.begin(), north.end());
    const std::size_t cut = places.size() / 100, last = places.size() - 1 - cut;
    const glm::dvec2 low(east[cut], north[cut]), high(east[last], north[last]);
    const glm::dvec3 middle = near.geodeticFromLocal(glm::dvec3(0.5 * (low + high), 0));
    return Extent{LocalFrame(middle.x, middle.y, 0), glm::vec2(0.5 * (high - low))};
}

class Projection {
  public:
    Projection(const Extent& extent, std::optional<double> size)
        : frame_(extent.frame), half_(glm::min(extent.half, glm::vec2(widestHalf))) {
        if (size) half_ = glm::min(half_, glm::vec2(static_cast<float>(*size / 2)));
    }
    glm::vec2 local(double latitude, double longitude) const {
        return glm::vec2(frame_.localFromGeodetic(latitude, longitude, 0));
    }
    glm::vec2 local(osmium::Location location) const { return local(location.lat(), location.lon()); }
    const LocalFrame& frame() const { return frame_; }
    glm::vec2 half() const { return half_; }

  private:
    LocalFrame frame_;
    glm::vec2 half_{0};
};

void appendPolygons(const osmium::Area& area, const Projection& projection, OsmArea& out) {
    const auto ringOf = [&](const osmium::NodeRefList& nodes) {
        std::vector<glm::vec2> ring;
        for (std::size_t i = 0; i + 1 < nodes.size(); ++i)
            ring.push_back(projection.local(nodes[i].location()));
        return ring;
    };
    for (const osmium::OuterRing& outer : area.outer_rings()) {
        Footprint footprint{ringOf(outer), {}};
        for (const osmium::InnerRing& inner : area.inner_rings(outer))
            footprint.holes.push_back(ringOf(inner));
        out.polygons.push_back(std::move(footprint));
    }
}

class AreaBuilder {
  public:
    AreaBuilder(Objects& objects, const Projection& projection, OsmData& data)
        : objects_(objects), projection_(projection), data_(data) {
        config_.ignore_invalid_locations = true;
        config_.create_empty_areas = false;
    }

    void relation(const osmium::Relation& relation) {
        const char* type = relation.tags()["type"];
        if (!type || std::string_view(type) != "multipolygon" || !isArea(relation.tags())) return;
        std::vector<const osmium::Way*> members;
        std::vector<osmium::object_id_type> outers;
        for (const osmium::RelationMember& member : relation.members()) {
            if (member.type() != osmium::item_type::way) continue;
            const auto way = objects_.ways.find(member.ref());
            if (way == objects_.ways.end()) {
                ++data_.incompleteRelations;
                return;
            }
            members.push_back(way->second);
            if (std::string_view(member.role()) != "inner") outers.push_back(member.ref());
        }
        if (members.empty()) return;
        const bool built = assemble(-relation.id(), relation.tags(), [&](osmium::memory::Buffer& buffer) {
            osmium::area::Assembler assembler{config_};
            return assembler(relation, members, buffer);
        });
        if (!built) return;
        if (relation.tags().has_key("building")) outersOfBuildings_.insert(outers.begin(), outers.end());
    }

    /// After all relations: a way that is the outer ring of a building relation is not a building again.
    void way(const osmium::Way& way) {
        if (way.nodes().size() < 4 || way.nodes().front().ref() != way.nodes().back().ref() ||
            !isArea(way.tags()))
            return;
        if (way.tags().has_key("building") && outersOfBuildings_.contains(way.id())) return;
        // A ring with unknown nodes is closed by chords between those that are known.
        std::vector<glm::vec2> known;
        for (const osmium::NodeRef& node : way.nodes())
            if (node.location().valid()) known.push_back(projection_.local(node.location()));
        if (known.size() < way.nodes().size()) {
            if (known.size() < 4)
                ++data_.areasWithoutNodes;
            else
                keep({way.id(), {{known, {}}}, tagsOf(way.tags())});
            return;
        }
        assemble(way.id(), way.tags(), [&](osmium::memory::Buffer& buffer) {
            osmium::area::Assembler assembler{config_};
            return assembler(way, buffer);
        });
    }

  private:
    template <typename Assemble>
    bool assemble(std::int64_t id, const osmium::TagList& tags, const Assemble& run) {
        osmium::memory::Buffer buffer{1024, osmium::memory::Buffer::auto_grow::yes};
        OsmArea area;
        area.id = id;
        try {
            run(buffer);
            for (const osmium::Area& assembled : buffer.select<osmium::Area>())
                appendPolygons(assembled, projection_, area);
        } catch (const osmium::invalid_location&) {
            area.polygons.clear();
        }
        if (area.polygons.empty()) {
            ++data_.brokenAreas;
            return false;
        }
        area.tags = tagsOf(tags);
        keep(std::move(area));
        return true;
    }

    void keep(OsmArea area) {
        if (area.tags.has("building") || area.tags.has("building:part"))
            for (const Footprint& polygon : area.polygons) data_.innerRings += polygon.holes.size();
        data_.areas.push_back(std::move(area));
    }

    Objects& objects_;
    const Projection& projection_;
    OsmData& data_;
    osmium::area::AssemblerConfig config_;
    std::unordered_set<osmium::object_id_type> outersOfBuildings_;
};

Extent extentOf(const Objects& objects, const std::filesystem::path& file) {
    const osmium::Box& box = objects.headerBox;
    if (box.valid() && box.top_right().lon() > box.bottom_left().lon() &&
        box.top_right().lat() > box.bottom_left().lat() &&
        box.top_right().lon() - box.bottom_left().lon() < widestHeaderDegrees)
        return extentOf(
            {box.bottom_left().lon(), box.bottom_left().lat(), box.top_right().lon(), box.top_right().lat()});
    const std::optional<Extent> robust = robustExtent(objects);
    if (!robust)
        fail(file, "holds no nodes, so there is no city in it; export the area again with its nodes");
    return *robust;
}

/// `file`: for messages.
OsmData readFrom(const osmium::io::File& source, const std::filesystem::path& file,
                 std::optional<double> size) {
    Objects objects;
    try {
        objects = readObjects(source);
    } catch (const std::exception& e) {
        fail(file, std::string("cannot be read as OpenStreetMap data (") + e.what() +
                       "); it is truncated or damaged: download it again");
    }
    if (objects.locations.empty())
        fail(file, "holds no nodes, so there is no city in it; export the area again with its nodes");

    const Extent extent = extentOf(objects, file);
    const Projection projection(extent, size);
    OsmData data;
    data.frame = projection.frame();
    data.halfSize = projection.half();
    data.cutToWidest = std::max(extent.half.x, extent.half.y) > widestHalf && !size;
    if (!(data.halfSize.x > 1 && data.halfSize.y > 1))
        fail(file, "its bounds are less than two metres wide; export a larger area");

    for (const osmium::Node* node : inOrder(objects.taggedNodes))
        data.points.push_back({node->id(), projection.local(node->location()), tagsOf(node->tags())});
    const std::vector<osmium::Way*> ways = inOrder(objects.ways);
    for (osmium::Way* way : ways) {
        OsmLine line;
        line.id = way->id();
        for (osmium::NodeRef& node : way->nodes()) {
            const auto found = objects.locations.find(node.ref());
            if (found == objects.locations.end()) {
                ++data.missingNodeReferences;
                if (!line.nodes.empty()) line.gaps.insert(line.nodes.size());
                continue;
            }
            node.set_location(found->second);
            line.nodes.push_back(node.ref());
            line.points.push_back(projection.local(found->second));
        }
        if (way->tags().empty() || line.nodes.size() < 2) continue;
        line.tags = tagsOf(way->tags());
        data.lines.push_back(std::move(line));
    }
    AreaBuilder builder(objects, projection, data);
    for (osmium::Relation* relation : inOrder(objects.relations)) builder.relation(*relation);
    for (osmium::Way* way : ways) builder.way(*way);
    return data;
}

}  // namespace

OsmData readOsm(const std::filesystem::path& file, std::optional<double> size) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) fail(file, "no such file; check the path");
    if (!std::filesystem::is_regular_file(file, error))
        fail(file, "not a file; name an .osm or .osm.pbf file");
    if (std::filesystem::file_size(file, error) == 0) fail(file, "is empty; download it again");
    return readFrom(osmium::io::File{file.string()}, file, size);
}

OsmData readOsm(std::string_view bytes, const std::string& format, std::optional<double> size) {
    const std::filesystem::path name = "OpenStreetMap data";
    if (bytes.empty()) fail(name, "is empty");
    return readFrom(osmium::io::File{bytes.data(), bytes.size(), format}, name, size);
}

}  // namespace city
