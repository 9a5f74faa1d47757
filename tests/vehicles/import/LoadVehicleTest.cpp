#include "vehicles/import/LoadVehicle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <stdexcept>

namespace vehicles {
namespace {

using testing::HasSubstr;

/// A GLB written byte by byte: a body (box) of 4 x 1.6 x 1.2, and four wheels (octagonal prisms of radius
/// 0.3), y up, +z forward, as glTF has it; every mesh with its own index type.
class GlbWriter {
  public:
    enum class Indices { bytes, shorts, ints, none };

    int addBox(glm::vec3 half, Indices type, const std::string& name, int material) {
        std::vector<glm::vec3> p;
        for (int i = 0; i < 8; ++i)
            p.push_back({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
        const std::vector<std::uint32_t> t{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                           2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
        return addMesh(p, t, type, name, material);
    }
    int addPrism(float radius, float half, Indices type, const std::string& name, int material) {
        std::vector<glm::vec3> p;
        std::vector<std::uint32_t> t;
        for (int i = 0; i < 8; ++i)
            for (const float side : {-half, half})
                p.push_back({side, radius * std::cos(0.785398163f * static_cast<float>(i)),
                             radius * std::sin(0.785398163f * static_cast<float>(i))});
        for (std::uint32_t i = 0; i < 8; ++i) {
            const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % 8);
            t.insert(t.end(), {a, b, b + 1, a, b + 1, a + 1});
            if (i > 0 && i < 7) t.insert(t.end(), {1, a + 1, b + 1, 0, b, a});
        }
        return addMesh(p, t, type, name, material);
    }
    int addMesh(std::vector<glm::vec3> p, const std::vector<std::uint32_t>& t, Indices type,
                const std::string& name, int material) {
        if (type == Indices::none) {
            std::vector<glm::vec3> soup;
            for (const auto i : t) soup.push_back(p[i]);
            p = soup;
        }
        const int position = addAccessor(p.data(), p.size() * sizeof(glm::vec3), 5126, p.size(), "VEC3");
        std::string primitive = "{\"attributes\":{\"POSITION\":" + std::to_string(position) +
                                "},\"material\":" + std::to_string(material);
        if (type == Indices::bytes)
            primitive += ",\"indices\":" + std::to_string(addIndices<std::uint8_t>(t, 5121));
        if (type == Indices::shorts)
            primitive += ",\"indices\":" + std::to_string(addIndices<std::uint16_t>(t, 5123));
        if (type == Indices::ints)
            primitive += ",\"indices\":" + std::to_string(addIndices<std::uint32_t>(t, 5125));
        meshes_.push_back("{\"name\":\"" + name + "\",\"primitives\":[" + primitive + "}]}");
        return static_cast<int>(meshes_.size()) - 1;
    }
    void addNode(const std::string& json) { nodes_.push_back(json); }
    void addMaterial(const std::string& json) { materials_.push_back(json); }

    std::vector<char> bytes(const std::string& more = "", const std::string& moreBuffers = "") const {
        const auto list = [](const std::vector<std::string>& items) {
            std::string out = "[";
            for (std::size_t i = 0; i < items.size(); ++i) out += (i ? "," : "") + items[i];
            return out + "]";
        };
        std::string roots;
        for (std::size_t i = 0; i < nodes_.size(); ++i) roots += (i ? "," : "") + std::to_string(i);
        std::string json = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[" + roots +
                           "]}],\"nodes\":" + list(nodes_) + ",\"meshes\":" + list(meshes_) +
                           ",\"materials\":" + list(materials_) + ",\"accessors\":" + list(accessors_) +
                           ",\"bufferViews\":" + list(views_) +
                           ",\"buffers\":[{\"byteLength\":" + std::to_string(data_.size()) + "}" +
                           moreBuffers + "]" + more + "}";
        while (json.size() % 4) json += ' ';
        std::vector<char> data = data_;
        while (data.size() % 4) data.push_back(0);
        std::vector<char> out;
        const auto word = [&](std::uint32_t v) {
            out.insert(out.end(), reinterpret_cast<const char*>(&v), reinterpret_cast<const char*>(&v) + 4);
        };
        word(0x46546C67);
        word(2);
        word(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + data.size()));
        word(static_cast<std::uint32_t>(json.size()));
        word(0x4E4F534A);
        out.insert(out.end(), json.begin(), json.end());
        word(static_cast<std::uint32_t>(data.size()));
        word(0x004E4942);
        out.insert(out.end(), data.begin(), data.end());
        return out;
    }

  private:
    template <typename T>
    int addIndices(const std::vector<std::uint32_t>& t, int type) {
        const std::vector<T> narrow(t.begin(), t.end());
        return addAccessor(narrow.data(), narrow.size() * sizeof(T), type, narrow.size(), "SCALAR");
    }
    int addAccessor(const void* from, std::size_t size, int type, std::size_t count,
                    const std::string& shape) {
        while (data_.size() % 4) data_.push_back(0);
        views_.push_back("{\"buffer\":0,\"byteOffset\":" + std::to_string(data_.size()) +
                         ",\"byteLength\":" + std::to_string(size) + "}");
        const char* begin = static_cast<const char*>(from);
        data_.insert(data_.end(), begin, begin + size);
        accessors_.push_back("{\"bufferView\":" + std::to_string(views_.size() - 1) +
                             ",\"componentType\":" + std::to_string(type) +
                             ",\"count\":" + std::to_string(count) + ",\"type\":\"" + shape + "\"}");
        return static_cast<int>(accessors_.size()) - 1;
    }
    std::vector<char> data_;
    std::vector<std::string> meshes_, nodes_, materials_, accessors_, views_;
};

GlbWriter car() {
    GlbWriter glb;
    glb.addMaterial(R"({"name":"CarPaint","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.1,1]}})");
    glb.addMaterial(R"({"name":"Window_Glass"})");
    glb.addMaterial(R"({"name":"Tire","pbrMetallicRoughness":{"baseColorFactor":[0.02,0.02,0.02,1]}})");
    glb.addMaterial(
        R"({"name":"m3","pbrMetallicRoughness":{"baseColorFactor":[0.9,0.9,0.9,1],"metallicFactor":1,"roughnessFactor":0.1}})");
    glb.addMaterial(R"({"name":"Lamps"})");
    const int body = glb.addBox({0.8f, 0.4f, 2}, GlbWriter::Indices::shorts, "hull", 0);
    const int cabin = glb.addBox({0.6f, 0.3f, 0.8f}, GlbWriter::Indices::none, "cabin", 1);
    const int bar = glb.addBox({0.7f, 0.05f, 0.05f}, GlbWriter::Indices::bytes, "bar", 3);
    const int lamp = glb.addBox({0.1f, 0.05f, 0.05f}, GlbWriter::Indices::ints, "round", 4);
    const int wheel = glb.addPrism(0.3f, 0.1f, GlbWriter::Indices::bytes, "w", 2);
    const auto node = [&](const std::string& name, int mesh, const std::string& at,
                          const std::string& more = "") {
        glb.addNode("{\"name\":\"" + name + "\",\"mesh\":" + std::to_string(mesh) + ",\"translation\":[" +
                    at + "]" + more + "}");
    };
    node("hull", body, "0,0.6,0");
    node("cabin", cabin, "0,1.2,-0.2");
    node("bar", bar, "0,0.6,1.9");
    node("front", lamp, "0.5,0.6,1.92");
    node("back", lamp, "0.5,0.6,-1.92");
    node("Wheel_FL", wheel, "0.7,0.3,1.3");
    // Turned round its axle and scaled evenly by nothing: the same wheel through another transform.
    node("Wheel_FR", wheel, "-0.7,0.3,1.3", ",\"rotation\":[1,0,0,0],\"scale\":[1,1,1]");
    node("Wheel_RL", wheel, "0.7,0.3,-1.1");
    node("Wheel_RR", wheel, "-0.7,0.3,-1.1");
    return glb;
}

class LoadVehicle : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(MIRRORSTREET_TEST_OUT) / "load-vehicle";
        std::filesystem::create_directories(folder_);
    }
    std::filesystem::path write(const std::string& name, const std::vector<char>& bytes) {
        const auto file = folder_ / name;
        std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return file;
    }
    /// The one-sentence complaint, or "" if it loads.
    std::string complaint(const std::filesystem::path& file, float length = 4) {
        try {
            loadVehicle(file, length);
        } catch (const std::runtime_error& e) {
            EXPECT_THAT(e.what(), HasSubstr(file.string()));
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        return "";
    }
    std::filesystem::path folder_;
};

