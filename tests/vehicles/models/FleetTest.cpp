#include "vehicles/models/Fleet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "vehicles/models/Levels.h"

namespace vehicles {
namespace {

const std::vector<VehicleModel>& fleet() {
    static const std::vector<VehicleModel> models = builtInFleet();
    return models;
}

struct Expected {
    const char* name;
    float length, width, height;
};
const Expected expected[] = {{"hatchback", 4.10f, 1.76f, 1.47f},
                             {"saloon", 4.75f, 1.83f, 1.45f},
                             {"van", 5.30f, 2.00f, 2.20f},
                             {"bus", 12.0f, 2.55f, 3.10f},
                             {"tram", 14.7f, 2.40f, 3.40f}};

/// The box of what is painted: mirrors' glass, arms and the pantograph stay out of a vehicle's papers, too.
city::Aabb shellBox(const VehicleModel& model) {
    city::Aabb box;
    for (const city::Vertex& v : model.levels[0].body.vertices)
        // Door mirrors are paint as well, but they stand above the belt.
        if (v.material == static_cast<std::uint32_t>(Surface::paint) && v.position.z < 0.42f * model.height)
            box.extend(v.position);
    return box;
}

/// The vertical line through (x, y): the triangles' heights where it meets them.
std::vector<float> heightsAt(const city::Mesh& mesh, float x, float y) {
    std::vector<float> out;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::vec3& a = mesh.vertices[mesh.indices[i]].position;
        const glm::vec3& b = mesh.vertices[mesh.indices[i + 1]].position;
        const glm::vec3& c = mesh.vertices[mesh.indices[i + 2]].position;
        const float area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if (std::abs(area) < 1e-12f) continue;
        const float v = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
        const float w = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
        if (v >= 0 && w >= 0 && v + w <= 1) out.push_back(a.z + v * (b.z - a.z) + w * (c.z - a.z));
    }
    return out;
}

TEST(Fleet, HasTheFiveVehiclesInTheirOrder) {
    ASSERT_EQ(fleet().size(), std::size(expected));
    for (std::size_t i = 0; i < fleet().size(); ++i) EXPECT_EQ(fleet()[i].name, expected[i].name);
}

TEST(Fleet, MeasuresWhatItSaysAndWhatSuchVehiclesMeasure) {
    for (std::size_t i = 0; i < fleet().size(); ++i) {
        const VehicleModel& m = fleet()[i];
        SCOPED_TRACE(m.name);
        EXPECT_NEAR(m.length, expected[i].length, 0.02f * expected[i].length);
        EXPECT_NEAR(m.width, expected[i].width, 0.02f * expected[i].width);
        EXPECT_NEAR(m.height, expected[i].height, 0.02f * expected[i].height);
        const glm::vec3 size = shellBox(m).size();
        EXPECT_NEAR(size.x, m.length, 0.02f * m.length);
        EXPECT_NEAR(size.y, m.width, 0.02f * m.width);
        float top = 0;
        for (const float y : {0.0f, 0.3f})
            for (float x = -0.4f * m.length; x < 0.4f * m.length; x += 0.1f)
                for (const float z : heightsAt(m.levels[0].body, x, y)) top = std::max(top, z);
        if (m.name != "tram") {  // its pantograph stands higher than the roof
            EXPECT_NEAR(top, m.height, 0.02f * m.height);
        }
    }
}

TEST(Fleet, WheelsStandOnTheRoadInLevelsThatHaveThem) {
    for (const VehicleModel& m : fleet()) {
        SCOPED_TRACE(m.name);
        ASSERT_GE(m.wheels.size(), 4u);
        ASSERT_FALSE(m.wheel.empty());
        const city::Mesh whole = withWheels(m.levels[0].body, m, m.wheel);
        EXPECT_NEAR(whole.bounds().min.z, 0, 2e-3f);
        EXPECT_NEAR(m.wheel.bounds().max.x, m.wheelRadius, 2e-3f);
        double sum = 0;
        for (const auto& w : m.wheels) {
            EXPECT_NEAR(w.centre.z, m.wheelRadius, 2e-3f);
            EXPECT_EQ(w.mirrored, w.centre.y < 0);
            sum += w.centre.x;
        }
        EXPECT_NEAR(sum, 0, 1e-4);  // the origin is under the middle of the wheelbase
        for (const auto& level : m.levels)
            if (level.wheelsInBody) {
                // A hexagonal wheel stands on an edge: that much less than its radius.
                EXPECT_GE(level.body.bounds().min.z, -2e-3f);
                EXPECT_LT(level.body.bounds().min.z, 0.14f * m.wheelRadius);
            }
    }
}

TEST(Fleet, NormalsAreUnitFiniteAndFaceOutwards) {
    for (const VehicleModel& m : fleet()) {
        SCOPED_TRACE(m.name);
        std::vector<const city::Mesh*> meshes{&m.wheel};
        for (const auto& level : m.levels) meshes.push_back(&level.body);
        for (const city::Mesh* mesh : meshes)
            for (const city::Vertex& v : mesh->vertices) {
                ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
                ASSERT_NEAR(glm::length(v.normal), 1, 1e-3f);
                ASSERT_LT(v.material, static_cast<std::uint32_t>(Surface::count));
            }
        // On the finest level, shading normals agree with the triangles' sides.
        float against = 0, total = 0;
        for (const city::Mesh* mesh : {&m.wheel, &m.levels[0].body})
            for (std::size_t i = 0; i + 2 < mesh->indices.size(); i += 3) {
                const city::Vertex& a = mesh->vertices[mesh->indices[i]];
                const city::Vertex& b = mesh->vertices[mesh->indices[i + 1]];
                const city::Vertex& c = mesh->vertices[mesh->indices[i + 2]];
                const glm::vec3 flat = glm::cross(b.position - a.position, c.position - a.position);
                total += glm::length(flat);
                if (glm::dot(flat, a.normal + b.normal + c.normal) < 0) against += glm::length(flat);
            }
        EXPECT_LT(against, 0.003f * total);
    }
}

TEST(Fleet, CarsVanAndTramAreSymmetricToAMillimetre) {
    for (const VehicleModel& m : fleet()) {
        if (m.name == "bus") continue;  // doors on the kerb's side only
        SCOPED_TRACE(m.name);
        std::set<std::array<int, 3>> cells;
        const auto cell = [](const glm::vec3& p, int dx, int dy, int dz) {
            return std::array{static_cast<int>(std::floor(p.x * 1000)) + dx,
                              static_cast<int>(std::floor(p.y * 1000)) + dy,
                              static_cast<int>(std::floor(p.z * 1000)) + dz};
        };
        for (const auto& v : m.levels[0].body.vertices) cells.insert(cell(v.position, 0, 0, 0));
        std::size_t alone = 0;
        for (const auto& v : m.levels[0].body.vertices) {
            const glm::vec3 image{v.position.x, -v.position.y, v.position.z};
            bool found = false;
            for (int k = 0; k < 27 && !found; ++k)
                found = cells.contains(cell(image, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            alone += !found;
        }
        // The tram's roof boxes and pantograph are laid out lengthwise, not mirrored vertex by vertex.
        EXPECT_LE(alone, m.name == "tram" ? m.levels[0].body.vertices.size() / 50 : 0u);
    }
}

TEST(Fleet, NobodyLooksThroughABody) {
    for (const VehicleModel& m : fleet()) {
        SCOPED_TRACE(m.name);
        const city::Mesh& body = m.levels[0].body;
        int through = 0, rays = 0;
        for (float x = -0.42f; x <= 0.42f; x += 0.06f)
            for (float y = -0.38f; y <= 0.38f; y += 0.095f) {
                const auto heights =
                    heightsAt(body, x * m.length + shellBox(m).centre().x + 0.0013f, y * m.width + 0.0007f);
                ++rays;
                through += heights.empty();
            }
        EXPECT_GT(rays, 50);
        EXPECT_EQ(through, 0);
    }
}

TEST(Fleet, EverySurfaceIsWhereOneExpectsIt) {
    for (const VehicleModel& m : fleet()) {
        SCOPED_TRACE(m.name);
        std::set<std::uint32_t> body, wheel;
        float lamps = 0, tails = 0;
        int lampCount = 0, tailCount = 0;
        for (const auto& v : m.levels[0].body.vertices) {
            body.insert(v.material);
            if (v.material == static_cast<std::uint32_t>(Surface::headLamp))
                lamps += v.position.x, ++lampCount;
            if (v.material == static_cast<std::uint32_t>(Surface::tailLamp))
                tails += v.position.x, ++tailCount;
        }
        for (const auto& v : m.wheel.vertices) wheel.insert(v.material);
        for (const Surface s :
             {Surface::paint, Surface::glass, Surface::headLamp, Surface::tailLamp, Surface::trim})
            EXPECT_TRUE(body.contains(static_cast<std::uint32_t>(s))) << static_cast<int>(s);
        EXPECT_TRUE(wheel.contains(static_cast<std::uint32_t>(Surface::rim)));
        if (m.name == "tram") continue;  // steel wheels; lamps of both kinds at both ends
        EXPECT_TRUE(wheel.contains(static_cast<std::uint32_t>(Surface::tyre)));
        ASSERT_GT(lampCount, 0);
        ASSERT_GT(tailCount, 0);
        EXPECT_GT(lamps / static_cast<float>(lampCount), 0.35f * m.length);
        EXPECT_LT(tails / static_cast<float>(tailCount), -0.35f * m.length);
    }
}

TEST(Fleet, LevelsGetSmallerAndTheirErrorsGrow) {
    for (const VehicleModel& m : fleet()) {
        SCOPED_TRACE(m.name);
        ASSERT_EQ(m.levels.size(), 4u);
        EXPECT_EQ(m.levels[0].error, 0);
        EXPECT_LE(m.levels[0].body.triangleCount(), 20000u);
        EXPECT_LE(m.levels[1].body.triangleCount(), 3000u);
        EXPECT_LE(m.levels[2].body.triangleCount(), 1300u);  // with borders of surfaces
        EXPECT_LE(m.levels[3].body.triangleCount(), 260u);
        for (std::size_t k = 1; k < 4; ++k) {
            EXPECT_LT(m.levels[k].body.triangleCount(), m.levels[k - 1].body.triangleCount() / 2);
            EXPECT_GE(m.levels[k].error, m.levels[k - 1].error);
            EXPECT_GT(m.levels[k].error, 0);
            EXPECT_EQ(m.levels[k].wheelsInBody, k >= 2);
        }
        EXPECT_LT(m.levels[1].error, 0.06f);
    }
}

TEST(Fleet, IsTheSameEveryTime) {
    const auto again = builtInFleet();
    for (std::size_t i = 0; i < again.size(); ++i) {
        ASSERT_EQ(again[i].levels[0].body.indices, fleet()[i].levels[0].body.indices);
        for (std::size_t v = 0; v < again[i].levels[0].body.vertices.size(); ++v)
            ASSERT_EQ(again[i].levels[0].body.vertices[v].position,
                      fleet()[i].levels[0].body.vertices[v].position);
    }
}

TEST(Fleet, KindsSpeakOfTheirModels) {
    const auto kinds = kindsOf(fleet());
    ASSERT_EQ(kinds.size(), fleet().size());
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        EXPECT_EQ(kinds[i].length, fleet()[i].length);
        EXPECT_EQ(kinds[i].tram, fleet()[i].name == "tram");
        EXPECT_GT(kinds[i].share, 0);
        EXPECT_GT(kinds[i].wheelbase, 0.3f * kinds[i].length);
        EXPECT_LT(kinds[i].wheelbase, kinds[i].length);
        EXPECT_GT(kinds[i].acceleration, 0.5f);
        EXPECT_GT(kinds[i].deceleration, 0.5f);
    }
    EXPECT_NEAR(kinds[0].wheelbase, 2.55f, 1e-4f);
    EXPECT_TRUE(kindsOf({}).empty());
}

}  // namespace
}  // namespace vehicles
