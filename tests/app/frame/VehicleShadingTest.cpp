#include "app/frame/VehicleShading.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <regex>
#include <string>

#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

using reflection::SeededRandom;
using vehicles::Surface;

std::string shader(const std::string& name) {
    std::ifstream in(std::string(MIRRORSTREET_SOURCE_DIR) + "/data/shaders/" + name);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    return std::regex_replace(text, std::regex("\\s+"), " ");
}

struct Row {
    glm::vec3 albedo;
    float f0;
};

/// The shader's own table of surfaces.
std::vector<Row> shaderSurfaces() {
    const std::string text = shader("vehicle.vert");
    std::vector<Row> rows;
    const std::regex row(R"(vec4\(([0-9.]+), ([0-9.]+), ([0-9.]+), ([0-9.]+)\))");
    const std::size_t start = text.find("const vec4 surfaces[");
    if (start == std::string::npos) return rows;
    const std::string table = text.substr(start, text.find(';', start) - start);
    for (std::sregex_iterator it(table.begin(), table.end(), row), end; it != end; ++it)
        rows.push_back(
            {{std::stof((*it)[1]), std::stof((*it)[2]), std::stof((*it)[3])}, std::stof((*it)[4])});
    return rows;
}

glm::dvec3 mix(const glm::dvec3& a, const glm::dvec3& b, double f) {
    return a * (1 - f) + b * f;
}

/// vehicle.vert and vehicle.frag without REFLECTIVE, in full sun, line by line in double.
glm::dvec3 shaderRadiance(const Row& s, const Lighting& l, int surface, const vehicles::VehiclePose& pose,
                          const glm::dvec3& n, const glm::dvec3& towardsEye) {
    const double inversePi = 0.31830989, sun = 1, lamps = l.lampsLit ? 1 : 0;
    const glm::dvec3 sky(l.skyIrradiance), ground(l.groundIrradiance), sunlight(l.sunIrradiance),
        toSun(l.sunDirection);
    const glm::dvec3 albedo = surface == 0 || surface == 10 ? glm::dvec3(pose.paint) : glm::dvec3(s.albedo);
    const glm::dvec3 light =
        mix(ground, sky, 0.5 + 0.5 * n.z) * 0.85 + sunlight * (sun * std::max(glm::dot(n, toSun), 0.0));
    glm::dvec3 emission(0);
    if (surface == 5) emission = glm::dvec3(6.0, 5.6, 5.0) * lamps;
    if (surface == 6) emission = glm::dvec3(1.6, 0.05, 0.03) * (1.4 * (pose.braking ? 1 : 0) + 0.35 * lamps);
    const glm::dvec3 diffuse = albedo * light * inversePi + emission;
    const double f0 = s.f0, coated = s.f0 >= 0.03f ? 1 : 0;
    const double fresnel = f0 + (1 - f0) * coated * std::pow(1 - std::max(glm::dot(n, towardsEye), 0.0), 5);
    const glm::dvec3 reflected = 2 * glm::dot(n, towardsEye) * n - towardsEye;
    glm::dvec3 mirrored = mix(ground, sky, std::clamp(reflected.z * 2 + 0.5, 0.0, 1.0)) * (inversePi * 0.8);
    mirrored += sunlight * (8 * std::pow(std::max(glm::dot(reflected, toSun), 0.0), 128) * coated * sun);
    return diffuse * (1 - fresnel) + mirrored * fresnel;
}