TEST_F(LoadVehicle, TurnsScalesAndStandsItOnTheRoad) {
    const VehicleModel m = loadVehicle(write("car.glb", car().bytes()), 8);
    EXPECT_EQ(m.name, "car");
    EXPECT_FLOAT_EQ(m.length, 8);
    EXPECT_NEAR(m.width, 3.2f, 1e-3f);
    EXPECT_NEAR(m.height, 3.0f, 1e-3f);  // 1.5 from the road to the cabin's top, twice as large
    const city::Aabb box = m.levels[0].body.bounds();
    EXPECT_NEAR(box.size().x, 8, 1e-3f);
    EXPECT_NEAR(box.min.z, 0.4f, 1e-3f);
    // The origin is under the middle of the wheelbase, which lies 0.1 before the middle of the hull.
    EXPECT_NEAR(box.centre().x, -0.2f, 1e-3f);
    for (const auto& v : m.levels[0].body.vertices) ASSERT_NEAR(glm::length(v.normal), 1, 1e-4f);
}

TEST_F(LoadVehicle, SeparatesTheWheelsSoThatTheyTurn) {
    const VehicleModel m = loadVehicle(write("car.glb", car().bytes()), 4);
    ASSERT_EQ(m.wheels.size(), 4u);
    EXPECT_NEAR(m.wheelRadius, 0.3f, 1e-3f);
    EXPECT_NEAR(m.wheel.bounds().size().x, 0.6f, 1e-3f);
    EXPECT_NEAR(m.wheel.bounds().size().y, 0.2f, 1e-3f);
    EXPECT_NEAR(glm::length(m.wheel.bounds().centre()), 0, 1e-4f);
    for (const auto& w : m.wheels) {
        EXPECT_NEAR(std::abs(w.centre.x), 1.2f, 1e-3f);
        EXPECT_NEAR(w.centre.z, 0.3f, 1e-3f);
        EXPECT_EQ(w.mirrored, w.centre.y < 0);
        EXPECT_EQ(w.steered, w.centre.x > 0);
    }
    for (const auto& v : m.levels[0].body.vertices)
        EXPECT_NE(v.material, static_cast<std::uint32_t>(Surface::tyre));
}

