#include "app/commands/WindowShots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace app {

namespace {

constexpr double farthestFront = 16;  ///< metres from a car to the glass that shows it
constexpr double eyeHeight = 1.65;    ///< metres: somebody who stands in the street

bool clear(const reflection::TriangleTracer& triangles, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::vec3 way(to - from);
    std::array<float, 1> x{way.x}, y{way.y}, z{way.z}, t{0};
    triangles.traceFan(glm::vec3(from), x, y, z, t);
    return t[0] > 0.97f;
}

}  // namespace

std::optional<WindowShot> carInWindow(const Scene& scene, const FrameScene& frame,
                                      const reflection::TriangleTracer& triangles, glm::ivec2 size) {
    std::optional<WindowShot> best;
    double bestScore = 0;
    for (std::uint32_t v = 0; v < frame.vehicles.size(); ++v) {
        const vehicles::VehiclePose& pose = frame.vehicles[v];
        if (pose.model > 1) continue;  // hatchbacks and saloons: no bus hides the window
        const glm::dvec3 car = pose.position + glm::dvec3(0, 0, 0.7);
        for (std::uint32_t f = 0; f < scene.glass.fronts.size(); ++f) {
            const city::GlassFront& front = scene.glass.fronts[f];
            if (front.pattern != city::Pattern::shopFront) continue;
            const double before = glm::dot(front.normal, car - front.outline[0]);
            if (before < 2 || before > farthestFront) continue;
            const glm::dvec3 along = glm::normalize(front.outline[1] - front.outline[0]);
            const glm::dvec3 image = car - 2 * before * front.normal;
            // From farther out than the car, to either side, so that it does not hide its own image.
            for (const double side : {-6.5, 6.5}) {
                glm::dvec3 eye = car + 4.0 * front.normal + side * along;
                eye.z = pose.position.z + eyeHeight;
                const double eyeBefore = before + 4.0;
                const glm::dvec3 glass = eye + (image - eye) * (eyeBefore / (eyeBefore + before));
                const double s = glm::dot(glass - front.outline[0], along);
                const double width = glm::length(front.outline[1] - front.outline[0]);
                // The car's length on either side shows too.
                if (s < 2.5 || s > width - 2.5) continue;
                if (glass.z < front.outline[0].z || glass.z > front.outline[2].z) continue;
                bool alone = true;
                for (const vehicles::VehiclePose& other : frame.vehicles)
                    alone = alone && (other.id == pose.id || glm::length(other.position - eye) > 5);
                if (!alone || !clear(triangles, eye, glass + 0.05 * front.normal) ||
                    !clear(triangles, eye, car) || !clear(triangles, car, glass + 0.05 * front.normal))
                    continue;
                const double score = 1 / glm::length(image - eye);
                if (score <= bestScore) continue;
                bestScore = score;
                best = WindowShot{lookAt(eye, 0.5 * (glass + car), glm::radians(62.0), size), v, f};
            }
        }
    }
    return best;
}

