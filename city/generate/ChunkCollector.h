#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "city/model/CityModel.h"

namespace city {

/// Gathers meshes into chunks of at most about `cell` metres a side, one per kind and cell, in an order that
/// does not depend on the order of arrival of kinds. A mesh goes whole into the cell of its bounds' centre.
class ChunkCollector {
  public:
    explicit ChunkCollector(float cell = 100) : cell_(cell) {}

    /// The mesh of the chunk around a world position, to append to.
    Mesh& at(ChunkKind kind, float x, float y);
    void add(ChunkKind kind, const Mesh& mesh);
    /// A chunk of its own for a mesh that is one block already. Empty meshes are left out.
    void addWhole(ChunkKind kind, Mesh mesh);
    /// Hands the chunks over, with their bounds.
    std::vector<Chunk> take();

  private:
    float cell_;
    std::map<std::tuple<std::uint8_t, int, int>, Mesh> cells_;
    std::vector<Chunk> whole_;
};

}  // namespace city
