#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "city/geometry/Mesh.h"

namespace reflection {

/// Where a surface lets rays through, as leaves cut out of cards do. Asked from many threads at once.
class Holes {
  public:
    virtual ~Holes() = default;
    /// At barycentrics u, v (weights of the second and third corner) of a triangle, for a ray that is
    /// `footprint` metres wide there.
    virtual bool openAt(std::uint32_t triangle, float u, float v, float footprint) const = 0;
};

/// Meshes that scenes are made of, each with a tree over its triangles (Embree 3, robust mode). Must outlive
/// the scenes.
class TracedMeshes {
  public:
    /// Throws std::runtime_error when Embree cannot start.
    TracedMeshes();
    ~TracedMeshes();
    TracedMeshes(const TracedMeshes&) = delete;
    TracedMeshes& operator=(const TracedMeshes&) = delete;

    struct Part {
        const city::Mesh* mesh = nullptr;  ///< positions and indices are copied
        bool twoSided = false;             ///< seen from its back too
        const Holes* holes = nullptr;      ///< kept; null: none
    };
    /// Index of the mesh, which consists of these parts. Cost: n log n in its triangles, on all processors.
    std::uint32_t add(std::span<const Part> parts);

  private:
    friend class TracedScene;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

struct TracedRay {
    glm::vec3 origin{0};
    glm::vec3 direction{1, 0, 0};  ///< need not be unit: t counts its lengths
    float from = 0;                ///< t
    float to = std::numeric_limits<float>::infinity();
    /// Width in metres at the origin and its growth for each unit of t: what a hole is filtered over.
    float width = 0;
    float spread = 0;
};

struct TracedHit {
    static constexpr std::uint32_t none = 0xffffffffu;
    float t = std::numeric_limits<float>::infinity();
    std::uint32_t instance = none;  ///< as `place` counted; none: nothing was hit
    std::uint32_t part = 0;         ///< of the instance's mesh
    std::uint32_t triangle = 0;     ///< of the part
    float u = 0, v = 0;             ///< weights of the second and third corner

    bool found() const { return instance != none; }
};

/// Meshes placed any number of times, and exact rays against them. Build: clear, place..., commit; then trace
/// from any thread.
class TracedScene {
  public:
    explicit TracedScene(const TracedMeshes& meshes);
    ~TracedScene();
    TracedScene(TracedScene&&) noexcept;
    TracedScene& operator=(TracedScene&&) noexcept;

    void clear();
    /// Index of the instance. `worldFromMesh` must be affine and invertible.
    std::uint32_t place(std::uint32_t mesh, const glm::mat4& worldFromMesh);
    /// Cost: a tree over the instances; some 0.2 us each.
    void commit();

    enum class Backs : std::uint8_t {
        pass,  ///< rays pass through the backs of triangles that are not two-sided, as the rasteriser's do
        stop,  ///< as solid as their fronts: quicker, and the same where all surfaces are closed
    };
    /// The first hit of each ray, in packets; `hits` as long as `rays`.
    void trace(std::span<const TracedRay> rays, std::span<TracedHit> hits, Backs backs) const;
    /// Whether anything lies within [from, to] of each ray, whichever side it shows: 1 or 0.
    void blocked(std::span<const TracedRay> rays, std::span<std::uint8_t> result) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
