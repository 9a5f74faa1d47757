#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "app/render/Readback.h"

namespace app::test {

/// Writes a picture for a person to look at: MIRRORSTREET_TEST_OUT/name.png, where the environment variable
/// wins over the compiled-in folder.
inline void writePng(const std::string& name, const Image8& image) {
    const char* wish = std::getenv("MIRRORSTREET_TEST_OUT");
    const std::filesystem::path folder = wish != nullptr ? wish : MIRRORSTREET_TEST_OUT;
    std::filesystem::create_directories(folder);
    std::vector<std::uint8_t> raw;
    const auto width = static_cast<std::size_t>(image.size.x);
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.size.y); ++y) {
        raw.push_back(0);
        for (std::size_t x = 0; x < width; ++x)
            raw.insert(raw.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>((y * width + x) * 4),
                       image.rgba.begin() + static_cast<std::ptrdiff_t>((y * width + x) * 4 + 3));
    }
    uLongf size = compressBound(raw.size());
    std::vector<std::uint8_t> packed(size);
    compress2(packed.data(), &size, raw.data(), raw.size(), 1);
    packed.resize(size);
    std::ofstream file(folder / (name + ".png"), std::ios::binary);
    file.write("\x89PNG\r\n\x1a\n", 8);
    const auto word = [](std::uint32_t v) {
        return std::string{static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
                           static_cast<char>(v)};
    };
    const auto chunk = [&](const std::string& kind, const std::string& data) {
        const std::string body = kind + data;
        file << word(static_cast<std::uint32_t>(data.size())) << body
             << word(static_cast<std::uint32_t>(
                    crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()))));
    };
    chunk("IHDR", word(static_cast<std::uint32_t>(image.size.x)) +
                      word(static_cast<std::uint32_t>(image.size.y)) + std::string("\x08\x02\0\0\0", 5));
    chunk("IDAT", std::string(packed.begin(), packed.end()));
    chunk("IEND", {});
}

}  // namespace app::test
