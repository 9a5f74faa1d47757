#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace fuzz {

/// Reads OpenStreetMap data and what its tags say of streets, buildings and ground. One input in 128, as a
/// city takes a hundred times as long to build as its file to read, becomes a file and then a city with its
/// meshes and roads, as in the program. `format` as for city::readOsm, `name` of the file.
void readOsm(std::span<const std::uint8_t> bytes, const std::string& format, const std::string& name);

}  // namespace fuzz
