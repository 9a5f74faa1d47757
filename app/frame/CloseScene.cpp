#include "app/frame/CloseScene.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace app {

city::Mesh roundedPillar(const city::StandingReflector& pillar) {
    city::Mesh mesh;
    if (!(pillar.radius > 0) || !(pillar.height > 0)) return mesh;
    constexpr int sides = 192, rings = 24;
    // The straight part goes on by a radius: what is seen near the rim is as right as elsewhere.
    const float r = pillar.radius;
    std::vector<std::pair<glm::vec2, glm::vec2>> profile;  // place and normal, (outwards, up)
    for (int i = 0; i <= rings; ++i) {
        const double a = 0.5 * std::numbers::pi * (static_cast<double>(i) / rings - 1);
        const glm::vec2 n(std::cos(a), std::sin(a));
        profile.emplace_back(glm::vec2(r * n.x, r * n.y - r), n);
    }
    constexpr int bands = 8;
    for (int i = 1; i < bands; ++i)
        profile.emplace_back(glm::vec2(r, -r + (pillar.height + 2 * r) * static_cast<float>(i) / bands),
                             glm::vec2(1, 0));
    for (int i = 0; i <= rings; ++i) {
        const double a = 0.5 * std::numbers::pi * i / rings;
        const glm::vec2 n(std::cos(a), std::sin(a));
        profile.emplace_back(glm::vec2(r * n.x, r * n.y + pillar.height + r), n);
    }
    for (const auto& [place, n] : profile)
        for (int j = 0; j < sides; ++j) {
            const double a = 2 * std::numbers::pi * j / sides;
            const glm::vec2 d(std::cos(a), std::sin(a));
            mesh.vertices.push_back({{place.x * d, place.y}, {n.x * d, n.y}, {}, 0});
        }
    const auto at = [](std::size_t i, int j) {
        return static_cast<std::uint32_t>(i * sides + static_cast<std::size_t>(j % sides));
    };
    for (std::size_t i = 0; i + 1 < profile.size(); ++i)
        for (int j = 0; j < sides; ++j)
            mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j),
                                                     at(i + 1, j + 1), at(i + 1, j)});
    return mesh;
}

CloseScene::CloseScene(const city::CityModel& city, std::span<const vehicles::VehicleModel> vehicleModels)
    : models(vehicleModels), parts(vehicleModels), standing(city) {
    // The reflectors' models are the last ones.
    if (models.size() < city.reflectors.size()) return;
    const std::size_t first = models.size() - city.reflectors.size();
    for (std::size_t i = 0; i < city.reflectors.size(); ++i)
        if (city.reflectors[i].shape == city::StandingReflector::Shape::pillar)
            parts.giveCompanion(first + i, roundedPillar(city.reflectors[i]));
}

}  // namespace app
