#pragma once

#include <cmath>
#include <vector>

#include "app/frame/ChromePlan.h"
#include "app/frame/StandingReflectors.h"
#include "city/model/CityModel.h"

namespace app::test {

/// A chrome sphere of a metre in radius that rests on the origin, and a box of paint with a chrome button.
struct ChromeWorld {
    city::CityModel city;
    std::vector<vehicles::VehicleModel> models;
    ChromeParts parts;
    FrameScene scene;
    std::vector<std::uint32_t> seen;

    explicit ChromeWorld(double eyeDistance, int cars = 1) {
        city.reflectors.push_back({"sphere", city::StandingReflector::Shape::sphere,
                                   city::StandingReflector::Stuff::chrome, glm::vec3(0), 1, 2});
        vehicles::VehicleModel car;
        car.length = 4;
        car.width = 2;
        car.height = 1.5f;
        car.levels.emplace_back().body = button({2, 0, 0.7f});
        models = {car, standingModels(city).front()};
        parts = ChromeParts(models);
        scene.vehicles = standingPoses(city, 1);
        for (int i = 0; i < cars; ++i) {
            vehicles::VehiclePose& pose = scene.vehicles.emplace_back();
            pose.id = static_cast<std::uint32_t>(i);
            pose.position = {0, 2.5 + 3 * i, 0};
        }
        for (std::uint32_t i = 0; i < scene.vehicles.size(); ++i) seen.push_back(i);
        lookFrom(eyeDistance);
    }

    void lookFrom(double distance) { scene.views = {lookAt({distance, 0, 1}, {0, 0, 1}, 1, {1280, 720})}; }
    ChromePlan plan(ChromePlanOptions options = {}) const {
        options.vehicles = true;
        return planChrome(scene, seen, models, parts, options);
    }

    static city::Mesh ball(const glm::vec3& centre, float radius) {
        constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);
        constexpr int n = 12;
        city::Mesh mesh;
        const auto add = [&](float along, float around) {
            const glm::vec3 d(std::cos(along), std::sin(along) * std::cos(around),
                              std::sin(along) * std::sin(around));
            mesh.vertices.push_back({centre + radius * d, d, {}, chrome});
        };
        const auto pi = static_cast<float>(M_PI);
        add(0, 0);
        for (int i = 1; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j)
                add(pi * static_cast<float>(i) / n, pi * static_cast<float>(j) / n);
        add(pi, 0);
        const auto at = [](int i, int j) {
            return i == 0   ? 0u
                   : i == n ? static_cast<std::uint32_t>(2 * n * (n - 1) + 1)
                            : static_cast<std::uint32_t>(1 + (i - 1) * 2 * n + j % (2 * n));
        };
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                if (i + 1 < n)
                    mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                if (i > 0)
                    mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        return mesh;
    }
    /// A ball of 10 cm; `open`: its half towards +x, the back open.
    static city::Mesh button(const glm::vec3& centre, bool open = false) {
        if (!open) return ball(centre, 0.1f);
        city::Mesh mesh;
        constexpr int n = 12;
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                const double a = 1.4 * i / n, b = M_PI * j / n;
                const glm::vec3 d(std::cos(a), std::sin(a) * std::cos(b), std::sin(a) * std::sin(b));
                mesh.vertices.push_back(
                    {centre + 0.1f * d, d, {}, static_cast<std::uint32_t>(vehicles::Surface::chrome)});
            }
        const auto at = [](int i, int j) { return static_cast<std::uint32_t>(i * 2 * n + j % (2 * n)); };
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j)
                mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j),
                                                         at(i + 1, j + 1), at(i, j + 1)});
        return mesh;
    }
};

}  // namespace app::test
