// Threads that only have the names of llvmpipe's.
#include "app/display/RasteriserThreads.h"

#include <gtest/gtest.h>

#ifdef __linux__
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace app {
namespace {

std::vector<int> coresOf(pthread_t thread) {
    cpu_set_t set;
    CPU_ZERO(&set);
    pthread_getaffinity_np(thread, sizeof set, &set);
    std::vector<int> cores;
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &set)) cores.push_back(core);
    return cores;
}

/// Threads of these names that wait until the end.
class Threads {
  public:
    explicit Threads(const std::vector<std::string>& names) {
        for (const std::string& name : names) {
            threads_.emplace_back([this] {
                std::unique_lock lock(mutex_);
                over_.wait(lock, [this] { return done_; });
            });
            pthread_setname_np(threads_.back().native_handle(), name.c_str());
        }
    }
    ~Threads() {
        {
            const std::lock_guard lock(mutex_);
            done_ = true;
        }
        over_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }
    std::vector<int> cores(std::size_t i) { return coresOf(threads_[i].native_handle()); }

  private:
    std::mutex mutex_;
    std::condition_variable over_;
    bool done_ = false;
    std::vector<std::thread> threads_;
};

std::vector<std::string> rasterisers(std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.push_back("llvmpipe-" + std::to_string(i));
    return names;
}

TEST(RasteriserThreadsTest, eachHasAnAllowedCoreOfItsOwnAndOthersAreLeftAlone) {
    const std::vector<int> allowed = coresOf(pthread_self());
    if (allowed.size() < 2) GTEST_SKIP() << "one core: there is nothing to spread";
    const std::size_t count = std::min<std::size_t>(allowed.size(), 8);
    std::vector<std::string> names = rasterisers(count);
    names.push_back("another");
    names.push_back("notllvmpipe-0");
    Threads threads(names);
    EXPECT_EQ(spreadRasteriserThreads(), count);
    std::set<int> taken;
    for (std::size_t i = 0; i < count; ++i) {
        const std::vector<int> cores = threads.cores(i);
        ASSERT_EQ(cores.size(), 1u) << i;
        EXPECT_TRUE(std::ranges::count(allowed, cores.front())) << i;
        EXPECT_TRUE(taken.insert(cores.front()).second) << "two on core " << cores.front();
    }
    EXPECT_EQ(threads.cores(count), allowed);
    EXPECT_EQ(threads.cores(count + 1), allowed);
    EXPECT_EQ(coresOf(pthread_self()), allowed);
}

TEST(RasteriserThreadsTest, moreThreadsThanCoresAreLeftWhereTheyAre) {
    const std::vector<int> allowed = coresOf(pthread_self());
    if (allowed.size() > 64) GTEST_SKIP() << "too many cores to have more threads";
    Threads threads(rasterisers(allowed.size() + 1));
    EXPECT_EQ(spreadRasteriserThreads(), 0u);
    for (std::size_t i = 0; i <= allowed.size(); ++i) EXPECT_EQ(threads.cores(i), allowed) << i;
}

TEST(RasteriserThreadsTest, coresThatAreForbiddenAreNotUsed) {
    const std::vector<int> allowed = coresOf(pthread_self());
    if (allowed.size() < 2) GTEST_SKIP() << "one core: none can be forbidden";
    cpu_set_t before, last;
    pthread_getaffinity_np(pthread_self(), sizeof before, &before);
    CPU_ZERO(&last);
    CPU_SET(allowed.back(), &last);
    // Threads that are made now may use one core, and so may this one.
    ASSERT_EQ(pthread_setaffinity_np(pthread_self(), sizeof last, &last), 0);
    {
        Threads threads(rasterisers(1));
        EXPECT_EQ(spreadRasteriserThreads(), 1u);
        EXPECT_EQ(threads.cores(0), std::vector<int>{allowed.back()});
    }
    pthread_setaffinity_np(pthread_self(), sizeof before, &before);
}

TEST(RasteriserThreadsTest, withoutRasterisersThereIsNothingToDo) {
    EXPECT_EQ(spreadRasteriserThreads(), 0u);
}

}  // namespace
}  // namespace app
#endif
