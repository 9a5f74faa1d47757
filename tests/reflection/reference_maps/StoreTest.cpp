#include "reflection/reference_maps/Store.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfEnvmap.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "reflection/reference_maps/CubeMapping.h"
#include "reflection/reference_maps/PackedFile.h"
#include "tests/reflection/tracing/SeededRandom.h"

namespace reflection {
namespace {

constexpr std::uint64_t hash = 0x0123456789abcdefULL;

ReferenceMap randomMap(int n, std::uint64_t seed) {
    SeededRandom random(seed);
    ReferenceMap map;
    map.faceSize = n;
    map.position = {random.between(-5000, 5000), random.between(-5000, 5000), random.between(0, 50)};
    map.colour.resize(map.texelCount());
    map.distance.resize(map.texelCount());
    for (std::size_t i = 0; i < map.texelCount(); ++i) {
        // Multiples of 1/16 up to 64: exact as halves.
        map.colour[i] = glm::vec3(random.below(1024), random.below(1024), random.below(1024)) / 16.0f;
        map.distance[i] = random.below(4) == 0 ? std::numeric_limits<float>::infinity()
                                               : static_cast<float>(random.between(0, 3000));
    }
    return map;
}

bool same(const ReferenceMap& a, const ReferenceMap& b) {
    return a.faceSize == b.faceSize && a.position == b.position && a.colour == b.colour &&
           a.distance == b.distance;
}

std::string bytesOf(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

class StoreTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("mirrorstreet-store-" + std::to_string(getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::remove_all(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

TEST_F(StoreTest, mapComesBackBitForBit) {
    const ReferenceMapStore store(folder_, hash);
    for (const int n : {4, 6, 16, 50, 128}) {
        const ReferenceMap map = randomMap(n, static_cast<std::uint64_t>(n));
        store.save(7, map);
        const auto loaded = store.load(7);
        ASSERT_TRUE(loaded.map) << loaded.damage;
        EXPECT_TRUE(loaded.damage.empty());
        EXPECT_TRUE(same(*loaded.map, map)) << n;
    }
}

TEST_F(StoreTest, coloursAreRoundedAsHalves) {
    SeededRandom random(11);
    ReferenceMap map = randomMap(8, 12);
    for (glm::vec3& c : map.colour)
        c = glm::vec3(random.between(0, 3), std::exp(random.between(-8, 10)), 1e6);
    const ReferenceMapStore store(folder_, hash);
    store.save(0, map);
    const auto loaded = store.load(0);
    ASSERT_TRUE(loaded.map) << loaded.damage;
    for (std::size_t i = 0; i < map.texelCount(); ++i) {
        // 10 mantissa bits; below 2^-14 halves are absolute to 2^-25.
        ASSERT_NEAR(loaded.map->colour[i].r, map.colour[i].r, map.colour[i].r / 2048 + 0x1p-25f);
        ASSERT_NEAR(loaded.map->colour[i].g, map.colour[i].g, map.colour[i].g / 2048 + 0x1p-25f);
        ASSERT_EQ(loaded.map->colour[i].b, 65504.0f);
    }
}

TEST_F(StoreTest, sameMapGivesTheSameBytes) {
    const ReferenceMapStore store(folder_, hash);
    const ReferenceMap map = randomMap(16, 3);
    store.save(1, map);
    store.save(2, map);
    EXPECT_EQ(bytesOf(store.file(1)), bytesOf(store.file(2)));
    EXPECT_FALSE(bytesOf(store.file(1)).empty());
    EXPECT_FALSE(std::filesystem::exists(store.file(1).string() + ".partial"));
}

TEST_F(StoreTest, openExrSeesACubeWithFacesItsOwnWay) {
    const ReferenceMapStore store(folder_, hash);
    ReferenceMap map = randomMap(8, 4);
    store.save(0, map);
    Imf::InputFile in(store.file(0).c_str(), 1);
    ASSERT_TRUE(Imf::hasEnvmap(in.header()));
    EXPECT_EQ(Imf::envmap(in.header()), Imf::ENVMAP_CUBE);
    const Imath::Box2i window = in.header().dataWindow();
    EXPECT_EQ(window.max.x - window.min.x + 1, 8);
    EXPECT_EQ(window.max.y - window.min.y + 1, 48);
    EXPECT_EQ(in.header().channels().findChannel("Z")->type, Imf::FLOAT);
    EXPECT_EQ(in.header().channels().findChannel("R")->type, Imf::HALF);

    // Each pixel lies in the direction that OpenEXR gives it (edge pixels belong to two faces).
    std::vector<float> z(map.texelCount());
    Imf::FrameBuffer pixels;
    pixels.insert(
        "Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(z.data()), sizeof(float), 8 * sizeof(float)));
    in.setFrameBuffer(pixels);
    in.readPixels(window.min.y, window.max.y);
    for (int face = 0; face < 6; ++face)
        for (int y = 1; y < 7; ++y)
            for (int x = 1; x < 7; ++x) {
                const auto exrFace = static_cast<Imf::CubeMapFace>(face);
                const Imath::V2f within(static_cast<float>(x), static_cast<float>(y));
                const Imath::V3f d = Imf::CubeMap::direction(exrFace, window, within);
                const Imath::V2f at = Imf::CubeMap::pixelPosition(exrFace, window, within);
                const CubePoint p = cubePoint({d.x, d.y, d.z});
                const auto texel = [](float st) {
                    return static_cast<std::size_t>(std::lround((st + 1) * 3.5f));
                };
                EXPECT_EQ(
                    z[static_cast<std::size_t>(std::lround(at.y) * 8 + std::lround(at.x))],
                    map.distance[static_cast<std::size_t>(p.face) * 64 + texel(p.st.y) * 8 + texel(p.st.x)])
                    << face << ' ' << x << ' ' << y;
            }
}

TEST_F(StoreTest, absentFileIsNotDamage) {
    const ReferenceMapStore store(folder_, hash);
    const auto loaded = store.load(3);
    EXPECT_FALSE(loaded.map);
    EXPECT_TRUE(loaded.damage.empty());
}

TEST_F(StoreTest, leftoversOfAKilledBakeAreIgnored) {
    const ReferenceMapStore store(folder_, hash);
    std::filesystem::create_directories(folder_);
    writeBytes(store.file(0).string() + ".partial", "half a file");
    EXPECT_FALSE(store.load(0).map);
    EXPECT_TRUE(store.load(0).damage.empty());
    const ReferenceMap map = randomMap(4, 5);
    store.save(0, map);
    ASSERT_TRUE(store.load(0).map);
    EXPECT_TRUE(same(*store.load(0).map, map));
}

TEST_F(StoreTest, anotherCitysMapIsNotTaken) {
    ReferenceMapStore(folder_, hash).save(0, randomMap(4, 6));
    const auto loaded = ReferenceMapStore(folder_, hash + 1).load(0);
    EXPECT_FALSE(loaded.map);
    EXPECT_FALSE(loaded.damage.empty());
}

TEST_F(StoreTest, sizesThatAreNoCubeAreRefused) {
    const ReferenceMapStore store(folder_, hash);
    for (const int n : {2, 3, 5, 7}) {
        store.save(0, randomMap(n, 7));
        const auto loaded = store.load(0);
        EXPECT_FALSE(loaded.map) << n;
        EXPECT_FALSE(loaded.damage.empty()) << n;
    }
}

TEST_F(StoreTest, truncatedFileIsReportedWhereverItEnds) {
    const ReferenceMapStore store(folder_, hash);
    store.save(0, randomMap(8, 8));
    const std::string whole = bytesOf(store.file(0));
    for (std::size_t length = 0; length < whole.size(); length += length < 600 ? 7 : 97) {
        writeBytes(store.file(0), whole.substr(0, length));
        const auto loaded = store.load(0);
        ASSERT_FALSE(loaded.map) << length;
        ASSERT_FALSE(loaded.damage.empty()) << length;
    }
}

TEST_F(StoreTest, flippedBytesNeverGiveAnotherMap) {
    const ReferenceMapStore store(folder_, hash);
    // Noise, which OpenEXR stores without compression, and an even map, which it compresses.
    ReferenceMap even = randomMap(8, 9);
    std::fill(even.colour.begin(), even.colour.end(), glm::vec3(0.5f));
    std::fill(even.distance.begin(), even.distance.end(), 12.0f);
    SeededRandom random(10);
    for (const ReferenceMap& map : {randomMap(8, 9), even}) {
        store.save(0, map);
        const std::string whole = bytesOf(store.file(0));
        int refused = 0;
        for (std::size_t at = 0; at<whole.size(); at += whole.size()> 2500 && at > 700 ? 11 : 1) {
            std::string damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.below(8)));
            writeBytes(store.file(0), damaged);
            const auto loaded = store.load(0);
            // Some header bytes (aspect ratio, line order) change nothing that a map is made of.
            if (loaded.map) {
                ASSERT_TRUE(same(*loaded.map, map)) << at << " of " << whole.size();
            } else {
                ASSERT_FALSE(loaded.damage.empty()) << at;
                ++refused;
            }
        }
        EXPECT_GT(refused, 100);
    }
}

TEST_F(StoreTest, noMemoryIsTakenForTexelsThatTheFileCannotHold) {
    const ReferenceMapStore store(folder_, hash);
    store.save(0, randomMap(4, 1));
    std::string bytes = bytesOf(store.file(0));
    const std::string name("dataWindow\0box2i\0", 17);
    const std::size_t at = bytes.find(name);
    ASSERT_NE(at, std::string::npos);
    // Behind the name the attribute's size, then the window: two corners of two numbers each.
    const std::int32_t corner[2] = {8191, 6 * 8192 - 1};
    bytes.replace(at + name.size() + 4 + 8, sizeof corner, reinterpret_cast<const char*>(corner),
                  sizeof corner);
    writeBytes(store.file(0), bytes);
    const auto loaded = store.load(0);
    EXPECT_FALSE(loaded.map);
    EXPECT_NE(loaded.damage.find("more than the file can hold"), std::string::npos) << loaded.damage;
}

TEST_F(StoreTest, rubbishIsReported) {
    const ReferenceMapStore store(folder_, hash);
    std::filesystem::create_directories(folder_);
    SeededRandom random(13);
    for (int k = 0; k < 20; ++k) {
        std::string rubbish(static_cast<std::size_t>(random.below(4000)), ' ');
        for (char& c : rubbish) c = static_cast<char>(random.below(256));
        writeBytes(store.file(0), rubbish);
        const auto loaded = store.load(0);
        EXPECT_FALSE(loaded.map);
        EXPECT_FALSE(loaded.damage.empty());
    }
    std::filesystem::remove(store.file(0));
    std::filesystem::create_directories(store.file(0));
    EXPECT_FALSE(store.load(0).map);
    EXPECT_FALSE(store.load(0).damage.empty());
}

TEST_F(StoreTest, planComesBackExactly) {
    const ReferenceMapStore store(folder_, hash);
    EXPECT_FALSE(store.loadPlan());
    SeededRandom random(14);
    ReferenceMapStore::Plan plan;
    plan.coverage = 0.98123456789;
    for (int k = 0; k < 50; ++k)
        plan.positions.emplace_back(random.between(-1e5, 1e5), random.between(-1e5, 1e5), random.unit());
    store.savePlan(plan);
    const auto loaded = store.loadPlan();
    ASSERT_TRUE(loaded);
    EXPECT_EQ(loaded->positions, plan.positions);
    EXPECT_EQ(loaded->coverage, plan.coverage);
    EXPECT_FALSE(ReferenceMapStore(folder_, hash + 1).loadPlan());

    const std::string whole = bytesOf(folder_ / "plan.txt");
    // Without its last line break the list is still whole.
    for (std::size_t length = 0; length + 1 < whole.size(); length += 13) {
        writeBytes(folder_ / "plan.txt", whole.substr(0, length));
        EXPECT_FALSE(store.loadPlan()) << length;
    }
    store.savePlan({});
    ASSERT_TRUE(store.loadPlan());
    EXPECT_TRUE(store.loadPlan()->positions.empty());
}

TEST_F(StoreTest, packedCopyComesBackByteForByteOrNotAtAll) {
    const ReferenceMapStore store(folder_, hash);
    ReferenceMap map = randomMap(32, 15);
    store.save(0, map);
    const std::filesystem::path file = store.packedFile(0);
    const auto key = packedFileKey(store.file(0), hash);
    ASSERT_TRUE(key);
    EXPECT_FALSE(packedFileKey(store.file(1), hash));
    EXPECT_FALSE(loadPacked(file, *key));
    const PackedReferenceMap packed(map, 12.5f);
    ASSERT_TRUE(savePacked(file, *key, packed));
    const auto loaded = loadPacked(file, *key);
    ASSERT_TRUE(loaded);
    EXPECT_EQ(loaded->position(), packed.position());
    EXPECT_EQ(loaded->radianceScale(), packed.radianceScale());
    ASSERT_EQ(loaded->levels().size(), packed.levels().size());
    EXPECT_EQ(loaded->bytes(), packed.bytes());
    for (std::size_t k = 0; k < packed.levels().size(); ++k) {
        const int n = packed.levels()[k].faceSize();
        ASSERT_EQ(loaded->levels()[k].faceSize(), n);
        for (int face = 0; face < 6; ++face)
            for (int y = -1; y <= n; ++y)
                for (int x = -1; x <= n; ++x) {
                    ASSERT_EQ(loaded->levels()[k].nearnessAt(face, x, y),
                              packed.levels()[k].nearnessAt(face, x, y));
                    ASSERT_EQ(loaded->levels()[k].colourAt(face, x, y),
                              packed.levels()[k].colourAt(face, x, y));
                }
    }
    for (int other = 0; other < 3; ++other) {
        PackedFileKey wrong = *key;
        (other == 0 ? wrong.contentHash : wrong.sourceSize) += other < 2 ? 1 : 0;
        wrong.sourceTime += other == 2 ? 1 : 0;
        EXPECT_FALSE(loadPacked(file, wrong)) << other;
    }
    const std::string whole = bytesOf(file);
    SeededRandom random(16);
    for (std::size_t at = 0; at < whole.size(); at += at < 120 ? 1 : 173) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.below(8)));
        writeBytes(file, damaged);
        ASSERT_FALSE(loadPacked(file, *key)) << at;
        writeBytes(file, whole.substr(0, at));
        ASSERT_FALSE(loadPacked(file, *key)) << at;
    }
    EXPECT_FALSE(savePacked(folder_ / "absent" / "x.packed", *key, packed));
}

}  // namespace
}  // namespace reflection
