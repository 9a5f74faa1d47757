#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace app {

/// sRGB-encoded pixels, 8 bit RGBA, top row first. Alpha is ignored.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;  ///< width * height * 4
};

enum class PictureFormat : std::uint8_t { png, jpeg };

/// The bytes of a PNG, or of a JPEG of high quality. Throws std::runtime_error for an empty picture.
std::vector<unsigned char> encodePicture(const Picture& picture, PictureFormat format);

/// "data:image/...;base64,...": a picture within a page.
std::string dataUrl(const Picture& picture, PictureFormat format);

/// Base64 (RFC 4648, section 4), padded.
std::string base64(const std::vector<unsigned char>& bytes);

/// Writes a PNG aside, then renames. Throws std::runtime_error naming the file and the cause, also for an
/// empty picture.
void writePng(const Picture& picture, const std::filesystem::path& file);

}  // namespace app
