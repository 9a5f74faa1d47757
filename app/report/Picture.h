#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace app {

/// sRGB-encoded pixels, 8 bit RGBA, top row first. Alpha is ignored.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;  ///< width * height * 4
};

/// Writes a PNG aside, then renames. Throws std::runtime_error naming the file and the cause, also for an
/// empty picture.
void writePng(const Picture& picture, const std::filesystem::path& file);

}  // namespace app
