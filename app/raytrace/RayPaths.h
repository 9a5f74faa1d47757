#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/raytrace/GroundShadows.h"
#include "app/raytrace/RayShading.h"

namespace app {

/// The rays of the pixels beside a ray's, as long as all its mirrors were flat: they meet in one point, the
/// eye's image, and tell how large a pixel is on what is met, as the rasteriser's derivatives do.
struct PixelRays {
    bool known = false;
    glm::vec3 apex{0};
    std::array<glm::vec3, 3> through{};  ///< the block's own pixel, the one right of it, the one above

    void reflect(const glm::vec3& at, const glm::vec3& normal);
};

/// A ray whose light counts towards one sum.
struct PathRay {
    glm::vec3 origin{0};
    glm::vec3 direction{1, 0, 0};  ///< unit
    float width = 0, spread = 0;   ///< as in TracedRay
    glm::vec3 weight{1};
    std::uint32_t sum = 0;  ///< index into the sums
    PixelRays pixel = {};
    float fading = 0;  ///< of its light, 1 / metre of way: from flat mirrors that fade on
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
        const GroundShadows* shadows = nullptr;          ///< those of vehicles; null: none
        TextureFilter filter = TextureFilter::standard;  ///< for rays that know their pixel
        bool wet = false;                                ///< it has rained: ground mirrors
        float fading = 0;                                ///< 1 / metre: of the way behind each flat mirror
        int film = 1;  ///< rays for what a film of water spreads, where all its light comes from there
        std::uint64_t seed = 1;
    };

    std::vector<PathRay> rays;  ///< to be filled; empty afterwards

    /// Adds the rays' light to the sums. Vehicles are mirrors `mirrors` times in a row, then plain paint.
    /// `distances`: if not empty, gets each ray's first distance, +infinity for sky; as long as `rays`.
    /// Returns the number of rays traced.
    std::uint64_t follow(const Scene& scene, int mirrors, std::span<glm::vec3> sums,
                         std::span<float> distances = {});

    /// Adds rays to follow for the light that a point of wet ground mirrors, and shares of it as weights.
    /// `at` on the ground; `ray`: the one that met it, `footprint` wide there.
    static void addWetRays(const Scene& scene, const WetGround& ground, const glm::vec3& at,
                           const PathRay& ray, float footprint, float distance, bool seenDirectly,
                           std::vector<PathRay>& to);

    /// The same for a pane or stone that mirrors roughly; `ray`: with the mirrored share in its weight.
    static void addRoughRays(const Scene& scene, const GlassPoint& point, const PathRay& ray, float footprint,
                             bool seenDirectly, std::vector<PathRay>& to);

  private:
    void shade(const Scene& scene, const PathRay& from, const reflection::TracedHit& hit, bool mirrorAgain,
               std::span<glm::vec3> sums);

    std::vector<reflection::TracedRay> traced_;
    std::vector<reflection::TracedHit> hits_;
    std::vector<PathRay> next_;
};

}  // namespace app
