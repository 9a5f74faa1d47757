#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace app {

/// sRGB-encoded pixels, 8 bit RGB, top row first.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

/// Writes a PNG aside, then renames. Throws std::runtime_error naming the file and the cause, also for an
/// empty picture.
void writePng(const Picture& picture, const std::filesystem::path& file);

}  // namespace app
