#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace app {

/// How vehicles get their reflections; the names are the same on the command line, in panels and in result
/// files.
enum class ReflectionMethod : std::uint8_t {
    none,      ///< plain paint
    fixed,     ///< "static": one map for all
    blend,     ///< direction lookup blended between reference maps
    box,       ///< parallax-corrected by a street-aligned box
    mem,       ///< reference maps + heightfield tracing
    rerender,  ///< six faces per car
    raytrace,  ///< an exact mirror ray for each pixel of a car, by Embree
};
inline constexpr std::array<std::string_view, 7> reflectionMethodNames{"none", "static",   "blend",   "box",
                                                                       "mem",  "rerender", "raytrace"};

/// Whether a method reads reference maps.
inline constexpr bool readsReferenceMaps(ReflectionMethod method) {
    return method == ReflectionMethod::fixed || method == ReflectionMethod::blend ||
           method == ReflectionMethod::box || method == ReflectionMethod::mem;
}

/// Which form of `mem`.
enum class MemVariant : std::uint8_t {
    paper,  ///< as Meyer & Loscos 2003 describe it
    ours,
};
inline constexpr std::array<std::string_view, 2> memVariantNames{"paper", "ours"};

/// Where the method `mem` (ours) keeps reference maps and makes local maps.
enum class MapsOn : std::uint8_t {
    automatic,  ///< "auto": the graphics card; the processor where that draws as well
    cpu,
    gpu,
};
inline constexpr std::array<std::string_view, 3> mapsOnNames{"auto", "cpu", "gpu"};

/// Detail and update budget of the reflections, and antialiasing and shadows of the drawing.
enum class Quality : std::uint8_t { low, medium, high };
inline constexpr std::array<std::string_view, 3> qualityNames{"low", "medium", "high"};

template <typename Enum, std::size_t count>
std::optional<Enum> fromName(const std::array<std::string_view, count>& names, std::string_view name) {
    for (std::size_t i = 0; i < count; ++i)
        if (names[i] == name) return static_cast<Enum>(i);
    return std::nullopt;
}
inline std::string_view nameOf(ReflectionMethod method) {
    return reflectionMethodNames[static_cast<std::size_t>(method)];
}
inline std::string_view nameOf(MemVariant variant) {
    return memVariantNames[static_cast<std::size_t>(variant)];
}
inline std::string_view nameOf(Quality quality) {
    return qualityNames[static_cast<std::size_t>(quality)];
}

}  // namespace app
