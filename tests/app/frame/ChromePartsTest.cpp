// The reflectors that close chrome is made of, and how large things are in them.
#include "app/frame/ChromeParts.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>

#include "app/frame/CloseImages.h"
#include "app/frame/CloseScene.h"
#include "reflection/chrome/ReflectionSearch.h"
#include "tests/app/frame/ChromeWorld.h"
#include "vehicles/models/Bodies.h"

namespace app {
namespace {

using World = test::ChromeWorld;

TEST(ChromeParts, AreKeptOnDiskAndDamagedFilesAreMadeAnew) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("mirrorstreet_chrome_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    std::vector<std::string> told;
    const auto make = [&] {
        World world(4);
        world.parts.keepIn(folder, [&](const std::string& text) { told.push_back(text); });
        const reflection::Reflector& r = world.parts.reflectorOf(world.parts.of(0)[0]);
        EXPECT_EQ(r.pieces.size(), 1u);
        const auto corners = r.pieces[0].built.map.corners();
        return std::vector(corners.begin(), corners.end());
    };
    const auto first = make();
    ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
    const std::filesystem::path file = std::filesystem::directory_iterator(folder)->path();
    EXPECT_EQ(file.extension(), ".reflector");
    const auto size = std::filesystem::file_size(file);
    EXPECT_EQ(make(), first);
    EXPECT_TRUE(told.empty());
    // Cut short, changed in its middle, emptied, made of something else.
    const auto damaged = [&](const std::function<void(std::vector<char>&)>& how) {
        std::ifstream in(file, std::ios::binary);
        std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
        in.close();
        how(bytes);
        std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        told.clear();
        EXPECT_EQ(make(), first);
        ASSERT_EQ(told.size(), 1u);
        EXPECT_NE(told[0].find(file.string()), std::string::npos);
        EXPECT_NE(told[0].find("made anew"), std::string::npos);
        EXPECT_EQ(std::filesystem::file_size(file), size);
    };
    damaged([](auto& b) { b.resize(b.size() / 2); });
    damaged([](auto& b) { b[b.size() / 2] ^= 1; });
    damaged([](auto& b) { b.clear(); });
    damaged([](auto& b) { b[0] = 'x'; });
    told.clear();
    EXPECT_EQ(make(), first);
    EXPECT_TRUE(told.empty());
    // A folder that is none is told of, and everything goes on.
    std::filesystem::remove_all(folder);
    std::ofstream(folder) << "a file";
    EXPECT_EQ(make(), first);
    EXPECT_EQ(told.size(), 1u);
    std::filesystem::remove_all(folder);
}

TEST(CloseImages, AreNoSmallerThanWhatIsSeenAndHiddenOnlyBehind) {
    const World world(5);
    const ChromePart& part = world.parts.of(1)[0];
    const reflection::ReflectorMap& map = world.parts.reflectorOf(part).pieces[0].built.map;
    const glm::dvec3 eye(5, 0, 0);
    std::uint32_t state = 1;
    const auto random = [&](double low, double high) {
        state = state * 1664525u + 1013904223u;
        return low + (high - low) * (state >> 8) / 16777216.0;
    };
    std::vector<CloseBox> boxes;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 low(random(-6, 4), random(-5, 5), random(-3, 3));
        city::Aabb box;
        box.extend(low);
        box.extend(low + glm::vec3(random(0.1, 2), random(0.1, 2), random(0.1, 2)));
        boxes.push_back({box, glm::dmat4(1)});
    }
    boxes.push_back({{}, glm::dmat4(1)});
    const std::vector<CloseImage> images = closeImages(map, 1, eye, boxes);
    int hidden = 0, known = 0;
    for (std::size_t i = 0; i + 1 < boxes.size(); ++i) {
        const glm::dvec3 low(boxes[i].box.min), high(boxes[i].box.max);
        for (int k = 0; k < 40; ++k) {
            const glm::dvec3 p(random(low.x, high.x), random(low.y, high.y), random(low.z, high.z));
            const std::array<glm::dvec3, 2> both{p,
                                                 p + 1e-3 * glm::dvec3(0, 0, p.z > high.z - 2e-3 ? -1 : 1)};
            std::array<reflection::ReflectionPoint, 2> points;
            reflection::findReflectionPoints(map, eye, both, points);
            if (images[i].hidden) {
                EXPECT_EQ(points[0].status, reflection::ReflectionStatus::hidden);
                continue;
            }
            if (points[0].status != reflection::ReflectionStatus::found ||
                points[1].status != reflection::ReflectionStatus::found)
                continue;
            const double angle =
                glm::length(glm::normalize(reflection::virtualVertex(points[0], both[0]) - eye) -
                            glm::normalize(reflection::virtualVertex(points[1], both[1]) - eye));
            // The nearest place is not quite where an image is largest: near the outline others are.
            EXPECT_LT(angle * images[i].metresPerRadian, 2 * 1e-3) << i;
            ++known;
        }
        hidden += images[i].hidden;
        EXPECT_GT(images[i].angle, 0);
    }
    EXPECT_GT(hidden, 2);
    EXPECT_GT(known, 2000);
    EXPECT_TRUE(images.back().hidden);
}

TEST(ChromeParts, BumpersCoversMirrorCapsAndHandlesAreWholeConvexBodies) {
    const vehicles::VehicleModel saloon = vehicles::saloon();
    const ChromeParts parts(std::span(&saloon, 1));
    int bodies = 0, wheels = 0, others = 0;
    for (const ChromePart& part : parts.of(0)) {
        if (!part.convex) {
            ++others;
            continue;
        }
        EXPECT_TRUE(part.closed);
        ++(part.onWheel ? wheels : bodies);
        const reflection::Reflector& reflector = parts.reflectorOf(part);
        ASSERT_EQ(reflector.pieces.size(), 1u);
        EXPECT_EQ(reflector.pieces[0].bend, reflection::Bend::convex);
        EXPECT_EQ(reflector.pieces[0].built.report.coveredShare, 1);
    }
    // Two bumpers, two caps with a glass each, four handles; a cover; rims of windows, grilles.
    EXPECT_EQ(bodies, 10);
    EXPECT_EQ(wheels, 1);
    EXPECT_GT(others, 2);
}

TEST(ChromeParts, WhatDiffersInItsPlaceAloneIsMadeOnce) {
    vehicles::VehicleModel one, two;
    one.levels.emplace_back().body = World::button({2, 0.3f, 0.7f});
    one.levels.front().body.append(World::button({2, -0.3f, 0.7f}));
    two.levels.emplace_back().body = World::button({-1, 0, 12.345f});
    two.wheel = World::button({0, 0, 0});
    two.wheels.resize(4);
    const std::vector<vehicles::VehicleModel> models{one, two};
    const ChromeParts parts(models);
    ASSERT_EQ(parts.of(0).size(), 2u);
    ASSERT_EQ(parts.of(1).size(), 2u);
    EXPECT_EQ(parts.shapes(), 1u);
    EXPECT_EQ(parts.reflectorsMade(), 0u);
    EXPECT_EQ(&parts.reflectorOf(parts.of(0)[0]), &parts.reflectorOf(parts.of(1)[1]));
    EXPECT_EQ(parts.reflectorsMade(), 1u);
    EXPECT_GT(parts.bytes(), 0u);
    EXPECT_TRUE(parts.of(2).empty());
    EXPECT_NE(parts.of(1)[0].onWheel, parts.of(1)[1].onWheel);
    // A part that is bent otherwise is another.
    std::vector<vehicles::VehicleModel> bent = models;
    bent[0].levels[0].body.vertices[5].position.x += 0.01f;
    EXPECT_EQ(ChromeParts(bent).shapes(), 2u);
}

TEST(ChromeParts, APillarIsSearchedOnABodyThatIsClosed) {
    city::CityModel city;
    city.reflectors.push_back({"pillar", city::StandingReflector::Shape::pillar,
                               city::StandingReflector::Stuff::chrome, glm::vec3(3, 4, 0), 0.5f, 4});
    const std::vector<vehicles::VehicleModel> models = standingModels(city);
    const ChromeParts alone(models);
    EXPECT_FALSE(alone.of(0)[0].closed);
    const CloseScene close(city, models);
    const ChromePart& part = close.parts.of(0)[0];
    EXPECT_TRUE(part.closed);
    const reflection::Reflector& reflector = close.parts.reflectorOf(part);
    ASSERT_EQ(reflector.pieces.size(), 1u);
    // What is seen is the pillar's side, what is searched goes on past it, and is smooth.
    const city::Aabb seen = reflector.pieces[0].mesh.bounds();
    EXPECT_NEAR(seen.size().z, 4, 1e-4f);
    const reflection::ReflectorMap& map = reflector.pieces[0].built.map;
    EXPECT_EQ(reflector.pieces[0].built.report.coveredShare, 1);
    for (const double z : {0.0, 1.9, 2.4}) {
        const glm::dvec3 eye(5, 0, z), vertex(2, 3, z);
        reflection::ReflectionPoint point;
        reflection::findReflectionPoints(map, eye, {&vertex, 1}, {&point, 1});
        EXPECT_EQ(point.status, reflection::ReflectionStatus::found);
        EXPECT_NEAR(glm::length(glm::dvec2(point.point)), 0.5, 1e-3);
        EXPECT_NEAR(point.point.z, z, 2e-3);
    }
    EXPECT_TRUE(roundedPillar({"none", {}, {}, {}, 0, 1}).empty());
}

TEST(ChromeParts, CreasesAndPaintPartAndBrokenTrianglesAreLeftOut) {
    constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);
    city::Mesh mesh;
    const auto quad = [&](glm::vec3 o, glm::vec3 u, glm::vec3 v, std::uint32_t material) {
        const glm::vec3 n = glm::normalize(glm::cross(u, v));
        mesh.addQuad({o, n, {}, material}, {o + u, n, {}, material}, {o + u + v, n, {}, material},
                     {o + v, n, {}, material});
    };
    quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, chrome);
    quad({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, chrome);   // goes on flat
    quad({2, 0, 0}, {0, 0, -1}, {0, 1, 0}, chrome);  // round a sharp edge
    quad({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0);
    EXPECT_EQ(chromeComponents(mesh).size(), 2u);
    EXPECT_EQ(chromeComponents(mesh)[0].triangleCount(), 4u);
    // Three triangles at an edge, one with a corner that is nowhere, one with an index that is.
    quad({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, chrome);
    const float nowhere = std::numeric_limits<float>::quiet_NaN();
    mesh.addTriangle({{nowhere, 0, 0}, {0, 0, 1}, {}, chrome}, {{0, 0, 0}, {0, 0, 1}, {}, chrome},
                     {{1, 0, 0}, {0, 0, 1}, {}, chrome});
    mesh.indices.insert(mesh.indices.end(), {0, 1, 1000});
    vehicles::VehicleModel model;
    model.levels.emplace_back().body = mesh;
    const ChromeParts parts(std::span(&model, 1));
    std::size_t pieces = 0;
    for (const ChromePart& part : parts.of(0)) {
        EXPECT_TRUE(std::isfinite(part.radius) && std::isfinite(part.width));
        pieces += parts.reflectorOf(part).pieces.size();
    }
    EXPECT_GE(pieces, 3u);
}

}  // namespace
}  // namespace app
