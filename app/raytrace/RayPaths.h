#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/raytrace/RayShading.h"

namespace app {

/// A ray whose light counts towards one sum.
struct PathRay {
    glm::vec3 origin{0};
    glm::vec3 direction{1, 0, 0};  ///< unit
    float width = 0, spread = 0;   ///< as in TracedRay
    glm::vec3 weight{1};
    std::uint32_t sum = 0;  ///< index into the sums
};

/// Direction in which light comes from that a surface mirrors towards the eye, as vehicle.frag has it.
inline glm::vec3 mirrorDirection(const glm::vec3& normal, const glm::vec3& towardsEye) {
    return glm::normalize(2 * glm::dot(normal, towardsEye) * normal - towardsEye);
}

/// Where a mirror ray starts: off the surface, on the side to which it goes.
glm::vec3 mirrorStart(const glm::vec3& position, const glm::vec3& facing, const glm::vec3& direction);

/// Follows rays from mirror to mirror, all of a batch together. Keep one for each thread: its memory is used
/// again.
class RayPaths {
  public:
    struct Scene {
        const RayShading* shading = nullptr;
        const RayScene* scene = nullptr;
        const FrameScene* frame = nullptr;
        bool glass = false;  ///< the city's panes are mirrors too; otherwise they are as they are painted
    };

    std::vector<PathRay> rays;  ///< to be filled; empty afterwards

    /// Adds the rays' light to the sums. Vehicles are mirrors `mirrors` times in a row, then plain paint.
    /// `distances`: if not empty, gets each ray's first distance, +infinity for sky; as long as `rays`.
    /// Returns the number of rays traced.
    std::uint64_t follow(const Scene& scene, int mirrors, std::span<glm::vec3> sums,
                         std::span<float> distances = {});

  private:
    void shade(const Scene& scene, const PathRay& ray, const reflection::TracedHit& hit, bool mirrorAgain,
               std::span<glm::vec3> sums);

    std::vector<reflection::TracedRay> traced_;
    std::vector<reflection::TracedHit> hits_;
    std::vector<PathRay> next_;
};

}  // namespace app
