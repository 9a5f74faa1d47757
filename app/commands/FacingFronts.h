#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "city/model/GlassFronts.h"

namespace app {

/// Two shop fronts that look at each other across a street.
struct FacingFronts {
    std::uint32_t one = 0, other = 0;  ///< indices into the fronts
    double across = 0;                 ///< metres from the plane of `one` to the middle of what is faced
    /// The part of `one` that has `other` right across: metres from outline[0] towards outline[1].
    double from = 0, to = 0;
};

/// How near, how far and how much of each other fronts must face to count.
struct FacingLimits {
    double nearest = 8, farthest = 30;  ///< metres across
    double leastOverlap = 4;            ///< metres along the street
    double mostTurn = 0.02;             ///< 1 + dot of the normals: 0.02 is 11 degrees off parallel
};

/// All pairs within the limits, each once with either front as `one`, those that face each other over more
/// metres for their distance first. Fronts of other patterns, or without width, are passed over. Heights must
/// overlap too. Cost: the square of the fronts, with a few products each.
std::vector<FacingFronts> facingFronts(std::span<const city::GlassFront> fronts,
                                       const FacingLimits& limits = {});

/// Where a ray that comes from the street meets a front's outline.
struct FrontHit {
    double way = 0;        ///< ray parameter, > 0
    double along = 0;      ///< metres from outline[0] towards outline[1]
    double up = 0;         ///< metres above outline[0]
    double cosine = 0;     ///< of the angle to the front's normal, > 0
    glm::dvec3 at{0};      ///< world
    glm::dvec3 mirror{0};  ///< the direction in which the light goes on, as long as the ray's
};

/// Nothing where the ray passes beside the outline, comes from behind, runs within the plane or is not
/// finite. `direction` need not have length one.
std::optional<FrontHit> meetFront(const city::GlassFront& front, const glm::dvec3& origin,
                                  const glm::dvec3& direction);

/// A direction after a flat mirror with this unit normal.
glm::dvec3 mirroredBy(const glm::dvec3& normal, const glm::dvec3& direction);

/// Share of light that a surface mirrors (Schlick), `straight` at normal incidence.
double schlick(double straight, double cosine);

}  // namespace app
