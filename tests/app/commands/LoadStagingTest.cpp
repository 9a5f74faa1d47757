#include "app/commands/LoadStaging.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numbers>
#include <sstream>

#include "app/frame/CameraRig.h"
#include "vehicles/models/Fleet.h"

namespace app {
namespace {

/// One lane along x at 2 m, and one model that the traffic has.
Scene scene() {
    Scene s;
    city::Lane lane;
    lane.centreLine = {{-100, 0, 2}, {100, 0, 2}};
    s.city.roads.lanes.push_back(lane);
    s.city.bounds.extend(glm::vec3(-100, -100, 0));
    s.city.bounds.extend(glm::vec3(100, 100, 20));
    s.models.resize(1);
    s.models[0].name = "saloon";
    s.kinds = vehicles::kindsOf(s.models);
    s.city.tour.resize(7);
    return s;
}

std::string refusal(const std::string& text) {
    Scene s = scene();
    try {
        readStaging(text, "street.json", s);
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "";
}

std::string with(const std::string& vehicle, const std::string& more = "") {
    return R"({"name": "x", "vehicles": [)" + vehicle + "]" + more + "}";
}

TEST(LoadStaging, PutsVehiclesOnTheGroundAndAddsModelsThatNobodyElseDrives) {
    Scene s = scene();
    readStaging(with(R"({"model": "saloon", "at": [3, 4], "facing": 90, "above": 0.12},
                        {"model": "cyclist", "paint": [1, 0.5, 0], "path": [[0, 1], [9, 1]], "speed": 4},
                        {"model": "cyclist", "path": [[0, 2], [9, 2]], "speed": 4})"),
                "street.json", s);
    ASSERT_EQ(s.staged.size(), 3u);
    EXPECT_EQ(s.staged[0].model, 0u);
    EXPECT_NEAR(s.staged[0].path.at(0).z, 2.12, 1e-6);
    EXPECT_NEAR(s.staged[0].heading, 0, 1e-12);  // east
    EXPECT_EQ(s.staged[1].model, 1u);
    EXPECT_EQ(s.staged[2].model, 1u);
    ASSERT_EQ(s.models.size(), 2u);
    ASSERT_EQ(s.kinds.size(), 2u);
    EXPECT_EQ(s.kinds[1].share, 0);
    EXPECT_GT(s.kinds[0].share, 0);
    EXPECT_EQ(s.staged[1].since, settlingTime);
    EXPECT_EQ(s.city.tour.size(), 7u);
}

TEST(LoadStaging, ViewsTakeThePlaceOfTheTour) {
    Scene s = scene();
    readStaging(with("", R"(, "views": [{"name": "a", "eye": [0, 0, 1], "target": [1, 0, 1]},
                                        {"name": "b", "eye": [0, 5, 1], "target": [1, 5, 1]}])"),
                "street.json", s);
    ASSERT_EQ(s.city.tour.size(), 8u);
    for (std::size_t i = 1; i < 8; ++i) EXPECT_GT(s.city.tour[i].time, s.city.tour[i - 1].time);
    const CameraRig rig(s.city.tour, {});
    for (double time = 0.02; time < 3.98; time += 0.1)
        EXPECT_NEAR(glm::distance(rig.tourPose(time).eye, glm::dvec3(0, 0, 1)), 0, 1e-6) << time;
    EXPECT_NEAR(glm::distance(rig.tourPose(8).eye, glm::dvec3(0, 5, 1)), 0, 1e-6);
}

TEST(LoadStaging, DegreesAreThoseOfTheCitysPlaceOnEarth) {
    Scene s = scene();
    s.city.frame.emplace(60.17, 24.94, 0);
    const glm::dvec3 there = s.city.frame->geodeticFromLocal({30, 40, 0});
    std::ostringstream text;
    text.precision(12);
    text
        << R"({"name": "x", "coordinates": "degrees", "vehicles": [{"model": "saloon", "facing": 180, "at": [)"
        << there.y << ", " << there.x << "]}], \"views\": [{\"name\": \"a\", \"eye\": [" << there.y << ", "
        << there.x << ", 1.7], \"target\": [24.94, 60.17, 1.7]}]}";
    readStaging(text.str(), "street.json", s);
    // The frame touches the Earth: 40 m off its origin it is 0.2 mm above it.
    EXPECT_NEAR(glm::distance(s.staged.at(0).path.at(0), glm::dvec3(30, 40, 2)), 0, 1e-3);
    EXPECT_NEAR(s.staged[0].heading, -std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(static_cast<double>(s.city.tour.at(0).eye.z), 3.7, 1e-6);
}

TEST(LoadStaging, RefusesWithPlaceAndRemedy) {
    const auto says = [](const std::string& text, const std::string& part) {
        const std::string why = refusal(text);
        EXPECT_EQ(why.find("street.json"), 0u) << why;
        EXPECT_NE(why.find(part), std::string::npos) << why;
    };
    says("{", "is not JSON");
    says(R"({"name": "x"})", "'vehicles' is missing");
    says(with(R"({"model": "sedan", "at": [0, 0], "facing": 0})"), "choose one of bus, cyclist");
    says(with(R"({"model": "saloon", "at": [0, 0]})"), "'facing' is missing");
    says(with(R"({"model": "saloon"})"), "write one of 'at' and 'path'");
    says(with(R"({"model": "saloon", "at": [0, 0], "path": [[0, 0], [1, 0]], "facing": 0})"), "write one of");
    says(with(R"({"model": "saloon", "at": [0, 0, 0], "facing": 0})"), "write two, [east, north]");
    says(with(R"({"model": "saloon", "path": [[0, 0]], "speed": 1})"), "fewer than two points");
    says(with(R"({"model": "saloon", "path": [[0, 0], [0, 0]], "speed": 1})"), "both points are the same");
    says(with(R"({"model": "saloon", "path": [[0, 0], [1, 0]], "speed": -1})"), "vehicles[0].speed");
    says(with(R"({"model": "saloon", "at": [1e300, 0], "facing": 0})"), "lies outside");
    says(with(R"({"model": "saloon", "at": [0, 0], "facing": 0, "colour": [1, 1, 1]})"), "use only");
    says(with("", R"(, "views": [{"name": "a", "eye": [0, 0, 1], "target": [0, 0, 1]}])"), "same point");
    says(with("", R"(, "coordinates": "feet")"), "write metres or degrees");
    says(with("", R"(, "coordinates": "degrees")"), "no place on Earth");
    says(with(R"({"model": "saloon", "at": [300, 0], "facing": 0})"), "200 m outside the city");
}

TEST(LoadStaging, TheStreetThatComesWithItIsSound) {
    Scene s = scene();
    loadStaging(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/staged/kerbside.json", s);
    ASSERT_EQ(s.staged.size(), 3u);
    // The cyclist's side passes the bumper at 0.3 m; a bicycle's half is its handlebar's.
    const vehicles::VehicleModel& cyclist = s.models[s.staged[2].model];
    EXPECT_EQ(cyclist.name, "cyclist");
    const std::vector<vehicles::VehicleModel> fleet = vehicles::builtInFleet();
    city::Aabb chrome;
    for (const city::Vertex& v : fleet[1].levels[0].body.vertices)
        if (v.material == static_cast<std::uint32_t>(vehicles::Surface::chrome)) chrome.extend(v.position);
    const double bumper = s.staged[0].path[0].y + static_cast<double>(chrome.max.x);
    const double side = s.staged[2].path[0].y - static_cast<double>(cyclist.levels[0].body.bounds().max.y);
    EXPECT_NEAR(side - bumper, 0.3, 0.02);
}

}  // namespace
}  // namespace app
