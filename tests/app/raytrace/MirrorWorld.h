#pragma once

#include <cmath>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "app/frame/FrameScene.h"
#include "tests/app/render/BoxWorld.h"

namespace app::test {

inline constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);

/// A ball of chrome of radius 1 around (0, 0, 1) of the vehicle's frame.
inline vehicles::VehicleModel mirrorBall(int segments = 192) {
    vehicles::VehicleModel model;
    vehicles::VehicleModel::Level level;
    const auto at = [&](int i, int j) {
        const double a = 2 * std::numbers::pi * i / (2 * segments), b = std::numbers::pi * j / segments;
        const glm::vec3 n(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
        return city::Vertex{n + glm::vec3(0, 0, 1), n, {0, 0}, chrome};
    };
    for (int i = 0; i < 2 * segments; ++i)
        for (int j = 0; j < segments; ++j)
            level.body.addQuad(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    model.levels.push_back(level);
    model.length = model.width = model.height = 2;
    return model;
}

/// A box of chrome: 4 x 2 x 2 m on the ground.
inline vehicles::VehicleModel mirrorBox() {
    vehicles::VehicleModel model;
    vehicles::VehicleModel::Level level;
    addBox(level.body, {-2, -1, 0}, {2, 1, 2}, chrome);
    model.levels.push_back(level);
    model.length = 4;
    model.width = model.height = 2;
    return model;
}

inline vehicles::VehiclePose poseAt(std::uint32_t id, std::uint32_t model, const glm::dvec3& position,
                                    double heading = 0) {
    vehicles::VehiclePose pose;
    pose.id = id;
    pose.model = model;
    pose.position = position;
    pose.heading = heading;
    return pose;
}

}  // namespace app::test
