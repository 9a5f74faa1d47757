#include "city/model/Ledge.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>

namespace city {
namespace {

const Footprint house{{{0, 0}, {20, 0}, {20, 10}, {0, 10}}, {{{5, 3}, {15, 3}, {15, 7}, {5, 7}}}};

double area(const Mesh& mesh, float z, float normalZ) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vertex& a = mesh.vertices[mesh.indices[i]];
        if (a.normal.z != normalZ || a.position.z != z) continue;
        const glm::dvec3 p = a.position;
        const glm::dvec3 q = mesh.vertices[mesh.indices[i + 1]].position;
        const glm::dvec3 r = mesh.vertices[mesh.indices[i + 2]].position;
        const glm::dvec3 n = glm::cross(q - p, r - p);
        EXPECT_GT(n.z * normalZ, 0);
        sum += 0.5 * glm::length(n);
    }
    return sum;
}

TEST(Ledge, StringCourseGoesAroundTheOutsideAlone) {
    Mesh mesh;
    appendLedge(house, {4, 4.5f, 0.5f, 0, 3}, mesh);
    EXPECT_NEAR(area(mesh, 4.5f, 1), 21 * 11 - 200, 0.01);
    EXPECT_NEAR(area(mesh, 4, -1), 21 * 11 - 200, 0.01);
    for (const Vertex& v : mesh.vertices) {
        EXPECT_EQ(v.material, 3u);
        if (v.normal.z != 0) continue;
        EXPECT_GT(glm::dot(glm::vec2(v.normal), glm::vec2(v.position) - glm::vec2(10, 5)), 0);
    }
}

TEST(Ledge, ParapetReachesBehindTheWall) {
    Mesh mesh;
    appendLedge(house, {9, 10, 0.5f, 0.5f, 0}, mesh);
    EXPECT_NEAR(area(mesh, 10, 1), 21 * 11 - 19 * 9, 0.01);
    int inwards = 0;
    for (const Vertex& v : mesh.vertices)
        inwards +=
            v.normal.z == 0 && glm::dot(glm::vec2(v.normal), glm::vec2(v.position) - glm::vec2(10, 5)) < 0;
    EXPECT_EQ(inwards, 16);
}

TEST(Ledge, NothingWithoutExtent) {
    Mesh mesh;
    appendLedge({{{0, 0}, {5, 5}}, {}}, {4, 5, 0.5f, 0, 0}, mesh);
    appendLedge(house, {4, 4, 0.5f, 0, 0}, mesh);
    appendLedge(house, {4, 5, 0, 0, 0}, mesh);
    appendLedge(house, {4, std::numeric_limits<float>::infinity(), 0.5f, 0, 0}, mesh);
    appendLedge(house, {std::numeric_limits<float>::quiet_NaN(), 5, 0.5f, 0, 0}, mesh);
    EXPECT_TRUE(mesh.vertices.empty());
}

}  // namespace
}  // namespace city
