#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/export/ExportScene.h"
#include "app/export/GltfBuilder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

fs::path emptyFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    fs::path folder = fs::path(MIRRORSTREET_TEST_OUT) / "export" / test->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

tinygltf::Model load(const fs::path& file) {
    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, file.string())) << error;
    EXPECT_EQ(error, "");
    EXPECT_EQ(warning, "");
    return model;
}

std::vector<glm::vec3> vectors(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
    const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    std::vector<glm::vec3> values(accessor.count);
    EXPECT_EQ(view.byteLength, values.size() * sizeof(glm::vec3));
    std::memcpy(values.data(), model.buffers[0].data.data() + view.byteOffset, view.byteLength);
    return values;
}

std::size_t triangles(const tinygltf::Model& model) {
    std::size_t count = 0;
    for (const tinygltf::Node& node : model.nodes)
        if (node.mesh >= 0)
            for (const auto& primitive : model.meshes[static_cast<std::size_t>(node.mesh)].primitives)
                count += model.accessors[static_cast<std::size_t>(primitive.indices)].count / 3;
    return count;
}

city::Vertex vertex(glm::vec3 p, glm::vec3 n, std::uint32_t material = 0) {
    return {p, n, {p.x, p.y}, material};
}

/// A ground of two materials, and a pyramid of one triangle that stands twice.
city::CityModel smallCity() {
    city::CityModel city;
    city.materials.resize(3);
    city.materials[1].pattern = city::Pattern::asphalt;
    city.materials[1].tint = {0.5f, 0.25f, 0.125f};
    city.materials[2].pattern = city::Pattern::foliage;
    city.materials[2].cutout = true;
    city.materials[2].twoSided = true;
    city.materials[2].emission = glm::vec3(3, 0, 0);
    city::Chunk ground;
    ground.kind = city::ChunkKind::ground;
    const glm::vec3 up(0, 0, 1);
    ground.mesh.addQuad(vertex({0, 0, 0}, up), vertex({10, 0, 0}, up), vertex({10, 20, 1}, up),
                        vertex({0, 20, 1}, up));
    ground.mesh.addTriangle(vertex({0, 0, 2}, up, 1), vertex({1, 0, 2}, up, 1), vertex({0, 1, 2}, up, 1));
    city.chunks.push_back(ground);
    city.chunks.push_back({});
    city::Prototype tree;
    tree.name = "tree";
    tree.levels.resize(2);
    tree.levels[0].mesh.addTriangle(vertex({0, 0, 0}, {1, 0, 0}, 2), vertex({0, 1, 0}, {1, 0, 0}, 2),
                                    vertex({0, 0, 5}, {1, 0, 0}, 2));
    city.prototypes.push_back(tree);
    city.placements.push_back({0, glm::translate(glm::mat4(1), glm::vec3(3, 4, 5))});
    city.placements.push_back({0, glm::rotate(glm::translate(glm::mat4(1), glm::vec3(7, 8, 0)),
                                              std::numbers::pi_v<float> / 2, glm::vec3(0, 0, 1))});
    return city;
}

TEST(ExportTest, aCityComesBackWithEveryTriangleYUpAndInstancesShareTheirMesh) {
    const city::CityModel city = smallCity();
    const fs::path file = emptyFolder() / "city.glb";
    exportCity(city, file);
    const tinygltf::Model model = load(file);
    EXPECT_EQ(triangles(model), city.triangleCount());
    EXPECT_EQ(model.meshes.size(), 2u);
    ASSERT_EQ(model.nodes.size(), 3u);
    EXPECT_EQ(model.nodes[1].mesh, model.nodes[2].mesh);
    EXPECT_EQ(model.scenes[0].nodes.size(), 3u);
    ASSERT_EQ(model.meshes[0].primitives.size(), 2u);

    const auto positions = vectors(model, model.meshes[0].primitives[0].attributes.at("POSITION"));
    ASSERT_EQ(positions.size(), 4u);
    EXPECT_EQ(positions[2], glm::vec3(10, 1, -20));  // east 10, north 20, up 1
    EXPECT_EQ(vectors(model, model.meshes[0].primitives[0].attributes.at("NORMAL"))[0], glm::vec3(0, 1, 0));
    const auto& accessor =
        model.accessors[static_cast<std::size_t>(model.meshes[0].primitives[0].attributes.at("POSITION"))];
    EXPECT_EQ(accessor.minValues, (std::vector<double>{0, 0, -20}));
    EXPECT_EQ(accessor.maxValues, (std::vector<double>{10, 1, 0}));

    ASSERT_EQ(model.nodes[1].matrix.size(), 16u);
    EXPECT_FLOAT_EQ(static_cast<float>(model.nodes[1].matrix[12]), 3);
    EXPECT_FLOAT_EQ(static_cast<float>(model.nodes[1].matrix[13]), 5);
    EXPECT_FLOAT_EQ(static_cast<float>(model.nodes[1].matrix[14]), -4);
}

