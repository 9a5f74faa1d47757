#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "app/frame/Lighting.h"
#include "city/model/Material.h"

namespace app {

/// What rain makes of ground: the one place of its numbers. The shader gets them as definitions
/// (wetDefinitions), rays read them here; wet_ground.frag and wetGround() are twins.
namespace wet {

inline constexpr float waterReflectance = 0.02f;  ///< at normal incidence
/// Shares of the dry ground's light that come through: soaked soil and grass, asphalt under a film, puddles.
inline constexpr float soakedShade = 0.75f, filmShade = 0.62f, puddleShade = 0.45f;
/// Share of the mirrored light that grains which stick out of the film leave.
inline constexpr float filmShare = 0.7f;
/// Cosines to the vertical between which water begins to lie on ground.
inline constexpr float slopeDry = 0.95f, slopeWet = 0.999f;
/// Lowness of the ground between which a puddle begins.
inline constexpr float puddleFrom = 0.54f, puddleTo = 0.6f;
/// Largest slope of ripples times two, ripples a metre, and metres^-1 by which distance flattens them: what
/// is finer than a pixel moves nothing.
inline constexpr float rippleSlope = 0.018f, ripplesPerMetre = 9, rippleFade = 0.05f;

/// What ground mirrors where no image is to be had: houses of this albedo, which this share of the sun
/// reaches, and sky above them: sines of the elevations between which it begins.
inline constexpr float housesAlbedo = 0.35f, housesSun = 0.15f, skyFrom = 0.25f, skyTo = 0.8f;

}  // namespace wet

/// Roughness of the film of water on asphalt: its microfacets spread what it mirrors by 5 degrees.
inline constexpr float wetRoughness = 0.25f;

/// A point of the ground after rain.
struct WetGround {
    float lies = 0;      ///< how much water lies there: 1 film or puddle, 0 soaked or too steep
    float puddle = 0;    ///< share of the water that is a puddle
    float under = 1;     ///< factor on the dry ground's light
    float mirrored = 0;  ///< share of the mirrored light, after Schlick, and of what is not let through
};

/// `normal`: of the ground, interpolated; `place`: world x, y; `cosine`: between the vertical and the
/// direction to the eye, negative counts as 0.
WetGround wetGround(city::Pattern pattern, const glm::vec3& normal, const glm::vec2& place, float cosine);

/// Slope (towards x and y, with the opposite sign of its height's) of the ripples of a puddle that is seen
/// from so many metres: the normal is (slope, 1).
glm::vec2 rippleAt(const glm::vec2& place, float distance);

/// What wet ground mirrors where no image is to be had: mean light, and the sun spread by the film.
/// `reflected`: unit; `sunShare`: of the sun's light that arrives.
glm::vec3 wetSurroundings(const Lighting& lighting, const glm::vec3& reflected, float puddle, float sunShare);

/// Standard deviation, radians, of the direction in which the film mirrors, in the plane of incidence.
float filmAngle();

/// The numbers above as definitions for wet_ground.frag.
std::vector<std::string> wetDefinitions();

}  // namespace app
