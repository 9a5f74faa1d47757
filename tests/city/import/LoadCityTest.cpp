#include "city/import/LoadCity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "city/import/OsmBuildings.h"
#include "city/import/OsmReader.h"
#include "city/import/OsmStreets.h"
#include "city/import/StreetWidths.h"
#include "city/model/PolygonAlgebra.h"
#include "city/roads/BuildRoadNetwork.h"
#include "tests/city/import/OsmText.h"

namespace city {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string failure(const std::filesystem::path& file, const ImportOptions& options = {}) {
    try {
        loadCity(file, options);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "no error";
}

/// A crossing with signals, houses, a park with a pond, trees and lamps.
OsmText town() {
    OsmText text;
    text.bounds(150);
    const long middle = text.node(0, 0, {{"highway", "traffic_signals"}});
    text.way({text.node(-400, 0), middle, text.node(400, 0)}, {{"highway", "primary"}, {"lanes", "2"}});
    text.way({text.node(0, -400), middle, text.node(0, 400)}, {{"highway", "residential"}});
    text.box(15, 15, 60, 50, {{"building", "apartments"}, {"building:levels", "5"}});
    text.box(-60, 15, -15, 50, {{"building", "yes"}, {"height", "20"}});
    text.box(15, -50, 60, -15, {{"building", "house"}, {"height", "9"}});
    text.box(-100, -100, -20, -20, {{"leisure", "park"}});
    text.box(-80, -80, -50, -50, {{"natural", "water"}});
    text.node(-30, -30, {{"natural", "tree"}});
    text.node(30, 8, {{"highway", "street_lamp"}});
    text.line({{-90, -40}, {-40, -40}}, {{"natural", "tree_row"}});
    return text;
}

void expectSound(const CityModel& model) {
    for (const Chunk& chunk : model.chunks) {
        for (const Vertex& v : chunk.mesh.vertices) {
            ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
            ASSERT_NEAR(glm::dot(v.normal, v.normal), 1, 1e-3);
            ASSERT_TRUE(std::isfinite(v.texcoord.x + v.texcoord.y));
            ASSERT_LT(v.material, model.materials.size());
        }
        for (const std::uint32_t i : chunk.mesh.indices) ASSERT_LT(i, chunk.mesh.vertices.size());
        ASSERT_FALSE(chunk.bounds.empty());
    }
    for (const Placement& placement : model.placements)
        ASSERT_LT(placement.prototype, model.prototypes.size());
    for (const Lane& lane : model.roads.lanes) ASSERT_GE(lane.centreLine.size(), 2u);
    for (const SignalHead& head : model.signalHeads) ASSERT_LT(head.junction, model.roads.junctions.size());
}

TEST(LoadCity, TownHasAllItsParts) {
    const CityModel model = loadCity(town().save("town.osm"), {});
    expectSound(model);
    EXPECT_GE(model.roads.lanes.size(), 8u);
    EXPECT_FALSE(model.signalHeads.empty());
    EXPECT_GE(model.placements.size(), 9u);
    ASSERT_TRUE(model.frame);
    EXPECT_NEAR(model.frame->latitude(), 60, 1e-5);
    EXPECT_NEAR(model.frame->longitude(), 25, 1e-5);
    EXPECT_NEAR(model.bounds.max.x, 150, 1);
    EXPECT_NEAR(model.bounds.max.z, 20, 1);
    EXPECT_THAT(model.notes, Contains(HasSubstr("3 buildings")));
    // Streets far outside are cut at the bounds.
    for (const Lane& lane : model.roads.lanes)
        for (const glm::vec3& p : lane.centreLine) EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 151);
}

TEST(LoadCity, GroundIsPartedWithoutOverlap) {
    const CityModel model = loadCity(town().save("ground.osm"), {});
    double flat = 0;
    double water = 0;
    for (const Chunk& chunk : model.chunks) {
        if (chunk.kind != ChunkKind::ground) continue;
        for (std::size_t i = 0; i < chunk.mesh.indices.size(); i += 3) {
            const Vertex& a = chunk.mesh.vertices[chunk.mesh.indices[i]];
            const Vertex& b = chunk.mesh.vertices[chunk.mesh.indices[i + 1]];
            const Vertex& c = chunk.mesh.vertices[chunk.mesh.indices[i + 2]];
            if (a.normal.z < 0.9f) continue;
            const double size =
                0.5 * ((double(b.position.x) - a.position.x) * (double(c.position.y) - a.position.y) -
                       (double(b.position.y) - a.position.y) * (double(c.position.x) - a.position.x));
            const bool isWater = model.materials[a.material].pattern == Pattern::water;
            if (isWater) water += size;
            if (isWater || std::abs(a.position.z + 0.05f) < 1e-4f) flat += size;
        }
    }
    EXPECT_NEAR(water, 900, 10);
    EXPECT_NEAR(flat, 300.0 * 300.0, 0.002 * 300 * 300);
}

TEST(LoadCity, NothingStandsInTheCarriageway) {
    OsmText text = town();
    text.node(-60, 0.5, {{"natural", "tree"}});
    text.node(60, -2, {{"highway", "street_lamp"}});
    const CityModel model = loadCity(text.save("carriageway.osm"), {});
    for (const Placement& placement : model.placements) {
        const glm::vec3 foot(placement.worldFromPrototype[3]);
        if (std::abs(foot.x) < 20) continue;  // the other street
        EXPECT_GT(std::abs(foot.y), 3.5f);
    }
}

TEST(LoadCity, SameSeedSameCityAndOtherSeedOtherFaces) {
    const auto file = town().save("seed.osm");
    ImportOptions options;
    const auto first = loadCity(file, options).contentHash();
    EXPECT_EQ(loadCity(file, options).contentHash(), first);
    options.seed = 2;
    EXPECT_NE(loadCity(file, options).contentHash(), first);
}

TEST(LoadCity, SizeCutsTheCity) {
    ImportOptions options;
    options.size = 80;
    const CityModel model = loadCity(town().save("size.osm"), options);
    EXPECT_NEAR(model.bounds.max.x, 60, 0.5);  // houses stay whole; their middles lie within
    for (const Lane& lane : model.roads.lanes)
        for (const glm::vec3& p : lane.centreLine) EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 41);
}