TEST(ExportTest, whatStandsAndMirrorsIsANodeOfItsOwnInPolishedMetal) {
    city::CityModel city = smallCity();
    const fs::path bare = emptyFolder() / "bare.glb", file = bare.parent_path() / "city.glb";
    exportCity(city, bare);
    city.reflectors.push_back({"sphere",
                               city::StandingReflector::Shape::sphere,
                               city::StandingReflector::Stuff::chrome,
                               {3, 4, 0.5f},
                               1,
                               2});
    exportCity(city, file);
    const tinygltf::Model model = load(file);
    EXPECT_EQ(triangles(model),
              triangles(load(bare)) + city::reflectorMesh(city.reflectors[0], 4).triangleCount());
    const auto node = std::find_if(model.nodes.begin(), model.nodes.end(),
                                   [](const tinygltf::Node& n) { return n.name == "sphere"; });
    ASSERT_NE(node, model.nodes.end());
    ASSERT_EQ(node->matrix.size(), 16u);
    EXPECT_NEAR(node->matrix[12], 3, 1e-5);
    EXPECT_NEAR(node->matrix[13], 0.5, 1e-5) << "glTF's y is up";
    EXPECT_NEAR(node->matrix[14], -4, 1e-5);
    const auto& primitive = model.meshes[static_cast<std::size_t>(node->mesh)].primitives.at(0);
    const auto& metal = model.materials[static_cast<std::size_t>(primitive.material)].pbrMetallicRoughness;
    EXPECT_GT(metal.metallicFactor, 0.5);
    EXPECT_LT(metal.roughnessFactor, 0.1);
}

TEST(ExportTest, materialsKeepColourPatternAndCutOut) {
    const fs::path file = emptyFolder() / "city.glb";
    exportCity(smallCity(), file);
    const tinygltf::Model model = load(file);
    ASSERT_EQ(model.materials.size(), 3u);
    EXPECT_EQ(model.materials[0].pbrMetallicRoughness.baseColorTexture.index, -1);
    EXPECT_EQ(model.materials[1].pbrMetallicRoughness.baseColorFactor,
              (std::vector<double>{0.5, 0.25, 0.125, 1}));
    EXPECT_EQ(model.materials[1].pbrMetallicRoughness.metallicFactor, 0);
    EXPECT_EQ(model.materials[2].alphaMode, "MASK");
    EXPECT_TRUE(model.materials[2].doubleSided);
    EXPECT_EQ(model.materials[2].emissiveFactor, (std::vector<double>{1, 0, 0}));
    EXPECT_TRUE(model.materials[2].extensions.contains("KHR_materials_emissive_strength"));
    // The loader has decoded the embedded pictures.
    ASSERT_EQ(model.images.size(), 2u);
    EXPECT_GE(model.images[0].width, 16);
    EXPECT_EQ(
        model.images[0].image.size(),
        static_cast<std::size_t>(model.images[0].width * model.images[0].height * model.images[0].component));
    ASSERT_EQ(model.textures.size(), 2u);
    EXPECT_EQ(model.samplers[0].wrapS, TINYGLTF_TEXTURE_WRAP_REPEAT);
}

TEST(ExportTest, turningAPlacementIsTurningThePointsOfItsMesh) {
    const city::CityModel city = smallCity();
    for (const city::Placement& placement : city.placements)
        for (const city::Vertex& v : city.prototypes[0].levels[0].mesh.vertices) {
            const glm::vec3 expected =
                gltfFromWorld(glm::vec3(placement.worldFromPrototype * glm::vec4(v.position, 1)));
            const glm::vec3 actual(gltfFromWorldTransform(placement.worldFromPrototype) *
                                   glm::vec4(gltfFromWorld(v.position), 1));
            EXPECT_LT(glm::distance(actual, expected), 1e-5f);
        }
}

