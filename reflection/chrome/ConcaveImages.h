#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

/// One of a place's images in a concave piece.
struct PlaceImage {
    static constexpr std::uint32_t none = 0xffffffffu;

    glm::dvec3 point{0};   ///< where it is reflected, in the map's frame
    glm::vec3 fromEye{0};  ///< as VirtualVertex::fromEye
    bool onPart = false;   ///< else on the closing surface, past the rim
    std::uint32_t vertex = none;
};

/// All images of places in a concave piece, seen from one eye. What the piece itself stands before, on the
/// way from the reflection point, is no image.
class ConcaveImages {
  public:
    /// Keeps a reference to the map. Eye: in the reflector's frame.
    ConcaveImages(const ReflectorMap& map, const glm::dvec3& eye, const SearchOptions& options);

    /// All of a place's images, searched for everywhere: see findAllReflectionPoints.
    std::vector<PlaceImage> everywhere(const glm::dvec3& place) const;
    /// Adds what a place's images near to another place's are: from each of those, Newton steps. Returns how
    /// many were new. Cost: some lookups for each.
    std::size_t follow(const glm::dvec3& place, std::span<const PlaceImage> from,
                       std::vector<PlaceImage>& into) const;

    /// The images of all places of a mesh: everywhere at one in 1 / `share` of them, and from there along the
    /// mesh's edges for as long as they go on. Deterministic. Cost: 0.1 ms for each that is searched
    /// everywhere, a microsecond for every other image.
    std::vector<std::vector<PlaceImage>> ofMesh(std::span<const glm::dvec3> places,
                                                std::span<const std::uint32_t> triangles, double share) const;

    std::size_t searched() const { return searched_; }

  private:
    /// The same of several, given by their places in a list; adds to `images`.
    void everywhere(std::span<const glm::dvec3> places, std::span<const std::uint32_t> at,
                    std::span<std::vector<PlaceImage>> images) const;
    bool image(const glm::dvec3& place, const glm::dvec3& point, const glm::dvec3& normal,
               PlaceImage& made) const;

    const ReflectorMap& map_;
    glm::dvec3 eye_, mapEye_;
    SearchOptions options_;
    mutable std::size_t searched_ = 0;
};

/// For each image of one place the one of another that lies nearest, and for which it is the nearest in turn:
/// those belong together, as long as both places are close. PlaceImage::none for those without.
std::vector<std::uint32_t> matches(std::span<const PlaceImage> a, std::span<const PlaceImage> b);

}  // namespace reflection
