#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "app/commands/ChromeStage.h"
#include "reflection/chrome/ConcaveImages.h"
#include "reflection/chrome/VirtualOptions.h"

namespace app {

/// All images of what is close to a hollow piece, as they are drawn (VirtualMesh on concave pieces): by mesh
/// and vertex.
struct HollowImages {
    std::vector<std::vector<std::vector<reflection::PlaceImage>>> meshes;
    std::size_t searched = 0;  ///< descents and searches everywhere
};

/// Eye: in the reflector's frame, the scene's.
HollowImages hollowImages(const reflection::ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const CloseMesh> meshes, double share,
                          const reflection::SearchOptions& search);

/// Images of some searches beside those of all, each of its own identity, and beside the truth.
struct HollowErrors {
    std::vector<double> fromFull, fromTruth;  ///< pixels, of images that both have
    std::size_t lost = 0;                     ///< images of all searches that some do not have
    std::size_t untrue = 0;                   ///< images where no ray meets the surface
};
/// Where rays see each vertex of each mesh: any number of pixels. On all cores. `found`: images whose points
/// are walked from besides the surface's own corners, between which two points may hide
/// (TrueReflection::all).
using HollowTruth = std::vector<std::vector<std::vector<glm::dvec2>>>;
HollowTruth hollowTruth(const StagedChrome& part, const glm::dvec3& eye, const PixelPlace& place,
                        const HollowImages& found);
HollowErrors hollowErrors(const HollowImages& full, const HollowImages& some, const HollowTruth& truth,
                          const PixelPlace& place);

/// Follows images from step to step: each goes on in the one of its vertex whose reflection point is nearest,
/// if that is so for both.
class HollowFollower {
  public:
    using Told = std::function<void(std::size_t, std::size_t, const glm::dvec2&, const glm::dvec2&)>;

    HollowFollower(std::span<const CloseMesh> meshes, const PixelPlace& place)
        : meshes_(meshes), place_(place) {}

    /// Moves less than this are not told apart, pixels.
    /// `told`: of each image that has moved, its mesh and vertex, the pixels where it was and is.
    void step(const HollowImages& now, double floorPixels, const Told& told = {});

    double ratio = 0;  ///< of an image's move to the largest of its neighbours', both at least the floor
    double at = 0;     ///< pixels that it moved by there
    double own = 0;    ///< worst change of an image's move from one step to the next, pixels
    std::size_t moves = 0, jumps = 0;  ///< jumps: moves of more than twice every neighbour's
    std::size_t comes = 0, goes = 0;   ///< images without one before, or after

  private:
    struct Move {
        bool known = false;
        glm::dvec2 by{0};
    };
    std::span<const CloseMesh> meshes_;
    const PixelPlace& place_;
    HollowImages before_;
    std::vector<std::vector<std::vector<Move>>> last_;
};

}  // namespace app
