#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace app {

/// A unit vector as GL_INT_2_10_10_10_REV, normalised: off by at most 0.06 degrees.
inline std::uint32_t packNormal(const glm::vec3& n) {
    const auto part = [](float x) {
        const float clamped = std::isfinite(x) ? std::clamp(x, -1.f, 1.f) : 0.f;
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(clamped * 511.f))) & 0x3ffu;
    };
    return part(n.x) | part(n.y) << 10 | part(n.z) << 20;
}

/// A vertex of the static city: 28 bytes.
struct CityVertex {
    glm::vec3 position;    ///< world metres, or the prototype's frame
    glm::vec2 texcoord;    ///< repeats of the pattern
    std::uint32_t normal;  ///< see packNormal
    std::uint16_t material;
    std::uint16_t open;  ///< share of the sky that is not built up, 65535 = all
};
static_assert(sizeof(CityVertex) == 28);

/// A vertex of a pane of glass or of polished stone: 32 bytes.
struct GlassVertex {
    glm::vec3 position;    ///< world metres
    glm::vec2 texcoord;    ///< repeats of the pattern of what is seen behind
    std::uint32_t normal;  ///< see packNormal
    std::uint16_t material;
    std::uint8_t reflectance;    ///< at normal incidence, 255 = all
    std::uint8_t transmittance;  ///< the same
    std::uint16_t glossAngle;    ///< of reflection/planar/Gloss.h, 65535: one radian
    std::uint16_t solid;         ///< 65535: what is painted lies at the surface; 0: in a room behind it
};
static_assert(sizeof(GlassVertex) == 32);

/// A vertex of a vehicle: 20 bytes.
struct VehicleVertex {
    glm::vec3 position;  ///< vehicle frame, metres
    std::uint32_t normal;
    std::uint32_t surface;  ///< vehicles::Surface
};
static_assert(sizeof(VehicleVertex) == 20);

/// A placed prototype: rows of worldFromPrototype.
struct PlacementInstance {
    glm::vec4 row0;
    glm::vec4 row1;
    glm::vec4 row2;
};

/// A vehicle, or one of its wheels, in one view.
struct VehicleInstance {
    glm::vec4 row0;  ///< rows of relativeFromVehicle: world axes, origin at the eye
    glm::vec4 row1;
    glm::vec4 row2;
    glm::vec4 paint;   ///< rgb; w: 1 when braking
    glm::vec4 map{0};  ///< centre of the local map, relative to the eye; w: its cube index
};
static_assert(sizeof(VehicleInstance) == 80);

/// A range of an index buffer over a range of a vertex buffer.
struct MeshRange {
    std::uint32_t firstIndex = 0;
    std::uint32_t indexCount = 0;
    std::int32_t baseVertex = 0;

    bool empty() const { return indexCount == 0; }
};

}  // namespace app
