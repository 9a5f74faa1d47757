#include "city/import/OsmValues.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace city {

namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The number at the text's start, with point or comma; moves the text on behind it.
std::optional<double> takeNumber(std::string_view& text) {
    text = trimmed(text);
    std::string digits(text.substr(0, text.find_first_not_of("0123456789+-.,")));
    std::replace(digits.begin(), digits.end(), ',', '.');
    const char* begin = digits.data();
    if (!digits.empty() && *begin == '+') ++begin;
    double value = 0;
    // Fixed notation only: "3e5" is no height.
    const auto [end, error] =
        std::from_chars(begin, digits.data() + digits.size(), value, std::chars_format::fixed);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
        return std::nullopt;
    text = trimmed(text.substr(digits.size()));
    return value;
}

std::optional<double> parseOneLength(std::string_view text) {
    constexpr double foot = 0.3048;
    constexpr double inch = 0.0254;
    const std::optional<double> value = takeNumber(text);
    if (!value) return std::nullopt;
    if (text.empty() || text == "m" || text == "metres" || text == "meters" || text == "metre") return value;
    if (text == "km") return *value * 1000;
    if (text == "cm") return *value / 100;
    if (text == "ft" || text == "feet") return *value * foot;
    if (text == "\"" || text == "in") return *value * inch;
    if (text.front() == '\'') {
        text.remove_prefix(1);
        if (trimmed(text).empty()) return *value * foot;
        const std::optional<double> inches = takeNumber(text);
        if (inches && text == "\"") return *value * foot + *inches * inch;
    }
    return std::nullopt;
}

template <typename Parse>
std::optional<double> largest(std::string_view text, const Parse& parse) {
    std::optional<double> best;
    while (!text.empty()) {
        const auto end = text.find(';');
        if (const std::optional<double> value = parse(text.substr(0, end)))
            best = best ? std::max(*best, *value) : *value;
        if (end == std::string_view::npos) break;
        text.remove_prefix(end + 1);
    }
    return best;
}

glm::vec3 linearFromSrgb(std::uint32_t rgb) {
    const auto channel = [](std::uint32_t value) {
        const double c = double(value & 0xff) / 255;
        return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    };
    return {channel(rgb >> 16), channel(rgb >> 8), channel(rgb)};
}

constexpr std::pair<std::string_view, std::uint32_t> colourNames[] = {
    {"beige", 0xf5f5dc},     {"black", 0x000000},      {"blue", 0x0000ff},       {"brown", 0xa52a2a},
    {"burlywood", 0xdeb887}, {"chocolate", 0xd2691e},  {"cream", 0xfffdd0},      {"darkgray", 0xa9a9a9},
    {"darkgreen", 0x006400}, {"darkgrey", 0xa9a9a9},   {"darkred", 0x8b0000},    {"firebrick", 0xb22222},
    {"gold", 0xffd700},      {"gray", 0x808080},       {"green", 0x008000},      {"grey", 0x808080},
    {"ivory", 0xfffff0},     {"khaki", 0xf0e68c},      {"lightblue", 0xadd8e6},  {"lightbrown", 0xb5651d},
    {"lightgray", 0xd3d3d3}, {"lightgreen", 0x90ee90}, {"lightgrey", 0xd3d3d3},  {"lightyellow", 0xffffe0},
    {"linen", 0xfaf0e6},     {"maroon", 0x800000},     {"ochre", 0xcc7722},      {"olive", 0x808000},
    {"orange", 0xffa500},    {"peachpuff", 0xffdab9},  {"pink", 0xffc0cb},       {"purple", 0x800080},
    {"red", 0xff0000},       {"salmon", 0xfa8072},     {"sandybrown", 0xf4a460}, {"sienna", 0xa0522d},
    {"silver", 0xc0c0c0},    {"slategray", 0x708090},  {"tan", 0xd2b48c},        {"teal", 0x008080},
    {"tomato", 0xff6347},    {"wheat", 0xf5deb3},      {"white", 0xffffff},      {"yellow", 0xffff00},
};

}  // namespace

std::optional<double> parseLength(std::string_view text) {
    return largest(text, parseOneLength);
}

std::optional<double> parseNumber(std::string_view text) {
    return largest(text, [](std::string_view one) -> std::optional<double> {
        const std::optional<double> value = takeNumber(one);
        return value && one.empty() ? value : std::nullopt;
    });
}

std::optional<double> parseSpeed(std::string_view text) {
    if (trimmed(text) == "walk") return 7 / 3.6;
    std::string_view rest = text;
    const std::optional<double> value = takeNumber(rest);
    if (!value || !(*value > 0)) return std::nullopt;
    if (rest.empty() || rest == "km/h" || rest == "kmh" || rest.front() == ';') return *value / 3.6;
    if (rest == "mph") return *value * 0.44704;
    if (rest == "knots") return *value * 0.514444;
    return std::nullopt;
}

std::optional<glm::vec3> parseColour(std::string_view text) {
    text = trimmed(text);
    if (!text.empty() && text.front() == '#') {
        const std::string_view hex = text.substr(1);
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(hex.data(), hex.data() + hex.size(), value, 16);
        if (error != std::errc() || end != hex.data() + hex.size()) return std::nullopt;
        if (hex.size() == 6) return linearFromSrgb(value);
        if (hex.size() == 3)
            return linearFromSrgb((value >> 8 & 0xf) * 0x110000 + (value >> 4 & 0xf) * 0x1100 +
                                  (value & 0xf) * 0x11);
        return std::nullopt;
    }
    std::string name;
    for (const char c : text.substr(0, text.find(';')))
        if (c != ' ' && c != '_' && c != '-')
            name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const auto& [known, value] : colourNames)
        if (name == known) return linearFromSrgb(value);
    return std::nullopt;
}

}  // namespace city
