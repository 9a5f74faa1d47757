#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace app {

/// A progress bar on stderr: drawn only on a terminal and only once a second has passed; silent in quiet
/// mode. The destructor ends the line.
class Progress {
  public:
    Progress(std::string label, std::uint64_t total, bool quiet = false);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(std::uint64_t steps = 1);

  private:
    void draw(bool last);

    std::string label_;
    std::uint64_t total_;
    std::uint64_t done_ = 0;
    bool enabled_;
    bool drawn_ = false;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point lastDraw_;
};

/// True once SIGINT or SIGTERM came; commands look at it between units of work and finish what they have. A
/// second signal ends the program at once.
bool interrupted();
/// Installs the handlers behind `interrupted`. Call once, early in main.
void watchForInterrupt();

}  // namespace app