vehicles::VehicleModel smallCar() {
    vehicles::VehicleModel car;
    car.name = "test";
    car.levels.resize(1);
    // A nose at x = 2 on the left side.
    car.levels[0].body.addTriangle(vertex({2, 0.5f, 0.3f}, {0, 0, 1}), vertex({2, 0.6f, 0.3f}, {0, 0, 1}),
                                   vertex({1, 0.5f, 0.3f}, {0, 0, 1}));
    car.wheel.addTriangle(vertex({0, 0.1f, 0}, {0, 1, 0}, 3), vertex({0.1f, 0.1f, 0}, {0, 1, 0}, 3),
                          vertex({0, 0.1f, 0.1f}, {0, 1, 0}, 3));
    car.wheels.push_back({{1.3f, 0.8f, 0.3f}, true, false});
    car.wheels.push_back({{1.3f, -0.8f, 0.3f}, true, true});
    return car;
}

TEST(ExportTest, aVehicleLooksAlongPlusZAndItsWheelsFaceOutwards) {
    const fs::path file = emptyFolder() / "car.glb";
    exportVehicle(smallCar(), file);
    const tinygltf::Model model = load(file);
    const auto body = vectors(model, model.meshes[0].primitives[0].attributes.at("POSITION"));
    EXPECT_EQ(body[0], glm::vec3(0.5f, 0.3f, 2));
    EXPECT_EQ(model.materials[static_cast<std::size_t>(model.meshes[0].primitives[0].material)].name,
              "paint");
    ASSERT_EQ(model.nodes.size(), 3u);
    EXPECT_EQ(model.nodes[0].children, (std::vector<int>{1, 2}));
    for (const auto& [index, outside] : {std::pair(1u, 1.0), std::pair(2u, -1.0)}) {
        const std::vector<double>& m = model.nodes[index].matrix;
        ASSERT_EQ(m.size(), 16u);
        EXPECT_NEAR(m[0], outside,
                    1e-6);  // the wheel's outside, its x in glTF's frame, points away from the car
        EXPECT_NEAR(m[12], 0.8 * outside, 1e-6);
        EXPECT_NEAR(m[14], 1.3, 1e-6);
    }
}

TEST(ExportTest, aDrivePutsTheVehicleWhereItStands) {
    DriveFrame frame;
    frame.camera = {{1, 2, 3}, {4, 5, 6}};
    vehicles::VehiclePose pose;
    pose.position = {10, 20, 0.5};
    pose.heading = 2.5;
    pose.paint = {0.25f, 0.5f, 1};
    frame.vehicles.push_back(pose);
    const fs::path file = emptyFolder() / "drive.json";
    exportDrive(std::vector<DriveFrame>{frame, frame}, 60, {1280, 720}, 30, file);
    std::ifstream in(file);
    const auto drive = nlohmann::json::parse(in);
    EXPECT_EQ(drive["camera"].size(), 2u);
    EXPECT_EQ(drive["camera"][0]["eye"], (std::vector<double>{1, 3, -2}));
    EXPECT_EQ(drive["cars"][1][0]["p"], (std::vector<double>{10, 0.5, -20}));
    EXPECT_EQ(drive["fov_y_deg"], 60);
    EXPECT_EQ(drive["size"], (std::vector<int>{1280, 720}));
    EXPECT_EQ(drive["paint"][0], (std::vector<double>{0.25, 0.5, 1}));
    // The nose of the exported car, turned by yaw about +y and moved to p, is the nose of the car in the
    // world.
    const double yaw = drive["cars"][0][0]["yaw"];
    const glm::vec3 nose = gltfFromVehicle({2, 0.5f, 0.3f});
    const glm::vec3 turned(glm::rotate(glm::mat4(1), static_cast<float>(yaw), glm::vec3(0, 1, 0)) *
                           glm::vec4(nose, 1));
    const double c = std::cos(2.5), s = std::sin(2.5);
    const glm::vec3 world(10 + 2 * c - 0.5 * s, 20 + 2 * s + 0.5 * c, 0.5 + 0.3);
    EXPECT_LT(glm::distance(turned + glm::vec3(10, 0.5f, -20), gltfFromWorld(world)), 1e-5f);
}

TEST(ExportTest, nothingIsWrittenForNothingOrToNowhere) {
    const fs::path folder = emptyFolder();
    EXPECT_THROW(exportCity({}, folder / "city.glb"), std::runtime_error);
    EXPECT_THROW(exportVehicle({}, folder / "car.glb"), std::runtime_error);
    std::ofstream(folder / "file") << "x";
    EXPECT_THROW(exportCity(smallCity(), folder / "file" / "city.glb"), std::runtime_error);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace app
