#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace app {

/// wet: it has rained; streets mirror, with puddles.
enum class Weather : std::uint8_t { dry, wet };
inline constexpr std::array<std::string_view, 2> weatherNames{"dry", "wet"};

}  // namespace app