TEST(LoadCity, CoastlineClosesTheSeaOnItsRight) {
    OsmText text;
    text.bounds(100);
    text.box(10, 10, 30, 30, {{"building", "yes"}});
    // Land to the north: the line runs west to east, water on its right is in the south; one end falls short.
    text.line({{-150, -20}, {0, -25}, {60, -20}}, {{"natural", "coastline"}});
    const CityModel model = loadCity(text.save("coast.osm"), {});
    float highest = -1000;
    bool water = false;
    for (const Chunk& chunk : model.chunks) {
        for (const Vertex& v : chunk.mesh.vertices) {
            if (model.materials[v.material].pattern != Pattern::water) continue;
            water = true;
            highest = std::max(highest, v.position.y);
        }
    }
    EXPECT_TRUE(water);
    EXPECT_LT(highest, -15);
}

TEST(LoadCity, UnsortedFileGivesTheSameCity) {
    // Ways before nodes, and the file's bounds from its data.
    const char* content =
        "<osm version='0.6'><way id='9' version='1'><nd ref='1'/><nd ref='2'/><tag k='highway' "
        "v='primary'/></way>"
        "<node id='2' version='1' lat='60.001' lon='25.001'/><node id='1' version='1' lat='60' "
        "lon='25'/></osm>";
    const CityModel model = loadCity(OsmText::saveText("unsorted.osm", content), {});
    EXPECT_FALSE(model.roads.lanes.empty());
}

TEST(LoadCity, BadFilesAreNamedWithCauseAndRemedy) {
    const std::string folder = (std::filesystem::path(MIRRORSTREET_TEST_OUT) / "osm").string();
    EXPECT_THAT(failure(folder + "/absent.osm"), AllOf(HasSubstr("absent.osm"), HasSubstr("no such file")));
    EXPECT_THAT(failure(OsmText::saveText("empty.osm", "")), HasSubstr("is empty"));
    EXPECT_THAT(failure(OsmText::saveText("city.xyz", "x")),
                AllOf(HasSubstr("unknown kind"), HasSubstr(".osm.pbf")));
    const std::string whole = town().str();
    EXPECT_THAT(failure(OsmText::saveText("half.osm", whole.substr(0, whole.size() / 2))),
                HasSubstr("truncated"));
    EXPECT_THAT(failure(OsmText::saveText("noise.osm.pbf", "this is no protocol buffer at all")),
                HasSubstr("cannot be read"));
    EXPECT_THAT(failure(OsmText::saveText("none.osm", "<osm version='0.6'></osm>")), HasSubstr("no nodes"));
    EXPECT_THAT(
        failure(OsmText::saveText("nan.osm", "<osm version='0.6'><node id='1' lat='nan' lon='nan'/></osm>")),
        StartsWith(folder));
    OsmText bare;
    bare.bounds(100);
    bare.node(0, 0);
    bare.node(10, 10);
    EXPECT_THAT(failure(bare.save("bare.osm")), HasSubstr("neither buildings nor streets"));
    ImportOptions options;
    options.size = std::nan("");
    EXPECT_THAT(failure(town().save("nansize.osm"), options), HasSubstr("at least 10 m"));
    EXPECT_THAT(failure(std::filesystem::path(MIRRORSTREET_TEST_OUT)), HasSubstr("unknown kind"));
}

