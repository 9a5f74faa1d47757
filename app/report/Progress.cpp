#include "app/report/Progress.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <utility>

namespace app {

namespace {

using namespace std::chrono_literals;

// The one piece of state that must be global: a signal handler can reach nothing else.
std::atomic<int> signalsSeen{0};
static_assert(std::atomic<int>::is_always_lock_free, "needed inside a signal handler");

extern "C" void onSignal(int number) {
    if (signalsSeen.fetch_add(1) > 0) _exit(128 + number);
}

}  // namespace

Progress::Progress(std::string label, std::uint64_t total, bool quiet)
    : label_(std::move(label)),
      total_(total),
      enabled_(!quiet && isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      lastDraw_(start_) {}

Progress::~Progress() {
    if (drawn_) draw(true);
}

void Progress::advance(std::uint64_t steps) {
    done_ += steps;
    if (!enabled_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - start_ < 1s || now - lastDraw_ < 100ms) return;
    lastDraw_ = now;
    draw(false);
}

void Progress::draw(bool last) {
    constexpr int width = 30;
    const double share =
        total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0.0;
    const int filled = static_cast<int>(share * width);
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    char bar[width + 1];
    for (int i = 0; i < width; ++i) bar[i] = i < filled ? '#' : '.';
    bar[width] = '\0';
    std::fprintf(stderr, "\r%s [%s] %llu/%llu", label_.c_str(), bar, static_cast<unsigned long long>(done_),
                 static_cast<unsigned long long>(total_));
    if (last)
        std::fprintf(stderr, " in %.1f s\033[K\n", elapsed);
    else if (share > 0)
        std::fprintf(stderr, " %.0f s left\033[K", elapsed / share * (1 - share));
    std::fflush(stderr);
    drawn_ = true;
}

bool interrupted() {
    return signalsSeen.load() > 0;
}

void watchForInterrupt() {
    struct sigaction action {};
    action.sa_handler = onSignal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // A reader of stdout or of the video pipe that goes away shows up as a failed write, with its own
    // message.
    std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace app
