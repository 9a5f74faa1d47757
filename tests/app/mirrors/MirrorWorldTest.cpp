#include "app/mirrors/MirrorWorld.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "app/mirrors/LitShapes.h"
#include "app/mirrors/MirrorTruth.h"

namespace app {
namespace {

using reflection::CurvedMaps;
using reflection::Economies;
using ::testing::AllOf;
using ::testing::HasSubstr;

MirrorWorld paperScene(char which) {
    return loadMirrorWorld(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/scenes/paper_" + which + ".json");
}

reflection::ReflectionTree treeOf(const MirrorWorld& world, CurvedMaps curved, bool refresh) {
    const MirrorWorldScene arrays(world);
    reflection::TreeSettings settings;
    settings.depth = world.depth;
    settings.curved = curved;
    settings.economies = Economies::paper();
    settings.mapSize = {256, 256};
    settings.refreshCurved = refresh;
    const reflection::TreeView view = world.view({640, 480});
    return reflection::reflectionTree(std::span(&view, 1), arrays.scene(), settings);
}

TEST(PaperScenes, HaveTheNumbersOfTableOne) {
    struct Row {
        char which;
        std::size_t planar, curved, triangles;
        int depth;
        std::uint32_t dependent, dynamic, still;
    };
    for (const Row& row : {Row{'a', 6, 1, 1078, 2, 38, 62, 26}, Row{'b', 1, 3, 1106, 2, 16, 19, 1},
                           Row{'c', 2, 2, 3890, 2, 16, 28, 4}, Row{'d', 3, 1, 1002, 3, 46, 69, 15}}) {
        const MirrorWorld world = paperScene(row.which);
        EXPECT_EQ(world.mirrors.size(), row.planar);
        EXPECT_EQ(world.curved.size(), row.curved);
        EXPECT_EQ(world.triangles(), row.triangles);
        EXPECT_EQ(world.depth, row.depth);
        EXPECT_EQ(treeOf(world, CurvedMaps::viewDependent, true).counters.generated(), row.dependent)
            << row.which;
        const auto dynamic = treeOf(world, CurvedMaps::cube, true);
        EXPECT_EQ(dynamic.counters.planar, row.dynamic) << row.which;
        EXPECT_EQ(dynamic.counters.faces, 6 * row.curved);
        EXPECT_EQ(treeOf(world, CurvedMaps::cube, false).counters.planar, row.still) << row.which;
    }
}

std::string complaintOf(const std::string& text) {
    try {
        parseMirrorWorld(text, "scene.json");
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "";
}

std::string sceneWith(const std::string& depth, const std::string& object,
                      const std::string& triangles = "2") {
    return R"({"name":"n","source":"s","licence":"l","depth":)" + depth +
           R"(,"camera":{"eye":[0,0,1],"target":[1,0,1],"fov_y_deg":60},"triangles":)" + triangles +
           R"(,"objects":[)" + object + "]}";
}

TEST(SceneFiles, AreRefusedWithThePlaceAndTheRemedy) {
    const std::string mirror =
        R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1],[0,0,1]],"reflectance":[0.5,0.5,0.5]})";
    ASSERT_EQ(complaintOf(sceneWith("2", mirror)), "");
    EXPECT_THAT(
        complaintOf(sceneWith("-1", mirror)),
        AllOf(HasSubstr("scene.json, depth"), HasSubstr("-1 lies outside 0 .. 32"), HasSubstr("choose")));
    EXPECT_THAT(complaintOf(sceneWith("1.5", mirror)), HasSubstr("depth: is not a whole number"));
    EXPECT_THAT(
        complaintOf(sceneWith("2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0]],"reflectance":[1,1,1]})")),
        AllOf(HasSubstr("objects[0].corners"), HasSubstr("at least three"), HasSubstr("add the missing")));
    EXPECT_THAT(complaintOf(sceneWith(
                    "2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[2,0,0]],"reflectance":[1,1,1]})")),
                HasSubstr("on a line"));
    EXPECT_THAT(complaintOf(sceneWith(
                    "2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1]],"reflectance":[NaN,1,1]})")),
                AllOf(HasSubstr("scene.json"), HasSubstr("not JSON"), HasSubstr("line 1")));
    EXPECT_THAT(
        complaintOf(sceneWith(
            "2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1]],"reflectance":[null,1,1]})")),
        HasSubstr("objects[0].reflectance[0]: is not a number"));
    EXPECT_THAT(
        complaintOf(sceneWith(
            "2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1]],"reflectance":[1e999,1,1]})")),
        HasSubstr("scene.json"));
    EXPECT_THAT(complaintOf(sceneWith(
                    "2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1]],"reflectance":[2,1,1]})")),
                HasSubstr("objects[0].reflectance[0]: 2 lies outside 0 .. 1"));
    EXPECT_THAT(complaintOf(sceneWith("2", R"({"kind":"mirror","corner":[]})")),
                HasSubstr("there is no 'corner' here"));
    EXPECT_THAT(complaintOf(sceneWith("2", R"({"kind":"teapot"})")), HasSubstr("choose mirror, chrome ball"));
    EXPECT_THAT(complaintOf(sceneWith("2", mirror, "3")), AllOf(HasSubstr("triangles"), HasSubstr("have 2")));
    EXPECT_THAT(
        complaintOf(sceneWith("2", R"({"kind":"box","low":[0,0,0],"high":[1,0,1],"colour":[1,1,1]})", "12")),
        HasSubstr("no volume"));
    const auto withRipples = [](const std::string& roughness, const std::string& ripples) {
        return complaintOf(
            sceneWith("2", R"({"kind":"mirror","corners":[[0,0,0],[1,0,0],[1,0,1]],"reflectance":[1,1,1])" +
                               roughness + R"(,"ripples":)" + ripples + "}"));
    };
    EXPECT_THAT(withRipples("", R"({"slope":0.5,"wavelength":1})"), HasSubstr("0.5 lies outside 0 .. 0.3"));
    EXPECT_THAT(withRipples("", R"({"slope":0.1})"), HasSubstr("'wavelength' is missing"));
    EXPECT_THAT(withRipples(R"(,"roughness":0.2)", R"({"slope":0.1,"wavelength":1})"),
                HasSubstr("rough as well"));
    EXPECT_THAT(complaintOf("[]"), HasSubstr("is not an object"));
    EXPECT_THAT(complaintOf(""), HasSubstr("not JSON"));
    EXPECT_THROW(loadMirrorWorld("/nowhere/scene.json"), std::runtime_error);
}

