#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

namespace city {

/// The values of OpenStreetMap tags as people write them. Nothing throws; what cannot be understood is
/// nullopt.

/// A length in metres: "12.13 m", "12,5", "40'", "5'6\"", "15 ft", "0.2 km"; of a list ("3;4") the largest.
std::optional<double> parseLength(std::string_view text);

/// A plain number, such as levels ("3", "2.5", "3;4": the largest).
std::optional<double> parseNumber(std::string_view text);

/// A speed in metres per second: "50", "30 mph", "walk"; nullopt for "none", "signals" and "RO:urban".
std::optional<double> parseSpeed(std::string_view text);

/// Linear RGB of "#rgb", "#rrggbb" or one of the CSS names that buildings have.
std::optional<glm::vec3> parseColour(std::string_view text);

}  // namespace city
