#include "app/frame/WetGround.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <locale>
#include <numbers>
#include <sstream>

#include "reflection/planar/Gloss.h"

namespace app {

namespace {

float hash(const glm::vec2& p) {
    glm::vec3 q = glm::fract(glm::vec3(p.x, p.y, p.x) * 0.1031f);
    q += glm::dot(q, glm::vec3(q.y, q.z, q.x) + 33.33f);
    return glm::fract((q.x + q.y) * q.z);
}

float noise(const glm::vec2& p) {
    const glm::vec2 i = glm::floor(p);
    glm::vec2 f = p - i;
    f = f * f * (3.0f - 2.0f * f);
    return glm::mix(glm::mix(hash(i), hash(i + glm::vec2(1, 0)), f.x),
                    glm::mix(hash(i + glm::vec2(0, 1)), hash(i + glm::vec2(1, 1)), f.x), f.y);
}

}  // namespace

WetGround wetGround(city::Pattern pattern, const glm::vec3& normal, const glm::vec2& place, float cosine) {
    WetGround ground;
    const bool soaks = pattern == city::Pattern::grass || pattern == city::Pattern::soil;
    ground.lies = soaks ? 0.0f : glm::smoothstep(wet::slopeDry, wet::slopeWet, normal.z);
    const float low = 0.6f * noise(place * 0.21f) + 0.28f * noise(place * 0.83f + 7.0f) +
                      0.12f * noise(place * 3.1f + 3.0f);
    ground.puddle = glm::smoothstep(wet::puddleFrom, wet::puddleTo, low) * ground.lies;
    ground.under = glm::mix(soaks ? wet::soakedShade : wet::filmShade, wet::puddleShade, ground.puddle);
    const float grazing = 1 - std::clamp(cosine, 0.0f, 1.0f);
    const float grazing2 = grazing * grazing;
    const float fresnel = wet::waterReflectance + (1 - wet::waterReflectance) * grazing2 * grazing2 * grazing;
    ground.mirrored = fresnel * ground.lies;
    return ground;
}

glm::vec2 rippleAt(const glm::vec2& place, float distance) {
    const glm::vec2 at = place * wet::ripplesPerMetre;
    return wet::rippleSlope * (glm::vec2(noise(at), noise(at + 19.0f)) - 0.5f) /
           (1 + wet::rippleFade * distance);
}

glm::vec3 wetSurroundings(const Lighting& lighting, const glm::vec3& reflected, float puddle,
                          float sunShare) {
    const float angle = filmAngle();
    const float apart =
        std::acos(std::clamp(glm::dot(reflected, lighting.sunDirection), -1.0f, 1.0f)) / angle;
    constexpr float inversePi = std::numbers::inv_pi_v<float>;
    const glm::vec3 houses = (0.5f * (lighting.groundIrradiance + lighting.skyIrradiance) +
                              wet::housesSun * lighting.sunIrradiance) *
                             (inversePi * wet::housesAlbedo);
    return glm::mix(houses, lighting.skyIrradiance * inversePi,
                    glm::smoothstep(wet::skyFrom, wet::skyTo, reflected.z)) +
           lighting.sunIrradiance *
               (std::exp(-0.5f * apart * apart) * (1 - puddle) * 0.15915494f / (angle * angle) * sunShare);
}

float filmAngle() {
    return static_cast<float>(reflection::glossAngle(static_cast<double>(wetRoughness)));
}

std::vector<std::string> wetDefinitions() {
    std::vector<std::string> lines;
    const auto define = [&](const char* name, float value) {
        std::ostringstream text;
        text.imbue(std::locale::classic());
        text.precision(9);
        text << name << " float(" << value << ')';
        lines.push_back(text.str());
    };
    define("WET_REFLECTANCE", wet::waterReflectance);
    define("WET_SOAKED_SHADE", wet::soakedShade);
    define("WET_FILM_SHADE", wet::filmShade);
    define("WET_PUDDLE_SHADE", wet::puddleShade);
    define("WET_FILM_SHARE", wet::filmShare);
    define("WET_SLOPE_DRY", wet::slopeDry);
    define("WET_SLOPE_WET", wet::slopeWet);
    define("WET_PUDDLE_FROM", wet::puddleFrom);
    define("WET_PUDDLE_TO", wet::puddleTo);
    define("WET_RIPPLE_SLOPE", wet::rippleSlope);
    define("WET_RIPPLES_PER_METRE", wet::ripplesPerMetre);
    define("WET_RIPPLE_FADE", wet::rippleFade);
    define("WET_FILM_ANGLE", filmAngle());
    define("WET_HOUSES_ALBEDO", wet::housesAlbedo);
    define("WET_HOUSES_SUN", wet::housesSun);
    define("WET_SKY_FROM", wet::skyFrom);
    define("WET_SKY_TO", wet::skyTo);
    define("WET_GRASS", static_cast<float>(city::Pattern::grass));
    define("WET_SOIL", static_cast<float>(city::Pattern::soil));
    return lines;
}

}  // namespace app
