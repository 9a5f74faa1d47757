// Built where MIRRORSTREET_ASSERTIONS is on (presets dev, asan, tsan, fuzz): that it does switch assertions
// on. Ours are few; those of GLM, libosmium, nlohmann-json, TBB and the standard library guard how we use
// them.
#include <gtest/gtest.h>

#include <cassert>
#include <vector>

namespace {

TEST(AssertionsDeathTest, aFalseAssertionEndsTheProgram) {
    const auto isTrue = [](bool value) {
        assert(value);
        return value;
    };
    EXPECT_TRUE(isTrue(true));
    EXPECT_DEATH(isTrue(false), "value");
}

TEST(AssertionsDeathTest, theStandardLibraryChecksItsBounds) {
    std::vector<int> three(3);
    volatile std::size_t beyond = 3;
    three.reserve(8);  // within the memory: no sanitizer's business
    EXPECT_DEATH(three[beyond] = 1, "__n < this->size");
}

}  // namespace
