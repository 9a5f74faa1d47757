#include "app/frame/VehicleShading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace app {

namespace {

constexpr float inversePi = std::numbers::inv_pi_v<float>;

struct SurfaceOptics {
    glm::vec3 albedo;
    float f0;
};

// As in data/shaders/vehicle.vert.
constexpr std::array<SurfaceOptics, static_cast<std::size_t>(vehicles::Surface::count)> surfaces{{
    {{1.0f, 1.0f, 1.0f}, 0.04f},
    {{0.012f, 0.015f, 0.016f}, 0.06f},
    {{0.05f, 0.05f, 0.05f}, 0.72f},
    {{0.018f, 0.018f, 0.019f}, 0.012f},
    {{0.22f, 0.22f, 0.23f}, 0.38f},
    {{0.55f, 0.56f, 0.58f}, 0.08f},
    {{0.30f, 0.012f, 0.010f}, 0.06f},
    {{0.016f, 0.016f, 0.017f}, 0.02f},
    {{0.04f, 0.038f, 0.036f}, 0.0f},
    {{0.014f, 0.014f, 0.015f}, 0.048f},
    {{1.0f, 1.0f, 1.0f}, 0.0f},
    {{0.45f, 0.25f, 0.17f}, 0.0f},
}};

}  // namespace

CoatedVertex coatedVertex(const Lighting& lighting, vehicles::Surface surface,
                          const vehicles::VehiclePose& pose, const glm::vec3& normal, float sun) {
    const SurfaceOptics& optics = surfaces[std::min(static_cast<std::size_t>(surface), surfaces.size() - 1)];
    const bool coloured = surface == vehicles::Surface::paint || surface == vehicles::Surface::cloth;
    const glm::vec3 albedo = coloured ? pose.paint : optics.albedo;
    const glm::vec3 ambient =
        glm::mix(lighting.groundIrradiance, lighting.skyIrradiance, 0.5f + 0.5f * normal.z) * 0.85f;
    const glm::vec3 light =
        ambient + lighting.sunIrradiance * (sun * std::max(glm::dot(normal, lighting.sunDirection), 0.0f));
    const float lit = lighting.lampsLit ? 1.0f : 0.0f;
    glm::vec3 emission(0);
    if (surface == vehicles::Surface::headLamp) emission = glm::vec3(6.0f, 5.6f, 5.0f) * lit;
    if (surface == vehicles::Surface::tailLamp)
        emission = glm::vec3(1.6f, 0.05f, 0.03f) * (1.4f * (pose.braking ? 1.0f : 0.0f) + 0.35f * lit);
    return {albedo * light * inversePi + emission, optics.f0, optics.f0 >= 0.03f ? 1.0f : 0.0f, sun};
}

float coatFresnel(const CoatedVertex& point, float facing) {
    const float grazing = 1 - std::max(facing, 0.0f);
    const float grazing2 = grazing * grazing;
    return point.f0 + (1 - point.f0) * point.coat * grazing2 * grazing2 * grazing;
}

glm::vec3 plainSurroundings(const Lighting& lighting, const CoatedVertex& point, const glm::vec3& reflected) {
    const float up = std::clamp(reflected.z * 2 + 0.5f, 0.0f, 1.0f);
    const glm::vec3 mirrored =
        glm::mix(lighting.groundIrradiance, lighting.skyIrradiance, up) * (inversePi * 0.8f);
    float glint = std::max(glm::dot(reflected, lighting.sunDirection), 0.0f);
    for (int doubling = 0; doubling < 7; ++doubling)
        glint *= glint;  // to the power of 128, as the shader does
    return mirrored + lighting.sunIrradiance * (8 * glint * point.coat * point.sun);
}

glm::vec3 vehicleRadiance(const Lighting& lighting, vehicles::Surface surface,
                          const vehicles::VehiclePose& pose, const glm::vec3& normal,
                          const glm::vec3& towardsEye, float sun) {
    const CoatedVertex point = coatedVertex(lighting, surface, pose, normal, sun);
    const float fresnel = coatFresnel(point, glm::dot(normal, towardsEye));
    const glm::vec3 reflected = 2 * glm::dot(normal, towardsEye) * normal - towardsEye;
    return point.diffuse * (1 - fresnel) + plainSurroundings(lighting, point, reflected) * fresnel;
}

glm::mat3 worldFromVehicle(const vehicles::VehiclePose& pose) {
    const auto ch = static_cast<float>(std::cos(pose.heading)),
               sh = static_cast<float>(std::sin(pose.heading));
    const auto cp = static_cast<float>(std::cos(pose.pitch)), sp = static_cast<float>(std::sin(pose.pitch));
    // Columns: forward (nose up by the pitch), left, up.
    return {glm::vec3(ch * cp, sh * cp, sp), glm::vec3(-sh, ch, 0), glm::vec3(-ch * sp, -sh * sp, cp)};
}

}  // namespace app
