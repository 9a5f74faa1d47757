#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "reflection/local_map/LocalMap.h"
#include "reflection/reference_maps/PackedReferenceMap.h"

namespace reflection {

/// One reference map as seen from the centre of a local map.
struct Candidate {
    const PackedReferenceMap* map = nullptr;
    glm::vec3 offset{0};  ///< the map's centre minus the local map's, metres
};

struct LookupOptions {
    /// Lookups a candidate may use to move the hit along the ray until the candidate's own distance agrees (1
    /// .. 8).
    int lookups = 4;
    /// A candidate that agrees within this share of the distance ends the search. It cannot be below what the
    /// packed distance resolves (2^-8) and a texel's slant: 1 % is the flat optimum measured on the built-in
    /// cities.
    float agreement = 0.01f;
    /// Radiance of the sky alone in a map of the local map's face size, or null. Where the heightfield shows
    /// sky it is taken from here: no parallax to correct, and of what a reference map has of the sky another
    /// part is hidden by roofs.
    const LocalMap* sky = nullptr;
};

/// Reads a face of a local map from reference maps with refined hits.
///
/// For each texel the ray P + t d starts from the heightfield's hit t0 = 1 / reciprocal. Seen from a
/// candidate at C the point X = P + t d has depth m(X) along the axis of the face in which it lies, where the
/// candidate stored depth M. Along a plane n.(Y - C) = c the ratio q(t) = m / M - 1 is a linear function of t
/// (1 / M = n.w / c for the direction w = (X - C) / m, so m / M = n.(X - C) / c): the secant through two
/// lookups meets the surface exactly, whatever the angle; the start is the projection of the candidate's own
/// surface point onto the ray. q < 0: the candidate looks past X, so the heightfield was too fat; q > 0:
/// something hides X from the candidate. Of up to 16 candidates those that see X in about the local map's own
/// detail are asked first (DetailOrder.h), until one agrees; where none does the best agreement wins (the
/// paper: the closest).
///
/// `reciprocal`: faceSize^2 values of 1/t0, 0 for sky (taken as a cube skyDepth away). Writes the face's
/// texels of `map`. Needs at least one candidate, all of one face size. Cost: about lookups + 5 gathers a
/// texel.
void lookUpRefined(int face, std::span<const float> reciprocal, std::span<const Candidate> candidates,
                   const LookupOptions& options, LocalMap& map);

/// The paper's lookup (sections 4.1 to 4.3) for two maps: colours in the directions from each map's centre to
/// the points given, mixed by the weights. `px, py, pz`: the interpolated points I relative to the local
/// map's centre; `weightA`: weight of candidate 0, the rest is candidate 1's. All spans faceSize^2.
void lookUpBlended(int face, std::span<const float> px, std::span<const float> py, std::span<const float> pz,
                   std::span<const float> weightA, const Candidate& a, const Candidate& b, LocalMap& map);

/// Distance stored in the direction of a point (relative to the local map's centre), nearest texel: what the
/// paper's depth test compares with. The slow scalar way, for mesh vertices.
float storedDistance(const Candidate& candidate, const glm::vec3& point);

}  // namespace reflection
