#include "city/model/CityModel.h"

#include <bit>

namespace city {

namespace {

/// 64-bit FNV-1a over little-endian bytes, so that the hash is the same on every machine.
class Fnv1a {
  public:
    void add(std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte) {
            hash_ = (hash_ ^ ((value >> (8 * byte)) & 0xff)) * 0x100000001b3ull;
        }
    }
    void add(float value) { add(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(value))); }
    void add(const glm::vec3& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    }
    void add(const Mesh& mesh) {
        add(static_cast<std::uint64_t>(mesh.vertices.size()));
        for (const Vertex& v : mesh.vertices) {
            add(v.position);
            add(v.normal);
            add(v.texcoord.x);
            add(v.texcoord.y);
            add(static_cast<std::uint64_t>(v.material));
        }
        add(static_cast<std::uint64_t>(mesh.indices.size()));
        for (std::uint32_t i : mesh.indices) add(static_cast<std::uint64_t>(i));
    }
    std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

}  // namespace

std::size_t CityModel::triangleCount() const {
    std::size_t count = 0;
    for (const Chunk& chunk : chunks) count += chunk.mesh.triangleCount();
    for (const Placement& placement : placements) {
        const Prototype& prototype = prototypes[placement.prototype];
        if (!prototype.levels.empty()) count += prototype.levels.front().mesh.triangleCount();
    }
    return count;
}

std::uint64_t CityModel::contentHash() const {
    Fnv1a hash;
    for (const Material& m : materials) {
        hash.add(static_cast<std::uint64_t>(m.pattern));
        hash.add(m.tint);
        hash.add(m.patternSize);
        hash.add(m.roughness);
        hash.add(static_cast<std::uint64_t>(m.twoSided) * 2 + static_cast<std::uint64_t>(m.cutout));
        hash.add(m.emission);
    }
    for (const Chunk& chunk : chunks) hash.add(chunk.mesh);
    for (const Prototype& prototype : prototypes)
        for (const Prototype::Level& level : prototype.levels) hash.add(level.mesh);
    for (const Placement& placement : placements) {
        hash.add(static_cast<std::uint64_t>(placement.prototype));
        for (int column = 0; column < 4; ++column) hash.add(glm::vec3(placement.worldFromPrototype[column]));
    }
    for (const StandingReflector& reflector : reflectors) {
        hash.add(static_cast<std::uint64_t>(reflector.shape));
        hash.add(reflector.foot);
        hash.add(reflector.radius);
        hash.add(reflector.height);
    }
    return hash.value();
}

}  // namespace city
