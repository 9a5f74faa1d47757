#pragma once

#include <string_view>

namespace app {

/// Set by CMake from the project's version.
inline constexpr std::string_view programVersion = MIRRORSTREET_VERSION;

}  // namespace app