std::filesystem::path helsinki() {
    const char* shared = std::getenv("MIRRORSTREET_SHARED_DATA");
    const std::filesystem::path folder =
        shared ? std::filesystem::path(shared)
               : std::filesystem::path(MIRRORSTREET_SOURCE_DIR) / "../shared/data";
    return folder / "osm/helsinki_centre_2019.osm.pbf";
}

TEST(LoadCity, HelsinkiHoldsWhatItsFileHolds) {
    if (!std::filesystem::exists(helsinki())) GTEST_SKIP() << helsinki() << " is not here";
    const OsmData data = readOsm(helsinki(), {});
    EXPECT_EQ(data.missingNodeReferences, 4525u);
    EXPECT_EQ(data.innerRings, 87u);
    std::size_t multipolygons = 0;
    std::size_t buildings = 0;
    std::size_t known = 0;
    std::size_t trees = 0;
    std::size_t lamps = 0;
    std::size_t signals = 0;
    for (const OsmArea& area : data.areas) {
        if (!area.tags.has("building") && !area.tags.has("building:part")) continue;
        ++buildings;
        multipolygons += area.id < 0;
        known += area.tags.has("height") || area.tags.has("building:levels");
    }
    for (const OsmPoint& point : data.points) {
        trees += point.tags.is("natural", "tree");
        lamps += point.tags.is("highway", "street_lamp");
        signals += point.tags.is("highway", "traffic_signals");
    }
    EXPECT_EQ(multipolygons, 72u);
    EXPECT_GE(buildings, 572u);  // and those cut by the file's border
    EXPECT_GE(known, 266u);
    EXPECT_EQ(trees, 649u);
    EXPECT_EQ(lamps, 586u);
    EXPECT_EQ(signals, 135u);
}

TEST(LoadCity, HelsinkiIsSoundAndDrivable) {
    if (!std::filesystem::exists(helsinki())) GTEST_SKIP() << helsinki() << " is not here";
    ImportOptions options;
    options.size = 600;
    const CityModel model = loadCity(helsinki(), options);
    expectSound(model);
    EXPECT_GT(model.roads.lanes.size(), 100u);
    std::size_t trams = 0;
    for (const Lane& lane : model.roads.lanes) trams += lane.kind == LaneKind::tram;
    EXPECT_GT(trams, 20u);
    EXPECT_GT(model.signalHeads.size(), 20u);
    EXPECT_GT(model.notes.size(), 5u);
}

TEST(LoadCity, NoLaneOfHelsinkiRunsThroughABuilding) {
    if (!std::filesystem::exists(helsinki())) GTEST_SKIP() << helsinki() << " is not here";
    const OsmData data = readOsm(helsinki(), {});
    StreetPlan streets = planStreets(data);
    MaterialTable table;
    std::vector<Footprint> buildings;
    for (const BuildingPlan& plan : planBuildings(data, streets.mainStreets, 1, table).plans)
        if (plan.shape.base < 4) buildings.push_back(plan.shape.footprint);
    fitStreetsBetween(buildings, streets.graph);
    std::size_t points = 0;
    std::size_t inside = 0;
    for (const Lane& lane : buildRoadNetwork(streets.graph).lanes) {
        for (const glm::vec3& p : lane.centreLine) {
            ++points;
            inside += std::any_of(buildings.begin(), buildings.end(), [&](const Footprint& building) {
                return contains(building, glm::vec2(p));
            });
        }
    }
    EXPECT_GT(points, 4000u);
    EXPECT_EQ(inside, 0u);
}

TEST(LoadCity, TruncatedHelsinkiSaysSo) {
    if (!std::filesystem::exists(helsinki())) GTEST_SKIP() << helsinki() << " is not here";
    std::ifstream in(helsinki(), std::ios::binary);
    std::stringstream content;
    content << in.rdbuf();
    const std::string whole = content.str();
    EXPECT_THAT(failure(OsmText::saveText("truncated.osm.pbf", whole.substr(0, whole.size() / 3))),
                HasSubstr("truncated or damaged"));
}

}  // namespace
}  // namespace city
