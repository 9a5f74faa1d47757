#include "app/raytrace/GroundShadows.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleShading.h"
#include "app/render/Frustum.h"

namespace app {

namespace {

/// Metres by which vehicle_shadow.vert pulls rectangles towards the eye.
constexpr float pull = 0.06f;

/// VehicleShadows::draw leaves out vehicles below this many pixels.
constexpr float smallest = 8;

float smoothstep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

float outside(const glm::vec2& p, const glm::vec2& halfSize) {
    const glm::vec2 d = glm::abs(p) - halfSize;
    return glm::length(glm::max(d, 0.0f)) + std::min(std::max(d.x, d.y), 0.0f);
}

float covered(const glm::vec3& towardsSun, const glm::vec2& p, const glm::vec2& halfSize, float z0, float z1,
              float blur) {
    const glm::vec2 perMetre = glm::vec2(towardsSun) / towardsSun.z;
    const glm::vec2 a = p + perMetre * z0, step = perMetre * (z1 - z0);
    const float d =
        std::min({outside(a, halfSize), outside(a + 0.5f * step, halfSize), outside(a + step, halfSize)});
    return 1 - smoothstep(-blur, blur, d);
}

}  // namespace

GroundShadows::GroundShadows(const FrameScene& frame, const RayMeshes& meshes, const RayShading& shading,
                             const View& view)
    : shading_(&shading) {
    const Frustum frustum(view.clipFromView * view.viewFromWorld);
    const float pixelsPerRadian = DetailRule::of(view).pixelsPerRadian;
    const glm::vec3 sun = shading.lighting().sunDirection;
    for (const vehicles::VehiclePose& pose : frame.vehicles) {
        if (pose.model >= meshes.vehicles().size() || stands(pose)) continue;
        const VehicleLevels& model = meshes.vehicles()[pose.model].levels;
        // Only vehicles that the view shows: VehiclePass::boundsOf.
        const glm::mat3 rotation = worldFromVehicle(pose);
        const glm::mat3 extent(glm::abs(rotation[0]), glm::abs(rotation[1]), glm::abs(rotation[2]));
        const glm::vec3 position(pose.position - view.eye);
        if (!frustum.touches(position + rotation * model.centre, extent * model.halfSize)) continue;
        if (smallest * glm::length(position) / pixelsPerRadian > 2 * model.radius) continue;

        Rectangle r = rectangleOf(pose, model, view.eye, sun);
        for (glm::vec3& corner : r.corner) corner *= 1 - pull / std::max(glm::length(corner), 1.0f);
        bound(r);
        rectangles_.push_back(r);
    }
}

GroundShadows::GroundShadows(const FrameScene& frame, const RayMeshes& meshes, const RayShading& shading)
    : shading_(&shading) {
    for (const vehicles::VehiclePose& pose : frame.vehicles) {
        if (pose.model >= meshes.vehicles().size() || stands(pose)) continue;
        rectangles_.push_back(rectangleOf(pose, meshes.vehicles()[pose.model].levels, glm::dvec3(0),
                                          shading.lighting().sunDirection));
        bound(rectangles_.back());
    }
}

GroundShadows::Rectangle GroundShadows::rectangleOf(const vehicles::VehiclePose& pose,
                                                    const VehicleLevels& model, const glm::dvec3& eye,
                                                    const glm::vec3& sun) {
    const glm::vec3 position(pose.position - eye);
    const auto c = static_cast<float>(std::cos(pose.heading));
    const auto s = static_cast<float>(std::sin(pose.heading));
    const glm::vec3 place = position + glm::vec3(c * model.centre.x - s * model.centre.y,
                                                 s * model.centre.x + c * model.centre.y, 0);
    Rectangle r;
    r.halfSize = glm::vec2(model.halfSize);
    r.height = model.centre.z + model.halfSize.z;
    r.towardsSun = {c * sun.x + s * sun.y, c * sun.y - s * sun.x, std::max(sun.z, 0.2f)};
    const glm::vec2 reach = -glm::vec2(r.towardsSun) / r.towardsSun.z * r.height;
    const glm::vec2 low = glm::min(-r.halfSize, -r.halfSize + reach) - 0.6f;
    const glm::vec2 high = glm::max(r.halfSize, r.halfSize + reach) + 0.6f;
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::vec2 p((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y);
        r.corner[k] = place + glm::vec3(c * p.x - s * p.y, s * p.x + c * p.y, 0.02f);
        r.position[k] = p;
        r.world[k] = r.corner[k] + glm::vec3(eye);
    }
    return r;
}

void GroundShadows::bound(Rectangle& r) {
    r.middle = 0.25f * (r.corner[0] + r.corner[1] + r.corner[2] + r.corner[3]);
    for (const glm::vec3& corner : r.corner) r.radius = std::max(r.radius, glm::length(corner - r.middle));
}

glm::vec3 GroundShadows::shareAt(const Rectangle& r, const glm::vec2& position,
                                 const glm::vec3& world) const {
    const Lighting& light = shading_->lighting();
    const float open = 1 - 0.82f * (1 - smoothstep(-0.35f, 0.45f, outside(position, r.halfSize - 0.08f)));
    const float shade = std::max(
        covered(r.towardsSun, position, r.halfSize - glm::vec2(0.1f, 0.06f), 0.2f, 0.6f * r.height, 0.06f),
        covered(r.towardsSun, position, r.halfSize * glm::vec2(0.62f, 0.84f), 0.6f * r.height,
                0.97f * r.height, 0.12f));
    const float sun = shading_->sunAt(world, {0, 0, 1});
    const glm::vec3 direct = light.sunIrradiance * (std::max(light.sunDirection.z, 0.0f) * sun);
    const glm::vec3 before = light.skyIrradiance + direct;
    const glm::vec3 after = light.skyIrradiance * open + direct * ((1 - shade) * std::min(1.0f, 0.4f + open));
    return after / before;
}

glm::vec3 GroundShadows::product(const glm::vec3& origin, const glm::vec3& direction,
                                 const std::function<bool(float)>& before) const {
    glm::vec3 product(1);
    for (const Rectangle& r : rectangles_) {
        const glm::vec3 middle = r.middle - origin;
        const float along = glm::dot(middle, direction);
        if (glm::dot(middle, middle) - along * along > r.radius * r.radius || along < -r.radius) continue;
        for (const std::array<std::size_t, 3> corners : {std::array<std::size_t, 3>{0, 1, 2}, {2, 1, 3}}) {
            const MetTriangle triangle{{},
                                       {r.corner[corners[0]], r.corner[corners[1]], r.corner[corners[2]]}};
            glm::vec2 w;
            if (!triangle.meet(origin, direction, w) || w.x < 0 || w.y < 0 || w.x + w.y > 1) continue;
            if (!before(glm::dot(triangle.at(w) - origin, direction))) continue;
            const auto blend = [&](const auto& values) {
                return values[corners[0]] * (1 - w.x - w.y) + values[corners[1]] * w.x +
                       values[corners[2]] * w.y;
            };
            product *= shareAt(r, blend(r.position), blend(r.world));
            break;
        }
    }
    return product;
}

glm::vec3 GroundShadows::factor(const glm::vec3& direction, float distance) const {
    // Display values are about square roots of radiance.
    return glm::sqrt(product(glm::vec3(0), direction, [&](float t) { return t > 0 && t <= distance; }));
}

glm::vec3 GroundShadows::share(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
    return product(origin, direction,
                   [&](float t) { return t > 0 && t - pull * std::min(t, 1.0f) <= distance; });
}

}  // namespace app