TEST_F(LoadVehicle, MapsMaterialsByNameAndProperties) {
    const VehicleModel m = loadVehicle(write("car.glb", car().bytes()), 4);
    std::set<Surface> seen;
    for (const auto& v : m.levels[0].body.vertices) {
        const auto s = static_cast<Surface>(v.material);
        seen.insert(s);
        if (s == Surface::headLamp) {
            EXPECT_GT(v.position.x, 1);
        }
        if (s == Surface::tailLamp) {
            EXPECT_LT(v.position.x, -1);
        }
        if (s == Surface::glass) {
            EXPECT_GT(v.position.z, 0.8f);
        }
    }
    EXPECT_THAT(seen, testing::UnorderedElementsAre(Surface::paint, Surface::glass, Surface::chrome,
                                                    Surface::headLamp, Surface::tailLamp));
    for (const auto& v : m.wheel.vertices) EXPECT_EQ(v.material, static_cast<std::uint32_t>(Surface::tyre));
}

TEST_F(LoadVehicle, ComputesNormalsThatFaceOutwards) {
    const VehicleModel m = loadVehicle(write("car.glb", car().bytes()), 4);
    for (const auto& v : m.wheel.vertices) EXPECT_GT(glm::dot(v.normal, v.position), 0);
}

TEST_F(LoadVehicle, SaysWhatIsWrongWithAFile) {
    EXPECT_THAT(complaint(folder_ / "nowhere.glb"), HasSubstr("check that it exists"));
    EXPECT_THAT(complaint(folder_), HasSubstr("check that it exists"));
    EXPECT_THAT(complaint(write("empty.glb", {})), HasSubstr("inside the header"));
    const std::string text = "solid not a car at all, but long enough for a header";
    EXPECT_THAT(complaint(write("text.glb", {text.begin(), text.end()})), HasSubstr("not a binary glTF"));
    auto old = car().bytes();
    old[4] = 1;
    EXPECT_THAT(complaint(write("old.glb", old)), HasSubstr("version 1"));
    GlbWriter none;
    none.addMaterial("{\"name\":\"paint\"}");
    none.addPrism(1, 1, GlbWriter::Indices::bytes, "unused", 0);
    none.addNode("{\"name\":\"alone\"}");
    EXPECT_THAT(complaint(write("none.glb", none.bytes())), HasSubstr("no triangles"));
    EXPECT_THAT(
        complaint(write("draco.glb", car().bytes(R"(,"extensionsUsed":["KHR_draco_mesh_compression"])"))),
        HasSubstr("KHR_draco_mesh_compression"));
    EXPECT_THAT(
        complaint(write("packed.glb", car().bytes(R"(,"extensionsUsed":["EXT_meshopt_compression"])"))),
        HasSubstr("EXT_meshopt_compression"));
    const auto good = write("car.glb", car().bytes());
    for (const float length : {0.0f, -3.0f, 1e9f, std::numeric_limits<float>::quiet_NaN()})
        EXPECT_THAT(complaint(good, length), HasSubstr("between 0.1 and 200"));
}

