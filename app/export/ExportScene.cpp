#include "app/export/ExportScene.h"

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "app/export/GltfBuilder.h"
#include "app/report/AsideFile.h"
#include "city/model/PatternImages.h"

namespace app {

namespace {

constexpr std::array<const char*, static_cast<std::size_t>(city::Pattern::count)> patternNames{
    "plain",     "asphalt",  "pavement",      "cobbles",     "grass",       "soil",        "water",
    "roofTiles", "roofFlat", "facadePlaster", "facadeBrick", "facadeStone", "facadeGlass", "wall",
    "shopFront", "bark",     "foliage",       "metal",       "marking",     "rail",        "stoneFront"};

std::array<double, 3> gltfPoint(const glm::dvec3& v) {
    return {v.x, v.z, -v.y};
}

std::array<double, 3> numbers(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

/// What each surface of a vehicle is in glTF's terms. Bright metal is only partly metallic: a renderer
/// without an environment map would show it black.
GltfMaterial surfaceMaterial(vehicles::Surface surface) {
    using vehicles::Surface;
    switch (surface) {
        case Surface::paint:
            return {.name = "paint", .baseColour = glm::vec3(0.5f), .roughness = 0.35f, .clearCoat = 1};
        case Surface::glass:
            return {.name = "glass", .baseColour = glm::vec3(0.02f), .roughness = 0.03f};
        case Surface::chrome:
            return {.name = "chrome",
                    .baseColour = {0.55f, 0.556f, 0.554f},
                    .metallic = 0.6f,
                    .roughness = 0.05f};
        case Surface::tyre:
            return {.name = "tyre", .baseColour = glm::vec3(0.02f), .roughness = 0.9f};
        case Surface::rim:
            return {.name = "rim", .baseColour = glm::vec3(0.6f), .metallic = 0.4f, .roughness = 0.3f};
        case Surface::headLamp:
            return {.name = "headLamp", .baseColour = glm::vec3(0.8f), .roughness = 0.1f};
        case Surface::tailLamp:
            return {.name = "tailLamp", .baseColour = {0.4f, 0.01f, 0.01f}, .roughness = 0.15f};
        case Surface::trim:
            return {.name = "trim", .baseColour = glm::vec3(0.03f), .roughness = 0.7f};
        case Surface::polishedStone:
            return {.name = "polishedStone", .baseColour = glm::vec3(0.014f), .roughness = 0.04f};
        case Surface::cloth:
            return {.name = "cloth", .baseColour = glm::vec3(1), .roughness = 1};
        case Surface::skin:
            return {.name = "skin", .baseColour = {0.45f, 0.25f, 0.17f}, .roughness = 0.6f};
        case Surface::interior:
        case Surface::count:
            break;
    }
    return {.name = "interior", .baseColour = glm::vec3(0.05f), .roughness = 0.9f};
}

}  // namespace

void exportCity(const city::CityModel& city, const std::filesystem::path& file) {
    GltfBuilder builder;
    const auto images = city::paintPatterns();
    std::array<int, patternNames.size()> textures;
    textures.fill(-1);
    for (const city::Material& material : city.materials) {
        const auto pattern = static_cast<std::size_t>(material.pattern);
        if (pattern < textures.size() && textures[pattern] < 0 && material.pattern != city::Pattern::plain)
            textures[pattern] =
                builder.addTexture(patternNames[pattern], images[pattern].size, images[pattern].rgba);
        builder.addMaterial({.name = patternNames[std::min(pattern, patternNames.size() - 1)],
                             .baseColour = material.tint,
                             .texture = pattern < textures.size() ? textures[pattern] : -1,
                             .roughness = material.roughness,
                             .emission = material.emission,
                             .twoSided = material.twoSided,
                             .cutout = material.cutout});
    }
    if (city.materials.empty()) builder.addMaterial({.name = "plain"});
    const auto materialOf = [&](std::uint32_t m) {
        return m < city.materials.size() ? static_cast<int>(m) : 0;
    };
    const auto kindName = [](city::ChunkKind kind) {
        return kind == city::ChunkKind::ground     ? "ground"
               : kind == city::ChunkKind::building ? "building"
                                                   : "furniture";
    };
    for (const city::Chunk& chunk : city.chunks) {
        const std::string name = kindName(chunk.kind);
        const int mesh = builder.addMesh(name, chunk.mesh, gltfFromWorld, materialOf);
        if (mesh >= 0) builder.addNode(name, mesh);
    }
    std::vector<int> prototypes;
    for (const city::Prototype& prototype : city.prototypes)
        prototypes.push_back(
            prototype.levels.empty()
                ? -1
                : builder.addMesh(prototype.name, prototype.levels.front().mesh, gltfFromWorld, materialOf));
    for (const city::Placement& placement : city.placements) {
        const int mesh = prototypes.at(placement.prototype);
        if (mesh >= 0)
            builder.addNode(city.prototypes[placement.prototype].name, mesh,
                            gltfFromWorldTransform(placement.worldFromPrototype));
    }
    for (const city::StandingReflector& reflector : city.reflectors) {
        const bool granite = reflector.stuff == city::StandingReflector::Stuff::granite;
        const int material = builder.addMaterial(
            surfaceMaterial(granite ? vehicles::Surface::polishedStone : vehicles::Surface::chrome));
        const int mesh = builder.addMesh(reflector.name, city::reflectorMesh(reflector, 4), gltfFromWorld,
                                         [material](std::uint32_t) { return material; });
        if (mesh >= 0)
            builder.addNode(reflector.name, mesh,
                            glm::translate(glm::mat4(1), gltfFromWorld(reflector.foot)));
    }
    builder.write(file);
}

void exportVehicle(const vehicles::VehicleModel& model, const std::filesystem::path& file) {
    GltfBuilder builder;
    for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(vehicles::Surface::count); ++s)
        builder.addMaterial(surfaceMaterial(static_cast<vehicles::Surface>(s)));
    const auto materialOf = [](std::uint32_t m) {
        return static_cast<int>(std::min(m, static_cast<std::uint32_t>(vehicles::Surface::count) - 1));
    };
    if (!model.levels.empty()) {
        const int body = builder.addNode(
            model.name, builder.addMesh(model.name, model.levels.front().body, gltfFromVehicle, materialOf));
        const int wheel = model.levels.front().wheelsInBody
                              ? -1
                              : builder.addMesh("wheel", model.wheel, gltfFromVehicle, materialOf);
        if (wheel >= 0)
            for (const vehicles::VehicleModel::Wheel& w : model.wheels) {
                glm::mat4 transform = glm::translate(glm::mat4(1), gltfFromVehicle(w.centre));
                // The vehicle's up is glTF's y.
                if (w.mirrored)
                    transform = glm::rotate(transform, std::numbers::pi_v<float>, glm::vec3(0, 1, 0));
                builder.addNode("wheel", wheel, transform, body);
            }
    }
    builder.write(file);
}

void exportDrive(std::span<const DriveFrame> frames, double fovYDegrees, glm::ivec2 size, std::uint32_t fps,
                 const std::filesystem::path& file) {
    using nlohmann::ordered_json;
    ordered_json camera = ordered_json::array();
    ordered_json cars = ordered_json::array();
    ordered_json paint = ordered_json::array();
    for (const DriveFrame& frame : frames) {
        camera.push_back({{"eye", gltfPoint(frame.camera.eye)}, {"target", gltfPoint(frame.camera.target)}});
        ordered_json row = ordered_json::array();
        for (const vehicles::VehiclePose& v : frame.vehicles) {
            // The file's front is +z; +x, where a heading of 0 looks, is a quarter turn about +y from there.
            const double yaw = std::remainder(v.heading + std::numbers::pi / 2, 2 * std::numbers::pi);
            row.push_back({{"p", gltfPoint(v.position)}, {"yaw", yaw}});
        }
        cars.push_back(std::move(row));
    }
    if (!frames.empty())
        for (const vehicles::VehiclePose& v : frames.front().vehicles) paint.push_back(numbers(v.paint));
    const ordered_json document{{"camera", camera},         {"cars", cars},
                                {"paint", paint},           {"fov_y_deg", fovYDegrees},
                                {"size", {size.x, size.y}}, {"fps", fps}};
    writeTextFile(file, document.dump() + "\n");
}

}  // namespace app
