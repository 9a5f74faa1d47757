// The ray tracer against answers worked by hand, and against itself.
#include "app/raytrace/RayTracer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>

#include "app/frame/Sky.h"
#include "app/raytrace/PartedPicture.h"
#include "app/raytrace/RayPaths.h"
#include "app/raytrace/ViewRays.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "tests/app/raytrace/MirrorWorld.h"

namespace app {
namespace {

const std::vector<std::uint32_t> firstAndSecond{0, 1};

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool same(const TracedPicture& a, const TracedPicture& b) {
    return a.size == b.size && sameBytes(a.radiance, b.radiance) &&
           sameBytes(a.displayFactor, b.displayFactor) && sameBytes(a.distance, b.distance) &&
           sameBytes(a.normal, b.normal) && sameBytes(a.kind, b.kind) && sameBytes(a.vehicle, b.vehicle) &&
           sameBytes(a.surface, b.surface) && sameBytes(a.fresnel, b.fresnel) &&
           sameBytes(a.mirrored, b.mirrored);
}

/// Street of boxes with two mirroring vehicles beside each other.
struct Street {
    city::CityModel city = test::boxCity();
    std::vector<vehicles::VehicleModel> models{test::mirrorBall(48), test::mirrorBox()};
    FrameScene frame;
    View view = lookAt({-7, 2, 2}, {0.3, 9, 1}, glm::radians(28.0), {96, 54});

    Street() {
        frame.vehicles = {test::poseAt(11, 0, {0, 8, 0}), test::poseAt(12, 1, {1, 11.5, 0}, 0.2)};
        frame.views = {view};
    }
};

TEST(RayTracerTest, mirrorBallShowsTheSkyWhereTheLawOfReflectionSays) {
    const city::CityModel nothing;
    const std::vector<vehicles::VehicleModel> models{test::mirrorBall()};
    RayTracer tracer(nothing, models);
    FrameScene frame;
    frame.vehicles = {test::poseAt(1, 0, {0, 0, 0})};
    tracer.prepare(frame);
    const glm::dvec3 eye(6, -3, 2), centre(0, 0, 1);
    const View view = lookAt(eye, centre, glm::radians(24.0), {64, 64});
    const MirroredLight light = tracer.mirrored(view, std::vector<std::uint32_t>{0}, {});
    const ViewRays rays(view);
    int compared = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::dvec3 d = glm::normalize(glm::dvec3(rays.through(glm::vec2(x, y) + 0.5f)));
            const double along = glm::dot(centre - eye, d);
            const double miss = glm::dot(centre - eye, centre - eye) - along * along;
            if (miss > 0.9) continue;  // not the outline, where a facet's height shows
            const glm::dvec3 n = eye + (along - std::sqrt(1 - miss)) * d - centre;
            const glm::dvec3 r = glm::reflect(d, n);
            if (glm::dot(r, glm::dvec3(frame.lighting.sunDirection)) > 0.9) continue;  // steep there
            // Facets of 0.9 degrees and normals of ten bits: the direction is within 0.3 degrees.
            const glm::vec3 expected = skyRadiance(frame.lighting, glm::vec3(r));
            const glm::vec3 traced = light.radiance[static_cast<std::size_t>(64 * y + x)];
            ++compared;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(traced[c], expected[c], 0.03f * expected[c]) << x << " " << y;
        }
    EXPECT_GT(compared, 500);
}

TEST(RayTracerTest, environmentOfAnEmptyPlaceIsSkyAndGround) {
    city::CityModel city = test::boxCity();
    city.chunks.resize(1);  // the ground alone
    RayTracer tracer(city, {});
    tracer.prepare({});
    Lighting light;
    light.sunDirection = light.sunDirection / glm::length(light.sunDirection);
    const glm::dvec3 centre(3, 4, 2.5);
    const reflection::ReferenceMap map = tracer.environmentMap(centre, 16, 0xffffffffu, 1);
    ASSERT_EQ(map.texelCount(), map.colour.size());
    int ground = 0, sky = 0;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const auto i = static_cast<std::size_t>((face * 16 + y) * 16 + x);
                const glm::vec3 d =
                    glm::normalize(reflection::cubeDirection(face, glm::vec2(x, y) + 0.5f, 16));
                const glm::vec3 hit = glm::vec3(centre) - d * (2.5f / d.z);
                if (d.z < 0 && std::abs(hit.x) < 200 && std::abs(hit.y) < 200) {
                    ++ground;
                    EXPECT_NEAR(map.distance[i], -2.5f / d.z, -1e-4f / d.z);
                } else if (d.z > 0) {
                    ++sky;
                    EXPECT_EQ(map.distance[i], INFINITY);
                    EXPECT_EQ(map.colour[i], skyRadiance(light, d));
                }
            }
    EXPECT_GT(ground, 500);
    EXPECT_GT(sky, 700);
}

