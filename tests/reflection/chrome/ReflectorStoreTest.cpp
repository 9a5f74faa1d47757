// What is kept of reflectors on disk, and for how long.
#include "reflection/chrome/ReflectorStore.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

namespace reflection {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;

class ReflectorStoreTest : public testing::Test {
  protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / "reflector-store-test";
        fs::remove_all(folder);
        ReflectorStore(folder).save(0, some);
        size = fs::file_size(ReflectorStore(folder).fileOf(0));
    }
    void TearDown() override { fs::remove_all(folder); }
    void usedBefore(const fs::path& file, hours ago) {
        fs::last_write_time(file, fs::file_time_type::clock::now() - ago);
    }
    bool kept(std::uint64_t hash) const { return fs::exists(ReflectorStore(folder).fileOf(hash)); }

    fs::path folder;
    Reflector some = {{}, 3};
    std::uintmax_t size = 0;
};

TEST_F(ReflectorStoreTest, WhatWasLeastRecentlyUsedMakesRoom) {
    const ReflectorStore store(folder, 3 * size);
    for (const std::uint64_t hash : {1, 2}) store.save(hash, some);
    for (const int hash : {0, 1, 2})
        usedBefore(store.fileOf(static_cast<std::uint64_t>(hash)), hours(9 - hash));
    EXPECT_EQ(store.load(0).reflector.value().skipped, 3u);  // used now
    store.save(3, some);
    EXPECT_TRUE(kept(0) && !kept(1) && kept(2) && kept(3));
    // Of another size, by another program: whatever fits stays.
    ReflectorStore(folder, size).save(4, some);
    EXPECT_TRUE(!kept(0) && !kept(2) && !kept(3) && kept(4));
}

TEST_F(ReflectorStoreTest, WhatWasJustSavedStaysHoweverLarge) {
    const ReflectorStore store(folder, 1);
    store.save(1, some);
    EXPECT_TRUE(kept(1) && !kept(0));
    EXPECT_TRUE(store.load(1).reflector.has_value());
    EXPECT_FALSE(store.load(0).reflector.has_value());
    EXPECT_TRUE(store.load(0).refused.empty());
}

TEST_F(ReflectorStoreTest, OnlyWhatIsItsOwnIsRemoved) {
    const fs::path aside = folder / "7.reflector.1.partial", old = folder / "8.reflector.2.partial",
                   other = folder / "notes.txt";
    for (const fs::path& file : {aside, old, other}) std::ofstream(file) << "a few bytes";
    usedBefore(old, hours(48));
    usedBefore(other, hours(48));
    ReflectorStore(folder, 1).save(1, some);
    EXPECT_TRUE(fs::exists(aside) && fs::exists(other));
    EXPECT_FALSE(fs::exists(old));
}

}  // namespace
}  // namespace reflection
