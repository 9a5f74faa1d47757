#include "city/generate/ChunkCollector.h"

#include <cmath>

namespace city {

Mesh& ChunkCollector::at(ChunkKind kind, float x, float y) {
    return cells_[{static_cast<std::uint8_t>(kind), static_cast<int>(std::floor(x / cell_)),
                   static_cast<int>(std::floor(y / cell_))}];
}

void ChunkCollector::add(ChunkKind kind, const Mesh& mesh) {
    if (mesh.empty()) return;
    const glm::vec3 centre = mesh.bounds().centre();
    at(kind, centre.x, centre.y).append(mesh);
}

void ChunkCollector::addWhole(ChunkKind kind, Mesh mesh) {
    if (mesh.empty()) return;
    const Aabb bounds = mesh.bounds();
    whole_.push_back({kind, std::move(mesh), bounds});
}

std::vector<Chunk> ChunkCollector::take() {
    std::vector<Chunk> chunks = std::move(whole_);
    for (auto& [key, mesh] : cells_) {
        if (mesh.empty()) continue;
        const Aabb bounds = mesh.bounds();
        chunks.push_back({static_cast<ChunkKind>(std::get<0>(key)), std::move(mesh), bounds});
    }
    cells_.clear();
    whole_.clear();
    return chunks;
}

}  // namespace city