TEST(RayTracerTest, vehicleIsLeftOutOfItsOwnMap) {
    const Street street;
    RayTracer tracer(street.city, street.models);
    tracer.prepare(street.frame);
    const glm::dvec3 inside(0, 8, 1);
    FrameScene crowded = street.frame;
    crowded.vehicles.push_back(test::poseAt(13, 1, {0, 5.5, 0}));
    tracer.prepare(crowded);
    const auto all = tracer.environmentMap(inside, 16, 0xffffffffu, 1);
    const auto without13 = tracer.environmentMap(inside, 16, 13, 1);
    FrameScene two = street.frame;
    tracer.prepare(two);
    const auto onlyTwo = tracer.environmentMap(inside, 16, 0xffffffffu, 1);
    EXPECT_FALSE(sameBytes(all.distance, without13.distance));
    EXPECT_TRUE(sameBytes(without13.distance, onlyTwo.distance));
    EXPECT_TRUE(sameBytes(without13.colour, onlyTwo.colour));
}

TEST(RayTracerTest, secondMirrorIsSeenInTheFirst) {
    const Street street;
    RayTracer tracer(street.city, street.models);
    tracer.prepare(street.frame);
    const MirroredLight one = tracer.mirrored(street.view, firstAndSecond, {1, 1, false, 1});
    const MirroredLight two = tracer.mirrored(street.view, firstAndSecond, {1, 2, false, 1});
    EXPECT_EQ(one.rays, one.pixels);
    // Only where a mirror shows a mirror are there more rays, and only there may light differ.
    EXPECT_GT(two.rays, one.rays);
    EXPECT_LT(two.rays, 2 * one.rays);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < one.radiance.size(); ++i)
        differ += one.radiance[i] != two.radiance[i] ? 1 : 0;
    EXPECT_GT(differ, 5u);
    EXPECT_LE(differ, 2 * (two.rays - one.rays));  // outlines take their neighbours' light
}

TEST(RayTracerTest, picturesDoNotDependOnThreadsOrParts) {
    const Street street;
    RayTracer tracer(street.city, street.models);
    tracer.prepare(street.frame);
    const TraceOptions options{5, 3, false, 9};
    const TracedPicture whole = tracer.render(street.view, options);
    ASSERT_EQ(whole.radiance.size(), 96u * 54u);
    {
        const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
        EXPECT_TRUE(same(whole, tracer.render(street.view, options)));
    }
    TracedPicture parts = tracer.renderRows(street.view, options, 0, 20);
    parts.append(tracer.renderRows(street.view, options, 20, 54));
    EXPECT_TRUE(same(whole, parts));
    EXPECT_FALSE(same(whole, tracer.render(street.view, {5, 3, false, 10})));  // the seed matters
}

TEST(RayTracerTest, lightForTheRasteriserIsThatOfThePicture) {
    const Street street;
    RayTracer tracer(street.city, street.models);
    tracer.prepare(street.frame);
    const TraceOptions options{4, 2, false, 1};
    const TracedPicture picture = tracer.render(street.view, options);
    const MirroredLight light = tracer.mirrored(street.view, firstAndSecond, options);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < picture.kind.size(); ++i) {
        if (picture.kind[i] != SeenKind::vehicle) continue;
        ++compared;
        EXPECT_EQ(picture.mirrored[i], light.radiance[i]) << i;
    }
    EXPECT_GT(compared, 200u);
    // A picture that is used again for another frame holds nothing of the old one where it counts.
    FrameScene moved = street.frame;
    for (vehicles::VehiclePose& pose : moved.vehicles) pose.position.x += 1.5;
    tracer.prepare(moved);
    MirroredLight reused = light;
    tracer.mirrored(street.view, firstAndSecond, options, reused);
    const MirroredLight fresh = tracer.mirrored(street.view, firstAndSecond, options);
    ASSERT_EQ(reused.low, fresh.low);
    ASSERT_EQ(reused.pixels, fresh.pixels);
    const TracedPicture shown = tracer.render(street.view, options);
    for (std::size_t i = 0; i < shown.kind.size(); ++i) {
        if (shown.kind[i] == SeenKind::vehicle) {
            EXPECT_EQ(reused.radiance[i], fresh.radiance[i]);
        }
    }
}

