#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// When a quad of the mesh is divided.
enum class RefineCriterion : std::uint8_t {
    /// The paper's (section 4.4): |Zi - Zj| / min(Zi, Zj) > threshold for some pair of corners.
    depthRatio,
    /// Ours: the reciprocal of the ray parameter is not linear over the quad. Over a plane it is exactly
    /// linear (the ray
    /// directions of a cube face are linear in the face coordinates and n.(P + t d) = c gives 1/t = n.d / (c
    /// - n.P)), so a facade or a
    /// street seen at a grazing angle costs four corners and a centre, however its depth varies.
    planarity,
};

struct MeshOptions {
    int baseCells = 16;  ///< quads along a face's edge before refinement; the paper: 10
    int depth = 3;       ///< levels of refinement at most
    RefineCriterion criterion = RefineCriterion::planarity;
    /// depthRatio: the paper's R. planarity: greatest deviation from linear, relative to the greatest 1/t at
    /// the corners.
    float threshold = 0.05f;
};

/// Adaptive mesh over one face of a local map: where the rays from the centre meet the heightfield. Reusable:
/// keeps its buffers from face to face.
class LocalMapMesh {
  public:
    /// A leaf of the refinement. Coordinates in lattice units, 0 .. latticeSize over the face.
    struct Quad {
        std::uint16_t x, y, size;
        bool smooth;  ///< interpolate the corners; otherwise `centre` stands for the whole (smallest) quad
        float corner[4];  ///< 1/t at (x, y), (x+size, y), (x, y+size), (x+size, y+size); 0: sky
        float centre;     ///< 1/t at the middle
    };

    /// Cost: one ray a new lattice point. Degenerate options (baseCells < 1 or a lattice of more than 4096,
    /// depth outside 0..8) are clamped.
    void build(const GridTracer& tracer, const glm::vec3& centre, int face, const MeshOptions& options);

    std::span<const Quad> quads() const { return quads_; }
    int latticeSize() const { return lattice_; }
    int greatestQuad() const { return greatest_; }  ///< side of an undivided quad, in lattice units
    std::uint32_t raysTraced() const { return rays_; }

  private:
    struct Cell {
        std::uint16_t x, y;
    };
    void request(std::uint32_t node, float u, float v);
    void traceRequested(const GridTracer& tracer, const glm::vec3& centre, int face);

    int lattice_ = 0, greatest_ = 0;
    std::uint32_t rays_ = 0;
    /// 1/t by lattice point, (lattice+1)^2, then by centre of the smallest cells, lattice^2.
    std::vector<float> nodes_;
    std::vector<std::uint32_t> known_;  ///< those that have a value, to be cleared for the next face
    std::vector<Quad> quads_;
    std::vector<Cell> active_, next_;
    std::vector<std::uint32_t> wanted_;
    std::vector<float> dx_, dy_, dz_, t_;
    std::vector<glm::vec2> wantedAt_;
};

}  // namespace reflection