std::optional<View> betweenShops(const Scene& scene, const FrameScene& frame,
                                 const reflection::TriangleTracer& triangles, glm::ivec2 size) {
    constexpr double widestStreet = 45;
    std::optional<View> best;
    double bestScore = 0;
    const auto& fronts = scene.glass.fronts;
    for (const city::GlassFront& one : fronts) {
        if (one.pattern != city::Pattern::shopFront) continue;
        const glm::dvec3 along = glm::normalize(one.outline[1] - one.outline[0]);
        const double width = glm::length(one.outline[1] - one.outline[0]);
        for (const city::GlassFront& other : fronts) {
            if (other.pattern != city::Pattern::shopFront || glm::dot(one.normal, other.normal) > -0.99)
                continue;
            const glm::dvec3 middle = 0.5 * (other.outline[0] + other.outline[1]);
            const double across = glm::dot(middle - one.outline[0], one.normal);
            const double beside = glm::dot(middle - one.outline[0], along);
            if (across < 6 || across > widestStreet || beside < -4 || beside > width + 4) continue;
            const glm::dvec3 otherGlass = middle + glm::dvec3(0, 0, 1) + 0.05 * other.normal;
            for (const vehicles::VehiclePose& pose : frame.vehicles) {
                if (pose.model > 1) continue;
                const glm::dvec3 from = pose.position - one.outline[0];
                const double before = glm::dot(from, one.normal), at = glm::dot(from, along);
                if (before < 2 || before > across - 2 || at < 1 || at > width - 1) continue;
                // The other shop stands right across, not farther along the street.
                if (std::abs(beside - at) > 9) continue;
                const glm::dvec3 roof = pose.position + glm::dvec3(0, 0, 1.6);
                if (!clear(triangles, roof, otherGlass) ||
                    !clear(triangles, roof, roof - (before - 0.05) * one.normal))
                    continue;
                for (const double side : {-7.0, 7.0}) {
                    glm::dvec3 eye =
                        pose.position + side * along + (0.6 * before - before + 1.2) * one.normal;
                    eye.z = pose.position.z + eyeHeight;
                    const glm::dvec3 target =
                        pose.position - 0.45 * before * one.normal + glm::dvec3(0, 0, 1.2);
                    if (!clear(triangles, eye, pose.position + glm::dvec3(0, 0, 1)) ||
                        !clear(triangles, eye, target))
                        continue;
                    bool alone = true;
                    for (const vehicles::VehiclePose& v : frame.vehicles)
                        alone = alone && (v.id == pose.id || glm::length(v.position - eye) > 4);
                    const double score = alone ? 1 / (before + 0.2 * across) : 0;
                    if (score <= bestScore) continue;
                    bestScore = score;
                    best = lookAt(eye, target, glm::radians(68.0), size);
                }
            }
        }
    }
    return best;
}

std::optional<View> windowInDoor(const Scene& scene, const FrameScene& frame,
                                 const reflection::TriangleTracer& triangles, glm::ivec2 size) {
    std::optional<View> best;
    double bestScore = 0;
    for (const vehicles::VehiclePose& pose : frame.vehicles) {
        if (pose.model > 1) continue;
        const glm::dvec3 forward(std::cos(pose.heading), std::sin(pose.heading), 0);
        const glm::dvec3 left(-forward.y, forward.x, 0);
        for (const city::GlassFront& front : scene.glass.fronts) {
            const glm::dvec3 along = glm::normalize(front.outline[1] - front.outline[0]);
            const double before = glm::dot(pose.position - front.outline[0], front.normal);
            const double at = glm::dot(pose.position - front.outline[0], along);
            if (before < 3 || before > farthestFront || at < 2 ||
                at > glm::length(front.outline[1] - front.outline[0]) - 2)
                continue;
            const double side = glm::dot(left, front.normal) > 0 ? -1 : 1;  // of the car, that the shop sees
            if (std::abs(glm::dot(left, front.normal)) < 0.95) continue;
            const glm::dvec3 door = pose.position + 0.9 * side * left + glm::dvec3(0, 0, 0.75);
            glm::dvec3 eye = door + 2.2 * side * left + 0.9 * forward;
            eye.z = pose.position.z + 1.2;
            bool alone = clear(triangles, eye, door);
            for (const vehicles::VehiclePose& v : frame.vehicles)
                alone = alone && (v.id == pose.id || glm::length(v.position - eye) > 3.5);
            // Dark paint shows what it mirrors, and a shop in the sun is bright.
            const double sun = glm::dot(front.normal, glm::dvec3(frame.lighting.sunDirection));
            const double paint = (pose.paint.r + pose.paint.g + pose.paint.b) / 3;
            const double score = alone ? (0.2 + std::max(sun, 0.0)) * (1.5 - paint) / before : 0;
            if (score <= bestScore) continue;
            bestScore = score;
            best = lookAt(eye, door - 0.2 * forward, glm::radians(52.0), size);
        }
    }
    return best;
}

}  // namespace app
