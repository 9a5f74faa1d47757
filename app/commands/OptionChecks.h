#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace app {

/// A finite number within a range: CLI11's own Range lets NaN pass. `unit`: for the message, or empty.
CLI::Validator between(double low, double high, const std::string& unit);
CLI::Validator wholeBetween(std::uint64_t low, std::uint64_t high);
/// A name of a file or folder: not empty, and not the next option, which was meant as one.
CLI::Validator isPath();
/// A file that will be written over: its name must say that it is one of ours, never a city to be read.
CLI::Validator isGlb(const std::string& remedy);

}  // namespace app
