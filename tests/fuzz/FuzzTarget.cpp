#include "tests/fuzz/FuzzTarget.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

namespace fuzz {

namespace {

/// A folder of this process, in memory where there is such a place, as a million files are written; gone with
/// the process.
class Scratch {
  public:
    Scratch() {
        std::error_code error;
        const std::filesystem::path memory = "/dev/shm";
        const std::filesystem::path root =
            std::filesystem::is_directory(memory, error) ? memory : std::filesystem::temp_directory_path();
        folder_ = root / ("mirrorstreet-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    ~Scratch() {
        std::error_code error;
        std::filesystem::remove_all(folder_, error);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
};

}  // namespace

void orRefuse(const std::function<void()>& read) {
    try {
        read();
    } catch (const std::runtime_error&) {
    } catch (const std::invalid_argument&) {
    }
}

void feed(std::span<const std::uint8_t> bytes, const std::string& name,
          const std::function<void(const std::filesystem::path&)>& read) {
    static const Scratch scratch;
    const std::filesystem::path file = scratch.folder() / name;
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    orRefuse([&] { read(file); });
}

bool oneIn(std::uint64_t count, std::span<const std::uint8_t> bytes) {
    std::uint64_t hash = 14695981039346656037ULL;
    for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
    return (hash >> 32) % count == 0;
}

}  // namespace fuzz
