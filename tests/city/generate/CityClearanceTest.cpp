#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "city/generate/Boulevard.h"
#include "city/generate/PaperCity.h"
#include "city/terrain/Heightfield.h"
#include "city/terrain/Rasterise.h"

namespace {

constexpr float cell = 0.25f;
constexpr float clearHeight = 4.2f;  // metres: what hangs higher is above every vehicle

/// The triangles whose lowest corner lies below `ceiling`.
city::Mesh below(const city::Mesh& mesh, const glm::mat4& worldFromMesh, float ceiling) {
    city::Mesh low;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        city::Vertex v[3];
        float bottom = 1e9f;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = mesh.vertices[mesh.indices[t + k]];
            v[k].position = glm::vec3(worldFromMesh * glm::vec4(v[k].position, 1));
            bottom = std::min(bottom, v[k].position.z);
        }
        if (bottom < ceiling) low.addTriangle(v[0], v[1], v[2]);
    }
    return low;
}

/// Everything but the ground, as seen from above after what hangs higher than `ceiling` has been taken away.
city::Heightfield obstacles(const city::CityModel& city, float ceiling, bool onlyBuildings) {
    const glm::vec3 size = city.bounds.size();
    city::Heightfield field(static_cast<int>(size.x / cell) + 1, static_cast<int>(size.y / cell) + 1, cell,
                            glm::dvec2(city.bounds.min));
    for (const city::Chunk& chunk : city.chunks) {
        if (chunk.kind == city::ChunkKind::ground ||
            (onlyBuildings && chunk.kind != city::ChunkKind::building))
            continue;
        city::rasterise(below(chunk.mesh, glm::mat4(1), ceiling), glm::mat4(1), city::Coverage::any, field);
    }
    if (onlyBuildings) return field;
    for (const city::Placement& placement : city.placements) {
        const city::Mesh& mesh = city.prototypes[placement.prototype].levels.front().mesh;
        city::rasterise(below(mesh, placement.worldFromPrototype, ceiling), glm::mat4(1), city::Coverage::any,
                        field);
    }
    return field;
}

/// Calls `visit` for points every half metre along all lanes and ways across junctions, with the direction
/// there.
void alongLanes(const city::RoadNetwork& roads,
                const std::function<void(glm::vec3, glm::vec3, float)>& visit) {
    const auto walk = [&](const std::vector<glm::vec3>& line, float width) {
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const float length = glm::length(line[i + 1] - line[i]);
            if (!(length > 0)) continue;
            const glm::vec3 along = (line[i + 1] - line[i]) / length;
            for (float s = 0; s <= length; s += 0.5f) visit(line[i] + s * along, along, width);
        }
    };
    for (const city::Lane& lane : roads.lanes) walk(lane.centreLine, lane.width);
    for (const city::Connection& way : roads.connections) walk(way.centreLine, 2.2f);
}

void expectLanesClear(const city::CityModel& city) {
    const city::Heightfield field = obstacles(city, clearHeight, false);
    std::size_t points = 0, blocked = 0;
    glm::vec3 first(0);
    alongLanes(city.roads, [&](glm::vec3 p, glm::vec3 along, float width) {
        const glm::vec3 right(along.y, -along.x, 0);
        // A quarter of a metre inside the lane's edges: the field's cells are that coarse.
        for (const float t : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f}) {
            const glm::vec3 q = p + t * (0.5f * width - cell) * right;
            ++points;
            if (field.heightAt(q.x, q.y) > 0.3f && ++blocked == 1) first = q;
        }
    });
    EXPECT_GT(points, 1000u);
    EXPECT_EQ(blocked, 0u) << "first at " << first.x << ", " << first.y;
}

void expectTourClear(const city::CityModel& city, float shortest) {
    ASSERT_GT(city.tour.size(), 10u);
    EXPECT_GE(city.tour.back().time, shortest);
    EXPECT_LE(city.tour.back().time, 65);
    const city::Heightfield walls = obstacles(city, 1e9f, true);
    for (std::size_t i = 0; i + 1 < city.tour.size(); ++i) {
        EXPECT_LT(city.tour[i].time, city.tour[i + 1].time);
        for (const float t : {0.0f, 0.25f, 0.5f, 0.75f}) {
            const glm::vec3 eye = glm::mix(city.tour[i].eye, city.tour[i + 1].eye, t);
            EXPECT_GE(eye.z, 1.4f);
            EXPECT_LE(eye.z, 8.5f);
            EXPECT_LT(walls.heightAt(eye.x, eye.y), 0.3f) << eye.x << ", " << eye.y;
            EXPECT_GT(glm::length(city.tour[i].target - city.tour[i].eye), 1);
        }
    }
    // Nothing that stands in the city may come within a third of a metre of the eye.
    for (const city::Placement& placement : city.placements) {
        const city::Mesh& mesh = city.prototypes[placement.prototype].levels.front().mesh;
        const glm::vec3 foot(placement.worldFromPrototype[3]);
        for (std::size_t i = 0; i + 1 < city.tour.size(); ++i) {
            if (glm::length(glm::vec2(city.tour[i].eye - foot)) > 18) continue;
            for (const city::Vertex& v : mesh.vertices) {
                const glm::vec3 p(placement.worldFromPrototype * glm::vec4(v.position, 1));
                for (const float t : {0.0f, 0.5f}) {
                    const glm::vec3 eye = glm::mix(city.tour[i].eye, city.tour[i + 1].eye, t);
                    ASSERT_GT(glm::length(p - eye), 0.33f)
                        << city.prototypes[placement.prototype].name << " at " << city.tour[i].time << " s";
                }
            }
        }
    }
}

}  // namespace

TEST(CityClearance, nothingStandsInTheLanesOfTheBoulevard) {
    expectLanesClear(city::generateBoulevard());
    expectLanesClear(city::generateBoulevard({5, 330}));
}

TEST(CityClearance, nothingStandsInTheLanesOfThePaperCity) {
    expectLanesClear(city::generatePaperCity());
}

TEST(CityClearance, theToursAreFree) {
    expectTourClear(city::generateBoulevard(), 35);
    expectTourClear(city::generateBoulevard({7, 240}), 15);
    expectTourClear(city::generatePaperCity(), 35);
}

TEST(CityClearance, signalHeadsStandBesideTheirLanes) {
    const city::CityModel city = city::generateBoulevard();
    ASSERT_FALSE(city.signalHeads.empty());
    for (const city::SignalHead& head : city.signalHeads) {
        EXPECT_NEAR(glm::length(head.facing), 1, 1e-4);
        ASSERT_LT(head.junction, city.roads.junctions.size());
        float nearest = 1e9f;
        for (const city::Lane& lane : city.roads.lanes) {
            if (lane.centreLine.empty()) continue;
            nearest = std::min(nearest, glm::length(glm::vec2(lane.centreLine.back() - head.position)));
        }
        EXPECT_GT(nearest, 1.5f);
        EXPECT_LT(nearest, 5);
    }
}
