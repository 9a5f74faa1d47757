#include "app/display/RasteriserThreads.h"

#ifdef __linux__
#include <sched.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>
#endif

namespace app {

#ifdef __linux__

std::size_t spreadRasteriserThreads() {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 0;
    std::vector<int> cores;
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &allowed)) cores.push_back(core);

    std::vector<pid_t> threads;
    std::error_code failed;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", failed)) {
        std::string name;
        std::getline(std::ifstream(task.path() / "comm"), name);
        const std::string number = task.path().filename().string();
        pid_t thread = 0;
        if (name.starts_with("llvmpipe-") &&
            std::from_chars(number.data(), number.data() + number.size(), thread).ec == std::errc())
            threads.push_back(thread);
    }
    if (failed || threads.size() > cores.size()) return 0;
    std::size_t spread = 0;
    for (std::size_t i = 0; i < threads.size(); ++i) {
        cpu_set_t own;
        CPU_ZERO(&own);
        CPU_SET(cores[i], &own);
        if (sched_setaffinity(threads[i], sizeof own, &own) == 0) ++spread;
    }
    return spread;
}

#else

std::size_t spreadRasteriserThreads() {
    return 0;
}

#endif

}  // namespace app