TEST(RayTracerTest, interruptedPictureGoesOnToTheSameBytes) {
    const Street street;
    RayTracer tracer(street.city, street.models);
    tracer.prepare(street.frame);
    const TraceOptions options{3, 2, false, 4};
    const TracedPicture whole = tracer.render(street.view, options);
    const std::filesystem::path folder = std::filesystem::path(MIRRORSTREET_TEST_OUT) / "parts";
    std::filesystem::remove_all(folder);
    const std::uint64_t key = pictureKey(street.city, street.frame, street.view, options);
    EXPECT_FALSE(
        renderInParts(tracer, street.view, options, folder, key, [](int done, int) { return done < 2; }));
    const std::filesystem::path first = folder / "rows_0.part", second = folder / "rows_16.part";
    ASSERT_TRUE(std::filesystem::exists(second));
    ASSERT_FALSE(std::filesystem::exists(folder / "rows_32.part"));
    std::filesystem::resize_file(second, std::filesystem::file_size(second) - 1);  // damaged
    const auto kept = std::filesystem::last_write_time(first);
    const auto resumed = renderInParts(tracer, street.view, options, folder, key, {});
    ASSERT_TRUE(resumed);
    EXPECT_TRUE(same(whole, *resumed));
    EXPECT_EQ(std::filesystem::last_write_time(first), kept);
    // Other pictures have other keys.
    FrameScene moved = street.frame;
    moved.vehicles[1].position.x += 1e-6;
    EXPECT_NE(key, pictureKey(street.city, moved, street.view, options));
    EXPECT_NE(key, pictureKey(street.city, street.frame, street.view, {3, 3, false, 4}));
    std::filesystem::remove_all(folder);
}

TEST(RayTracerTest, aFilmOfWaterSpreadsItsRaysAsItsRoughnessSays) {
    RayPaths::Scene scene;
    scene.film = 4096;
    WetGround ground;
    ground.lies = 1;
    ground.mirrored = 0.2f;
    PathRay ray;
    const float low = 0.5f;  // radians by which the eye looks down
    ray.direction = {std::cos(low), 0, -std::sin(low)};
    std::vector<PathRay> rays;
    RayPaths::addWetRays(scene, ground, {10, 20, 0}, ray, 0.01f, 5, true, rays);
    ASSERT_EQ(rays.size(), 4096u);
    double weight = 0, along = 0, across = 0;
    for (const PathRay& r : rays) {
        ASSERT_GT(r.direction.z, 0);
        EXPECT_GT(r.origin.z, 0);
        weight += r.weight.x;
        along += std::pow(std::asin(r.direction.z) - low, 2.0);
        across += std::pow(std::atan2(r.direction.y, r.direction.x), 2.0);
    }
    EXPECT_NEAR(weight, 0.2 * wet::filmShare, 1e-4);
    // Second moments of the small angles, to the second order of 5 degrees.
    const double n = static_cast<double>(rays.size()), sigma = filmAngle();
    EXPECT_NEAR(std::sqrt(along / n) / sigma, 1, 0.03);
    EXPECT_NEAR(std::sqrt(across / n) / (sigma * std::tan(low)), 1, 0.05);
    // In mirrors in a row by so many rays as the light is worth; in a puddle by one.
    ray.weight = glm::vec3(0.1f);
    rays.clear();
    RayPaths::addWetRays(scene, ground, {10, 20, 0}, ray, 0.01f, 5, false, rays);
    EXPECT_LT(rays.size(), 4096u / 8);
    ground.puddle = 1;
    rays.clear();
    RayPaths::addWetRays(scene, ground, {10, 20, 0}, ray, 0.01f, 5, true, rays);
    ASSERT_EQ(rays.size(), 1u);
    EXPECT_NEAR(std::asin(rays[0].direction.z), low, 2 * wet::rippleSlope);
}

TEST(RayTracerTest, emptyViewsAndScenesGiveEmptyPictures) {
    const city::CityModel nothing;
    RayTracer tracer(nothing, {});
    tracer.prepare({});
    View none;
    none.size = {0, 0};
    EXPECT_TRUE(tracer.render(none, {}).radiance.empty());
    EXPECT_TRUE(tracer.mirrored(none, {}, {}).radiance.empty());
    EXPECT_EQ(tracer.environmentMap({0, 0, 0}, 0, 0, 1).texelCount(), 0u);
    const View view = lookAt({0, 0, 0}, {1, 0, 1}, 1, {8, 8});
    const TracedPicture sky = tracer.render(view, {});
    for (const SeenKind kind : sky.kind) EXPECT_EQ(kind, SeenKind::sky);
    EXPECT_EQ(tracer.mirrored(view, {}, {}).pixels, 0u);
}

}  // namespace
}  // namespace app
