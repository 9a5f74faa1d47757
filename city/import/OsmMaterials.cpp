#include "city/import/OsmMaterials.h"

namespace city {

std::uint32_t MaterialTable::add(const Material& material) {
    const auto same = [&](const Material& m) {
        return m.pattern == material.pattern && m.tint == material.tint &&
               m.patternSize == material.patternSize && m.roughness == material.roughness &&
               m.twoSided == material.twoSided && m.cutout == material.cutout &&
               m.emission == material.emission;
    };
    for (std::size_t i = 0; i < materials_.size(); ++i)
        if (same(materials_[i])) return static_cast<std::uint32_t>(i);
    materials_.push_back(material);
    return static_cast<std::uint32_t>(materials_.size() - 1);
}

std::uint32_t MaterialTable::add(Pattern pattern, glm::vec3 tint, float patternSize, float roughness) {
    Material material;
    material.pattern = pattern;
    material.tint = tint;
    material.patternSize = patternSize;
    material.roughness = roughness;
    return add(material);
}

std::uint64_t mixed(std::uint64_t seed, std::int64_t object) {
    std::uint64_t z =
        seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(object) + 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

double uniform(std::uint64_t hash, std::uint32_t draw) {
    return static_cast<double>(mixed(hash, draw) >> 11) / 9007199254740992.0;
}

}  // namespace city
