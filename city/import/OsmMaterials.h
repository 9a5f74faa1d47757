#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "city/model/Material.h"

namespace city {

/// The material table of a city under construction; equal materials share an entry.
class MaterialTable {
  public:
    explicit MaterialTable(std::vector<Material> initial = {}) : materials_(std::move(initial)) {}
    std::uint32_t add(const Material& material);
    std::uint32_t add(Pattern pattern, glm::vec3 tint, float patternSize = 1, float roughness = 1);
    const Material& operator[](std::uint32_t index) const { return materials_[index]; }
    std::vector<Material> take() { return std::move(materials_); }

  private:
    std::vector<Material> materials_;
};

/// A well-mixed 64-bit hash of a seed and an object's number (splitmix64): what the file leaves open is drawn
/// from it, so that a building looks the same whatever else is in the file.
std::uint64_t mixed(std::uint64_t seed, std::int64_t object);

/// Uniform in [0, 1) from the hash; `draw` numbers independent draws.
double uniform(std::uint64_t hash, std::uint32_t draw);

}  // namespace city