TEST_F(LoadVehicle, RefusesPositionsThatAreNoNumbersAndIndicesThatPointNowhere) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    GlbWriter bad;
    bad.addMaterial("{\"name\":\"paint\"}");
    bad.addMesh({{0, 0, 0}, {1, nan, 0}, {0, 0, 4}}, {0, 1, 2}, GlbWriter::Indices::shorts, "m", 0);
    bad.addNode("{\"mesh\":0}");
    EXPECT_THAT(complaint(write("nan.glb", bad.bytes())), HasSubstr("not a finite number"));
    GlbWriter far;
    far.addMaterial("{\"name\":\"paint\"}");
    far.addMesh({{0, 0, 0}, {1, 1, 0}, {0, 0, 4}}, {0, 1, 7}, GlbWriter::Indices::shorts, "m", 0);
    far.addNode("{\"mesh\":0}");
    EXPECT_THAT(complaint(write("far.glb", far.bytes())), HasSubstr("past the last vertex"));
    GlbWriter flat;
    flat.addMaterial("{\"name\":\"paint\"}");
    flat.addMesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 4}}, {0, 1, 2}, GlbWriter::Indices::shorts, "m", 0);
    flat.addNode("{\"mesh\":0}");
    EXPECT_THAT(complaint(write("flat.glb", flat.bytes())), HasSubstr("no vehicle"));
}

TEST_F(LoadVehicle, RefusesNodesInACircle) {
    GlbWriter glb = car();
    glb.addNode("{\"name\":\"loop\",\"children\":[10]}");
    glb.addNode("{\"name\":\"pool\",\"children\":[9]}");
    EXPECT_THAT(complaint(write("circle.glb", glb.bytes())), HasSubstr("cycle"));
}

TEST_F(LoadVehicle, NamesTheBufferThatIsMissing) {
    const auto bytes = car().bytes("", R"(,{"byteLength":9,"uri":"x.bin"})");
    EXPECT_THAT(complaint(write("external.glb", bytes)), HasSubstr("x.bin"));
}

TEST_F(LoadVehicle, SurvivesEveryTruncationAndManyDamages) {
    const auto whole = car().bytes();
    for (std::size_t n = 0; n < whole.size(); n += 64) {
        std::vector<char> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_NE(complaint(write("cut.glb", cut)), "") << n;
        if (n < 12) continue;
        // Lie about the length, so that the cut is met further inside.
        const auto length = static_cast<std::uint32_t>(n);
        std::memcpy(cut.data() + 8, &length, 4);
        EXPECT_NE(complaint(write("lie.glb", cut)), "") << n;
    }
    std::uint64_t state = 88172645463325252ull;
    const auto next = [&] {  // xorshift64, Marsaglia 2003
        state ^= state << 13;
        state ^= state >> 7;
        return state ^= state << 17;
    };
    for (int round = 0; round < 300; ++round) {
        auto damaged = whole;
        for (int k = 0; k < 3; ++k) damaged[20 + next() % (damaged.size() - 20)] = static_cast<char>(next());
        complaint(write("damaged.glb", damaged));  // either way, but without a crash
    }
}

TEST_F(LoadVehicle, ReadsAKitColouredFromOnePalette) {
    const char* shared = std::getenv("MIRRORSTREET_SHARED_DATA");
    const std::filesystem::path data =
        shared ? std::filesystem::path(shared)
               : std::filesystem::path(MIRRORSTREET_SOURCE_DIR) / "../shared/data";
    const auto kit = data / "gltf/kenney_car-kit";
    if (!std::filesystem::exists(kit / "sedan.glb")) GTEST_SKIP() << "no car kit at " << kit;
    for (const char* name : {"sedan", "suv", "van", "taxi", "police"}) {
        SCOPED_TRACE(name);
        const VehicleModel m = loadVehicle(kit / (std::string(name) + ".glb"), 4.5f);
        EXPECT_EQ(m.wheels.size(), 4u);
        std::set<Surface> body, wheel;
        for (const auto& v : m.levels[0].body.vertices) body.insert(static_cast<Surface>(v.material));
        for (const auto& v : m.wheel.vertices) wheel.insert(static_cast<Surface>(v.material));
        for (const Surface s : {Surface::paint, Surface::glass, Surface::trim, Surface::headLamp})
            EXPECT_TRUE(body.contains(s)) << static_cast<int>(s);
        EXPECT_TRUE(wheel.contains(Surface::tyre));
        EXPECT_TRUE(wheel.contains(Surface::rim));
        EXPECT_NEAR(m.levels[0].body.bounds().size().x, 4.5f, 0.01f);
    }
}

}  // namespace
}  // namespace vehicles
