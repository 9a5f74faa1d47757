#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>

#include "city/roads/BuildRoadNetwork.h"
#include "city/roads/StreetAreas.h"
#include "city/roads/StreetSurfaces.h"
#include "tests/city/roads/TestStreets.h"

namespace {

const city::StreetMaterials materials{0, 1, 2, 3, 4, 5};

city::Mesh whole(const city::StreetGraph& graph) {
    city::Mesh all;
    for (const city::Mesh& piece : city::buildStreetSurfaces(graph, materials, 100)) all.append(piece);
    return all;
}

/// Set MIRRORSTREET_STREETS_SVG to a folder to look at the result.
void draw(const city::Mesh& mesh, const char* name) {
    const char* folder = std::getenv("MIRRORSTREET_STREETS_SVG");
    if (folder == nullptr) return;
    const city::Aabb box = mesh.bounds();
    std::ofstream svg(std::string(folder) + "/" + name + ".svg");
    const char* colours[] = {"#555", "#bbb", "#eee", "#fff", "#7a6a55", "#224"};
    svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='" << box.min.x << ' ' << -box.max.y << ' '
        << box.size().x << ' ' << box.size().y << "' width='1600'><rect x='" << box.min.x << "' y='"
        << -box.max.y << "' width='100%' height='100%' fill='#8a8'/>\n";
    std::multimap<float, std::size_t> order;
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
        order.emplace(mesh.vertices[mesh.indices[3 * t]].position.z, t);
    }
    for (const auto& [z, t] : order) {
        svg << "<polygon fill='" << colours[mesh.vertices[mesh.indices[3 * t]].material] << "' points='";
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 p = mesh.vertices[mesh.indices[3 * t + k]].position;
            svg << p.x << ',' << -p.y << ' ';
        }
        svg << "'/>\n";
    }
    svg << "</svg>\n";
}

double areaOf(const city::Mesh& mesh, std::uint32_t material, bool flat) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
        const city::Vertex& a = mesh.vertices[mesh.indices[3 * t]];
        const city::Vertex& b = mesh.vertices[mesh.indices[3 * t + 1]];
        const city::Vertex& c = mesh.vertices[mesh.indices[3 * t + 2]];
        if (a.material != material || (a.normal.z > 0.5f) != flat) continue;
        sum += 0.5 * glm::length(glm::cross(b.position - a.position, c.position - a.position));
    }
    return sum;
}

TEST(StreetSurfaces, trianglesFaceTheirNormalsAndAreFinite) {
    const city::Mesh mesh = whole(test_streets::grid(3, 100, true));
    ASSERT_GT(mesh.triangleCount(), 100U);
    EXPECT_LT(mesh.triangleCount(), 20000U);
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
        const city::Vertex& a = mesh.vertices[mesh.indices[3 * t]];
        const city::Vertex& b = mesh.vertices[mesh.indices[3 * t + 1]];
        const city::Vertex& c = mesh.vertices[mesh.indices[3 * t + 2]];
        const glm::vec3 n = glm::cross(b.position - a.position, c.position - a.position);
        ASSERT_TRUE(std::isfinite(n.x + n.y + n.z));
        ASSERT_GE(glm::dot(n, a.normal), 0);
    }
    draw(mesh, "grid");
}

TEST(StreetSurfaces, carriagewayCoversEveryLaneAndConnection) {
    for (const bool roundabout : {false, true}) {
        const city::StreetGraph graph =
            roundabout ? test_streets::roundabout(18, 60) : test_streets::grid(3, 100, true);
        const city::StreetAreas areas = city::areasOf(city::layOutStreets(graph));
        const city::RoadNetwork roads = city::buildRoadNetwork(graph);
        const auto covered = [&](const glm::vec3& p) {
            const city::Region spot = city::Region::disc(glm::dvec3(p), 0.7);
            return spot.within(areas.carriageway).area() > 0.99 * spot.area();
        };
        for (const city::Lane& lane : roads.lanes) {
            for (const glm::vec3& p : lane.centreLine) EXPECT_TRUE(covered(p)) << p.x << ' ' << p.y;
        }
        for (const city::Connection& way : roads.connections) {
            const glm::vec3 p = way.centreLine[way.centreLine.size() / 2];
            EXPECT_TRUE(covered(p)) << p.x << " " << p.y;
        }
    }
}

TEST(StreetSurfaces, areasDoNotOverlap) {
    for (const city::StreetGraph& graph :
         {test_streets::grid(3, 100, true), test_streets::tramStreet(7, true)}) {
        const city::StreetAreas areas = city::areasOf(city::layOutStreets(graph));
        EXPECT_LT(areas.carriageway.within(areas.pavement).area(), 0.01);
        EXPECT_LT(areas.carriageway.within(areas.kerb).area(), 0.01);
        EXPECT_LT(areas.carriageway.within(areas.tramBed).area(), 0.01);
        EXPECT_LT(areas.pavement.within(areas.kerb).area(), 0.01);
        EXPECT_LT(areas.pavement.within(areas.tramBed).area(), 0.01);
    }
}

TEST(StreetSurfaces, meshCarriesTheWholeArea) {
    const city::StreetGraph graph = test_streets::tramStreet(7, true);
    const city::Mesh mesh = whole(graph);
    const city::StreetAreas areas = city::areasOf(city::layOutStreets(graph));
    EXPECT_NEAR(areaOf(mesh, materials.asphalt, true), areas.carriageway.area(), 0.5);
    EXPECT_NEAR(areaOf(mesh, materials.pavement, true), areas.pavement.area(), 0.5);
    EXPECT_NEAR(areaOf(mesh, materials.tramBed, true), areas.tramBed.area(), 0.5);
    EXPECT_GT(areaOf(mesh, materials.rail, true), 4 * 300 * 0.07);
    EXPECT_GT(areaOf(mesh, materials.marking, true), 50);
    EXPECT_GT(areaOf(mesh, materials.kerb, false), 50);
    draw(mesh, "tram");
}

TEST(StreetSurfaces, layersKeepTheirDistance) {
    const city::Mesh mesh = whole(test_streets::tramStreet(0, true));
    const std::map<std::uint32_t, float> heights{{0, 0.0f}, {1, 0.12f}, {3, 0.012f}, {4, 0.0f}, {5, 0.024f}};
    for (const city::Vertex& v : mesh.vertices) {
        if (const auto h = heights.find(v.material); h != heights.end()) {
            EXPECT_FLOAT_EQ(v.position.z, h->second);
        }
    }
    draw(mesh, "tram_lanes");
    draw(whole(test_streets::roundabout(18, 60)), "roundabout");
}

TEST(StreetSurfaces, noStreetsNoSurfaces) {
    EXPECT_TRUE(city::buildStreetSurfaces({}, materials).empty());
}

}  // namespace
