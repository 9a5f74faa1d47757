#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace reflection::gl {

/// The folder `data` at run time: the environment variable MIRRORSTREET_DATA if set; else `data` or
/// `../share/mirrorstreet` beside the executable or up to three folders above it; else the source tree that
/// was compiled. Throws std::runtime_error naming the places tried when none holds a folder `shaders`.
std::filesystem::path dataFolder();

/// The text of data/shaders/`name` with `#include "other"` lines replaced by that file (each file at most
/// once), and `defines` (each "NAME" or "NAME VALUE") placed behind its #version line. #line directives keep
/// the compiler's messages pointing at the right line; file k of `files` is source string k in them. Throws
/// std::runtime_error naming the file that cannot be read and who asked for it.
struct ShaderSource {
    std::string text;
    std::vector<std::string> files;
};
ShaderSource loadShader(std::string_view name, std::span<const std::string> defines = {});

}  // namespace reflection::gl
