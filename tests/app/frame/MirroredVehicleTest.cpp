#include "app/frame/MirroredVehicle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/frame/VehicleShading.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "tests/reflection/tracing/SeededRandom.h"
#include "vehicles/models/Fleet.h"

namespace app {
namespace {

using reflection::SeededRandom;
using vehicles::Surface;

float fullSun(const glm::dvec3&) {
    return 1;
}

TEST(MirroredVehicleTest, shadesTheCoarsestLevelAroundTheCentre) {
    vehicles::VehicleModel model;
    model.levels.resize(2);
    city::Vertex v;
    v.position = {1, 0, 0};
    v.normal = {1, 0, 0};
    v.material = static_cast<std::uint32_t>(Surface::trim);
    model.levels[0].body.addTriangle(v, v, v);
    model.levels[0].body.addTriangle(v, v, v);
    city::Vertex w = v;
    w.position = {0, 1, 0};
    city::Vertex u = v;
    u.position = {0, 0, 1};
    model.levels[1].body.addTriangle(v, w, u);
    vehicles::VehiclePose pose;
    pose.position = {1e6, 2e6, 3};
    pose.heading = std::acos(-1.0) / 2;
    reflection::MovingObject object;
    object.indices = {9, 9, 9};
    MirroredVehicle(model).shade(pose, Lighting{}, {1e6 - 5, 2e6, 3}, 1e9f, fullSun, object);
    ASSERT_EQ(object.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    ASSERT_EQ(object.positions.size(), 3u);
    ASSERT_EQ(object.radiance.size(), 3u);
    EXPECT_NEAR(glm::distance(object.positions[0], glm::vec3(5, 1, 0)), 0, 1e-5);
    EXPECT_NEAR(glm::distance(object.positions[1], glm::vec3(4, 0, 0)), 0, 1e-5);
    EXPECT_NEAR(glm::distance(object.positions[2], glm::vec3(5, 0, 1)), 0, 1e-5);
    const glm::vec3 expected =
        vehicleRadiance(Lighting{}, Surface::trim, pose, {0, 1, 0}, glm::normalize(-object.positions[0]));
    EXPECT_NEAR(glm::distance(object.radiance[0], expected), 0, 1e-5);
    const vehicles::VehicleModel nothing;
    MirroredVehicle(nothing).shade(pose, Lighting{}, {0, 0, 0}, 1e9f, fullSun, object);
    EXPECT_TRUE(object.indices.empty() && object.positions.empty() && object.radiance.empty());
}

TEST(MirroredVehicleTest, builtInVehiclesShowTheirNearSideInALocalMap) {
    SeededRandom random(32);
    for (const vehicles::VehicleModel& model : vehicles::builtInFleet())
        for (int k = 0; k < 3; ++k) {
            vehicles::VehiclePose pose;
            const double angle = random.between(0, 6.2831853);
            const double away = 3 + 0.5 * static_cast<double>(model.length);
            pose.position = {away * std::cos(angle), away * std::sin(angle), -0.9};
            pose.heading = random.between(0, 6.2831853);
            reflection::MovingObject object;
            MirroredVehicle(model).shade(pose, Lighting{}, {0, 0, 0}, 1e9f, fullSun, object);
            const int n = 24;
            reflection::LocalMap map;
            map.resize(n);
            std::fill(map.depth.begin(), map.depth.end(), 1000.0f);
            int drawn = 0, nearSide = 0;
            for (int face = 0; face < 6; ++face) {
                (void)reflection::drawMovingObjects(std::span(&object, 1), face, map);
                for (int i = 0; i < n * n; ++i) {
                    const float got = map.depth[map.faceOffset(face) + static_cast<std::size_t>(i)];
                    if (got == 1000.0f) continue;
                    // The nearest triangle that the ray meets, from whichever side.
                    const glm::vec3 d = reflection::cubeDirection(face, glm::vec2(i % n, i / n) + 0.5f, n);
                    float nearest = 1000;
                    for (std::size_t t = 0; t < object.indices.size(); t += 3) {
                        const glm::vec3 a = object.positions[object.indices[t]],
                                        u = object.positions[object.indices[t + 1]] - a,
                                        v = object.positions[object.indices[t + 2]] - a,
                                        across = glm::cross(d, v);
                        const float facing = glm::dot(u, across);
                        if (std::abs(facing) < 1e-9f) continue;
                        const float b = -glm::dot(a, across) / facing;
                        const glm::vec3 q = glm::cross(-a, u);
                        const float c = glm::dot(d, q) / facing, at = glm::dot(v, q) / facing;
                        if (b >= 0 && c >= 0 && b + c <= 1 && at > 0.05f) nearest = std::min(nearest, at);
                    }
                    ++drawn;
                    nearSide += got < nearest * 1.001f ? 1 : 0;
                }
            }
            EXPECT_GT(drawn, 20) << model.name;
            // Thin parts may be seen from behind here and there.
            EXPECT_GT(nearSide, 0.95 * drawn) << model.name;
        }
}

TEST(MirroredVehicleTest, theLevelIsTheCoarsestThatIsAllowedAndWheelsAreNeverMissing) {
    for (const vehicles::VehicleModel& model : vehicles::builtInFleet()) {
        const MirroredVehicle vehicle(model);
        vehicles::VehiclePose pose;
        std::size_t before = 0;
        for (std::size_t k = model.levels.size(); k-- > 0;) {
            reflection::MovingObject object;
            vehicle.shade(pose, Lighting{}, {0, 20, 1}, model.levels[k].error, fullSun, object);
            EXPECT_GT(object.indices.size(), before) << model.name << ' ' << k;
            before = object.indices.size();
            if (!model.levels[k].wheelsInBody) {
                EXPECT_GT(object.indices.size(), model.levels[k].body.indices.size()) << model.name;
            }
            // Wheels stand on the road; a body alone does not.
            float lowest = 100;
            for (const glm::vec3& p : object.positions) lowest = std::min(lowest, p.z + 1);
            EXPECT_LT(lowest, 0.12f) << model.name << ' ' << k;
        }
    }
}

TEST(MirroredVehicleTest, whatTheSunDoesNotReachIsDarker) {
    const std::vector<vehicles::VehicleModel> fleet = vehicles::builtInFleet();
    const MirroredVehicle vehicle(fleet.front());
    vehicles::VehiclePose pose;
    pose.paint = glm::vec3(0.8f);
    reflection::MovingObject lit, shaded, half;
    vehicle.shade(pose, Lighting{}, {0, 6, 1}, 1, fullSun, lit);
    vehicle.shade(
        pose, Lighting{}, {0, 6, 1}, 1, [](const glm::dvec3&) { return 0.f; }, shaded);
    vehicle.shade(
        pose, Lighting{}, {0, 6, 1}, 1, [](const glm::dvec3& p) { return p.x > 0 ? 1.f : 0.f; }, half);
    ASSERT_EQ(lit.radiance.size(), half.radiance.size());
    std::size_t darker = 0;
    for (std::size_t i = 0; i < lit.radiance.size(); ++i) {
        darker += shaded.radiance[i].g < 0.8f * lit.radiance[i].g ? 1 : 0;
        EXPECT_EQ(half.radiance[i], lit.positions[i].x > 0 ? lit.radiance[i] : shaded.radiance[i]);
    }
    EXPECT_GT(darker, lit.radiance.size() / 8);
}

}  // namespace
}  // namespace app