TEST(Ripples, SlopesHaveTheDeviationThatWasAskedForAndStayWithinTheirReach) {
    const Ripples ripples{0.03, 0.7};
    const RippleFrame frame({0, 0, 1});
    std::mt19937_64 random(3);
    double sum = 0, most = 0;
    const int samples = 20000;
    for (int i = 0; i < samples; ++i) {
        const glm::dvec3 at(static_cast<double>(random() % 100000) * 1e-3,
                            static_cast<double>(random() % 100000) * 1e-3, 0);
        const glm::dvec2 slope = rippleSlope(ripples, frame, at);
        sum += glm::dot(slope, slope);
        most = std::max(most, glm::length(slope));
    }
    // Six waves add up in both directions: the variances of both axes together are the square of `slope`.
    EXPECT_NEAR(std::sqrt(sum / samples), 0.03, 0.03 * 0.03);
    EXPECT_LT(2 * most, ripples.reach());
    EXPECT_EQ(rippleSlope({0, 1}, frame, {1, 2, 3}), glm::dvec2(0));
}

// Bytes changed, dropped and doubled at random: refused with a sentence, or read; nothing else.
TEST(SceneFiles, SpoiltOnesEndInASentence) {
    std::ifstream in(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/scenes/paper_b.json");
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    ASSERT_GT(whole.size(), 500u);
    std::mt19937_64 random(12);
    int refused = 0;
    for (int i = 0; i < 4000; ++i) {
        std::string text = whole;
        for (std::uint64_t k = random() % 4 + 1; k > 0; --k) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
                case 0:
                    text[at] = static_cast<char>(random() % 256);
                    break;
                case 1:
                    text[at] = "0123456789-.eE[]{},\""[random() % 20];
                    break;
                case 2:
                    text.erase(at, random() % 8);
                    break;
                default:
                    text.insert(at, text.substr(at, random() % 12));
                    break;
            }
        }
        try {
            const MirrorWorld world = parseMirrorWorld(text, "spoilt.json");
            EXPECT_LT(world.triangles(), 10000000u);
            for (const MirrorWorld::Flat& f : world.mirrors) EXPECT_GT(f.mirror.plane.area(), 0);
        } catch (const std::runtime_error& e) {
            ++refused;
            EXPECT_THAT(e.what(), testing::StartsWith("spoilt.json"));
        }
    }
    EXPECT_GT(refused, 2000);
}

