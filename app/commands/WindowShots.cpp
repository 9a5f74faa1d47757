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

}  // namespace app
