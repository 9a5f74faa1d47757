#include "tests/fuzz/FuzzTarget.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

namespace fuzz {

namespace {

/// In memory where there is such a place: a million files are written.
std::filesystem::path scratchFolder() {
    std::error_code error;
    const std::filesystem::path memory = "/dev/shm";
    const std::filesystem::path root =
        std::filesystem::is_directory(memory, error) ? memory : std::filesystem::temp_directory_path();
    return root / ("mirrorstreet-fuzz-" + std::to_string(getpid()));
}

}  // namespace

void feed(std::span<const std::uint8_t> bytes, const std::string& ending,
          const std::function<void(const std::filesystem::path&)>& read) {
    const std::filesystem::path folder = scratchFolder();
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / ("input" + ending);
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    try {
        read(file);
    } catch (const std::runtime_error&) {
    } catch (const std::invalid_argument&) {
    }
    std::filesystem::remove_all(folder);
}

}  // namespace fuzz