TEST(LitShapes, AreClosedTowardsTheirOutside) {
    for (const LitMesh& m :
         {litBox({0, 0, 0}, {1, 2, 3}, glm::vec3(1)), litBall({1, 2, 3}, 2, 12, 8, glm::vec3(1))}) {
        double volume = 0;
        for (std::size_t i = 0; i < m.indices.size(); i += 3) {
            const glm::dvec3 a(m.corners[m.indices[i]].position), b(m.corners[m.indices[i + 1]].position),
                c(m.corners[m.indices[i + 2]].position);
            volume += glm::dot(a, glm::cross(b, c)) / 6;
            EXPECT_GT(glm::dot(glm::cross(b - a, c - a), glm::dvec3(m.corners[m.indices[i]].normal)), 0);
        }
        EXPECT_GT(volume, 5);
    }
    const LitMesh fine = subdivided(litBox({0, 0, 0}, {1, 1, 1}, glm::vec3(1)), 0.3f);
    double area = 0;
    for (std::size_t i = 0; i < fine.indices.size(); i += 3) {
        const glm::vec3 a = fine.corners[fine.indices[i]].position,
                        b = fine.corners[fine.indices[i + 1]].position,
                        c = fine.corners[fine.indices[i + 2]].position;
        area += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
        EXPECT_LE(glm::distance(a, b), 0.3f);
    }
    EXPECT_NEAR(area, 6, 1e-4);
}

// What a flat mirror shows is what an eye at the mirror image would see through it.
TEST(MirrorTruth, ASmoothMirrorShowsTheMirroredView) {
    MirrorWorld world = facingWindows(0);
    const MirrorTruth truth(world);
    const reflection::TreeView view = world.view({64, 48});
    const TracedPicture one = truth.picture(view, {.depth = 1});
    const TracedPicture none = truth.picture(view, {.depth = 0});
    std::size_t mirrored = 0, same = 0;
    for (std::size_t i = 0; i < one.radiance.size(); ++i) {
        if (one.level[i] == 0) same += one.radiance[i] == none.radiance[i];
        mirrored += one.level[i] == 1;
    }
    EXPECT_GT(mirrored, 500u);
    EXPECT_EQ(same + mirrored, one.radiance.size());
    const TracedPicture deep = truth.picture(view, {.depth = 8});
    EXPECT_GE(*std::max_element(deep.level.begin(), deep.level.end()), 4);
}

TEST(MirrorTruth, RoughnessSpreadsByItsStatedAngleAndKeepsTheMean) {
    MirrorWorld world = facingWindows(0.1f);
    world.depth = 1;
    const MirrorTruth truth(world);
    const reflection::TreeView view = world.view({48, 36});
    const TracedPicture a = truth.picture(view, {.depth = 1, .samples = 64, .seed = 1});
    const TracedPicture b = truth.picture(view, {.depth = 1, .samples = 64, .seed = 1});
    const TracedPicture c = truth.picture(view, {.depth = 1, .samples = 64, .seed = 2});
    EXPECT_EQ(a.radiance, b.radiance);
    EXPECT_NE(a.radiance, c.radiance);
    glm::dvec3 meanA(0), meanC(0);
    for (std::size_t i = 0; i < a.radiance.size(); ++i) {
        meanA += glm::dvec3(a.radiance[i]);
        meanC += glm::dvec3(c.radiance[i]);
    }
    EXPECT_LT(glm::length(meanA - meanC) / glm::length(meanA), 0.005);
}

}  // namespace
}  // namespace app
