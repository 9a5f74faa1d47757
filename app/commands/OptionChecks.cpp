#include "app/commands/OptionChecks.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace app {

CLI::Validator between(double low, double high, const std::string& unit) {
    const auto number = [](double x) {
        std::ostringstream text;
        text << x;
        return text.str();
    };
    const std::string range = number(low) + " to " + number(high) + (unit.empty() ? "" : " " + unit);
    return CLI::Validator(
        [low, high, range](const std::string& text) -> std::string {
            double value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
                return "'" + text + "' is not a finite number";
            if (value < low || value > high) return text + " is outside " + range;
            return {};
        },
        "");
}

CLI::Validator wholeBetween(std::uint64_t low, std::uint64_t high) {
    const std::string range = std::to_string(low) + " to " + std::to_string(high);
    return CLI::Validator(
        [low, high, range](const std::string& text) -> std::string {
            std::uint64_t value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc() || end != text.data() + text.size() || value < low || value > high)
                return "'" + text + "' is not a whole number from " + range;
            return {};
        },
        "");
}

CLI::Validator isPath() {
    return CLI::Validator(
        [](const std::string& text) -> std::string {
            if (text.empty()) return "the name is empty";
            if (text.front() == '-')
                return "'" + text + "' looks like an option; write './" + text + "' if it is a name";
            return {};
        },
        "");
}

CLI::Validator isGlb(const std::string& remedy) {
    return CLI::Validator(
        [remedy](const std::string& text) -> std::string {
            std::string extension = std::filesystem::path(text).extension().string();
            for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
            if (extension == ".glb") return {};
            return "names the file to write, which ends in .glb, not '" + text + "'; " + remedy;
        },
        "");
}

}  // namespace app
