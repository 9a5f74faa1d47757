#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "app/frame/Lighting.h"

namespace app {

/// The uniform block `Frame` of data/shaders/frame.glsl, std140.
struct FrameUniforms {
    glm::mat4 clipFromRelative{1};
    glm::mat4 shadowFromWorld{1};
    glm::vec4 eyeHigh{0};
    glm::vec4 eyeLow{0};
    glm::vec4 sunDirection{0};
    glm::vec4 sunIrradiance{0};
    glm::vec4 skyIrradiance{0};
    glm::vec4 groundIrradiance{0};
    glm::vec4 fadeFrom{0};

    void setEye(const glm::dvec3& eye) {
        const glm::vec3 high(eye);
        eyeHigh = glm::vec4(high, eyeHigh.w);
        eyeLow = glm::vec4(glm::vec3(eye - glm::dvec3(high)), 0);
    }
    /// Of images of mirrors: what they show fades by so much a metre of way behind a plane (relative to the
    /// eye: dot(xyz, p) + w = 0, the eye on its negative side).
    void setFading(float perMetre, const glm::vec4& from) {
        eyeHigh.w = perMetre;
        fadeFrom = from;
    }
    void setShadow(const glm::mat4& shadowFromWorldMatrix, float normalOffset) {
        shadowFromWorld = shadowFromWorldMatrix;
        groundIrradiance.w = normalOffset;
    }
    void setLighting(const Lighting& lighting) {
        sunDirection = glm::vec4(lighting.sunDirection, lighting.turbidity);
        sunIrradiance = glm::vec4(lighting.sunIrradiance, lighting.exposure);
        skyIrradiance = glm::vec4(lighting.skyIrradiance, lighting.lampsLit ? 1.f : 0.f);
        groundIrradiance = glm::vec4(lighting.groundIrradiance, groundIrradiance.w);
    }
};
static_assert(sizeof(FrameUniforms) == 2 * 64 + 7 * 16);

}  // namespace app
