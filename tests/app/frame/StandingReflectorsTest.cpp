#include "app/frame/StandingReflectors.h"

#include <gtest/gtest.h>

#include "app/frame/AssembleFrame.h"
#include "app/frame/ReflectionPlan.h"
#include "app/frame/VehicleLevels.h"

namespace app {
namespace {

city::CityModel twoReflectors() {
    city::CityModel city;
    city.reflectors.push_back({"ball",
                               city::StandingReflector::Shape::sphere,
                               city::StandingReflector::Stuff::chrome,
                               {10, 20, 0.5f},
                               1,
                               2});
    city.reflectors.push_back({"post",
                               city::StandingReflector::Shape::pillar,
                               city::StandingReflector::Stuff::granite,
                               {-10, 20, 0.25f},
                               0.5f,
                               4});
    return city;
}

/// A reflector 300 pixels across, and a car that drives past it `apart` metres away.
struct Passing {
    explicit Passing(double apart) {
        scene.vehicles = standingPoses(twoReflectors(), 1);
        scene.vehicles.resize(1);
        vehicles::VehiclePose car;
        car.id = 7;
        car.position = scene.vehicles[0].position + glm::dvec3(0, apart, 0);
        car.speed = 10;
        scene.vehicles.push_back(car);
    }
    /// Maps of the reflector built in so many frames after its first.
    std::size_t rebuilt(int frames, const PlanOptions& options = {}) {
        std::size_t count = 0;
        const std::vector<SeenVehicle> seen{{0, 300}};
        for (int i = 0; i <= frames; ++i) {
            scene.time += 1.0 / 60;
            const ReflectionPlan plan = planner.plan(scene, seen, heights, options);
            EXPECT_TRUE(plan.slots[0].valid());
            if (i > 0)
                count += plan.jobs.size();
            else
                EXPECT_EQ(plan.jobs.size(), 1u) << "its first map";
        }
        return count;
    }
    const std::vector<float> heights{0.8f, 1};
    FrameScene scene;
    ReflectionPlanner planner;
};

TEST(StandingReflectorsTest, followTheVehiclesOfAFrame) {
    city::CityModel city = twoReflectors();
    vehicles::Traffic traffic(city.roads, std::vector<vehicles::VehicleKind>(3), {});
    const FrameScene frame = assembleFrame(city, traffic, {}, {});
    ASSERT_EQ(frame.vehicles.size(), traffic.size() + 2);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const vehicles::VehiclePose& pose = frame.vehicles[traffic.size() + i];
        EXPECT_TRUE(stands(pose));
        EXPECT_EQ(pose.model, 3 + i) << "behind the traffic's models";
        EXPECT_EQ(glm::vec3(pose.position), city.reflectors[i].foot);
        EXPECT_EQ(pose.speed, 0);
    }
    EXPECT_NE(frame.vehicles[0].id, frame.vehicles[1].id);
    EXPECT_TRUE(emptyFrame(city, {}).vehicles.empty()) << "reference maps must not show them";
}

TEST(StandingReflectorsTest, theirModelsAreWhatTheyAreMadeOfAndHaveLevels) {
    const city::CityModel city = twoReflectors();
    const std::vector<vehicles::VehicleModel> models = standingModels(city);
    ASSERT_EQ(models.size(), 2u);
    const vehicles::Surface stuff[2]{vehicles::Surface::chrome, vehicles::Surface::polishedStone};
    for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_GE(models[i].levels.size(), 3u);
        for (std::size_t k = 0; k < models[i].levels.size(); ++k) {
            const vehicles::VehicleModel::Level& level = models[i].levels[k];
            for (const city::Vertex& v : level.body.vertices)
                ASSERT_EQ(v.material, static_cast<std::uint32_t>(stuff[i]));
            if (k == 0) continue;
            EXPECT_GT(level.error, models[i].levels[k - 1].error);
            EXPECT_LT(level.body.triangleCount(), models[i].levels[k - 1].body.triangleCount());
        }
        const VehicleLevels drawn = vehicleLevels(models[i]);
        EXPECT_NEAR(drawn.centre.z, models[i].reflectionCentre * models[i].height, 1e-5)
            << "what it mirrors is gathered in its middle";
        EXPECT_TRUE(drawn.wheels.empty());
    }
}

TEST(StandingReflectorsTest, aMapIsKeptWhileNothingPasses) {
    Passing parked(6);
    parked.scene.vehicles[1].speed = 0;
    EXPECT_EQ(parked.rebuilt(600), 0u) << "cars that stand";
    Passing far(60);
    EXPECT_EQ(far.rebuilt(600), 0u) << "a car that is too far off to be more than a blot";
}

TEST(StandingReflectorsTest, aMapFollowsWhatPassesTheMoreOftenTheNearer) {
    Passing near(6), beside(20), away(40);
    const std::size_t often = near.rebuilt(120), less = beside.rebuilt(120), least = away.rebuilt(120);
    EXPECT_GE(often, 100u) << "a car in front of it moves by pixels a frame";
    EXPECT_GT(often, less);
    EXPECT_GT(less, least);
    EXPECT_GT(least, 0u);
}

TEST(StandingReflectorsTest, noneIsPlannedThatIsNotSeen) {
    Passing near(6);
    const ReflectionPlan plan = near.planner.plan(near.scene, {}, near.heights, {});
    EXPECT_TRUE(plan.jobs.empty());
    EXPECT_EQ(plan.texels, 0u);
    EXPECT_FALSE(plan.slots[0].valid());
}

}  // namespace
}  // namespace app