glm::vec3 randomDirection(SeededRandom& random) {
    const double z = random.between(-1, 1), angle = random.between(0, 6.2831853), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

TEST(VehicleShadingTest, shadersStillSayWhatIsTranscribedHere) {
    // The statements that shaderRadiance above repeats; where one changes, change it and VehicleShading.cpp.
    const std::string vert = shader("vehicle.vert"), frag = shader("vehicle.frag"),
                      frame = shader("frame.glsl");
    for (const char* line : {"vec3 albedo = surface == 0u || surface == 10u ? paint.rgb : s.rgb;",
                             "vec3 light = ambientIrradiance(n, 0.85) + frame.sunIrradiance.rgb * (sun * "
                             "max(dot(n, frame.sunDirection.xyz), 0.0));",
                             "if (surface == 5u) emission = vec3(6.0, 5.6, 5.0) * frame.skyIrradiance.w;",
                             "if (surface == 6u) emission = vec3(1.6, 0.05, 0.03) * (1.4 * paint.w + 0.35 * "
                             "frame.skyIrradiance.w);",
                             "diffuseOut = albedo * light * inversePi + emission;",
                             "coatOut = vec3(s.w, s.w >= 0.03 ? 1.0 : 0.0, sun);"})
        EXPECT_NE(vert.find(line), std::string::npos) << line;
    for (const char* line :
         {"float facing = max(dot(n, towardsEye), 0.0); float grazing = 1.0 - facing; float grazing2 = "
          "grazing * grazing;",
          "float fresnel = coat.x + (1.0 - coat.x) * coat.y * grazing2 * grazing2 * grazing;",
          "vec3 reflected = 2.0 * dot(n, towardsEye) * n - towardsEye;",
          "float up = clamp(reflected.z * 2.0 + 0.5, 0.0, 1.0);",
          "vec3 mirrored = mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, up) * (inversePi * 0.8);",
          "mirrored += frame.sunIrradiance.rgb * (8.0 * glint * coat.y * coat.z);",
          "glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; glint *= glint; "
          "glint *= glint; mirrored",
          "vec3 radiance = diffuse * (1.0 - fresnel) + mirrored * fresnel;"})
        EXPECT_NE(frag.find(line), std::string::npos) << line;
    EXPECT_NE(
        frame.find(
            "return mix(frame.groundIrradiance.rgb, frame.skyIrradiance.rgb, 0.5 + 0.5 * normal.z) * open;"),
        std::string::npos);
}

TEST(VehicleShadingTest, equalsTheShadersOnEverySurface) {
    const std::vector<Row> rows = shaderSurfaces();
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(Surface::count));
    SeededRandom random(31);
    for (int k = 0; k < 20000; ++k) {
        const int surface = random.below(static_cast<int>(rows.size()));
        Lighting lighting = lightingAt(random.between(0, 24));
        if (random.below(4) == 0) lighting.lampsLit = !lighting.lampsLit;
        vehicles::VehiclePose pose;
        pose.paint = {random.unit(), random.unit(), random.unit()};
        pose.braking = random.below(2) == 0;
        const glm::vec3 n = randomDirection(random);
        glm::vec3 eye = randomDirection(random);
        // Now and then straight into the sun's glint, which random directions miss.
        if (k % 5 == 0)
            eye = glm::normalize(2 * glm::dot(n, lighting.sunDirection) * n - lighting.sunDirection +
                                 0.03f * eye);
        const glm::vec3 got = vehicleRadiance(lighting, static_cast<Surface>(surface), pose, n, eye);
        const glm::dvec3 truth =
            shaderRadiance(rows[static_cast<std::size_t>(surface)], lighting, surface, pose, n, eye);
        // pow(x, 128) multiplies a float's rounding by 128: 128 * 6e-8 * a few operations.
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(got[c], truth[c], 1e-6 + 1e-4 * std::abs(truth[c])) << surface;
    }
}

TEST(VehicleShadingTest, vehicleFrameIsForwardLeftUp) {
    vehicles::VehiclePose pose;
    pose.heading = 1.1;
    pose.pitch = 0.2;
    const glm::mat3 m = worldFromVehicle(pose);
    EXPECT_NEAR(glm::length(glm::cross(m[0], m[1]) - m[2]), 0, 1e-6);
    EXPECT_NEAR(glm::dot(m[0], m[1]), 0, 1e-6);
    EXPECT_NEAR(m[0].z, std::sin(0.2), 1e-6) << "nose up";
    EXPECT_NEAR(std::atan2(m[0].y, m[0].x), 1.1, 1e-6);
    EXPECT_GT(m[2].z, 0.9f);
}

}  // namespace
}  // namespace app
