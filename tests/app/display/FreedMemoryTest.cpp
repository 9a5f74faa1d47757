#include "app/display/FreedMemory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <cstring>
#include <vector>

namespace app {
namespace {

/// Page faults of taking, writing and freeing 32 MiB in blocks as llvmpipe takes them.
long faultsOfARound() {
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    constexpr std::size_t size = 64 << 10;
    std::vector<void*> blocks(512);
    for (void*& b : blocks) {
        b = std::malloc(size);
        if (b != nullptr) std::memset(b, 1, size);
    }
    while (!blocks.empty()) {
        std::free(blocks.back());
        blocks.pop_back();
    }
    getrusage(RUSAGE_SELF, &after);
    return after.ru_minflt - before.ru_minflt;
}

TEST(FreedMemory, IsNotFetchedAnewWhereTheRasteriserIsSoftware) {
    faultsOfARound();
    EXPECT_FALSE(keepFreedMemory("NVIDIA H100"));
    if (!keepFreedMemory("llvmpipe (LLVM 15.0.6, 256 bits)"))
        GTEST_SKIP() << "this C library cannot be told to keep memory";
    EXPECT_GT(faultsOfARound(), 1000) << "the first round was to be without memory to reuse";
    // 8,192 pages; huge pages and sanitizers may need some anew.
    EXPECT_LT(faultsOfARound(), 200);
}

}  // namespace
}  // namespace app
