#include "app/commands/SquareShots.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <optional>

#include "app/frame/StandingReflectors.h"

namespace app {

namespace {

constexpr double eyeHeight = 1.7;   // metres
constexpr double farAway = 12;      // metres
constexpr double fieldOfView = 50;  // degrees
constexpr double lens = 30;         // degrees, of a look at what one shows of another
constexpr double beside = 3;        // metres between two such
constexpr double nearby = 30;       // metres within which vehicles are seen in a reflector

/// From a place towards the nearest lane's middle line: unit, level.
glm::dvec3 towardsLane(const city::CityModel& city, const glm::dvec3& from) {
    double least = std::numeric_limits<double>::infinity();
    glm::dvec3 best(0, -1, 0);
    for (const city::Lane& lane : city.roads.lanes)
        for (const glm::vec3& p : lane.centreLine) {
            const glm::dvec2 d = glm::dvec2(p) - glm::dvec2(from);
            const double length = glm::length(d);
            if (length < least && length > 1e-3) {
                least = length;
                best = glm::dvec3(d / length, 0);
            }
        }
    return best;
}

/// World z of the ground's triangles under a place; the place's own where there are none.
double groundBelow(const city::CityModel& city, const glm::dvec3& place) {
    for (const city::Chunk& chunk : city.chunks) {
        if (chunk.kind != city::ChunkKind::ground) continue;
        for (std::size_t k = 0; k + 2 < chunk.mesh.indices.size(); k += 3) {
            const auto corner = [&](std::size_t c) {
                return glm::dvec3(chunk.mesh.vertices[chunk.mesh.indices[k + c]].position);
            };
            const glm::dvec3 a = corner(0), u = corner(1) - a, v = corner(2) - a, p = place - a;
            const double area = u.x * v.y - u.y * v.x;
            if (!(area > 0)) continue;
            const double s = (p.x * v.y - p.y * v.x) / area, t = (u.x * p.y - u.y * p.x) / area;
            if (s >= 0 && t >= 0 && s + t <= 1) return a.z + s * u.z + t * v.z;
        }
    }
    return place.z;
}

}  // namespace

std::vector<SquareShot> squareShots(const city::CityModel& city, glm::ivec2 resolution) {
    std::vector<SquareShot> shots;
    if (city.reflectors.empty()) return shots;
    const auto look = [&](const glm::dvec3& middle, const glm::dvec3& direction, double away) {
        const glm::dvec3 eye(glm::dvec2(middle + away * direction), eyeHeight);
        return lookAt(eye, middle, glm::radians(fieldOfView), resolution);
    };
    glm::dvec3 sum(0);
    for (std::uint32_t i = 0; i < city.reflectors.size(); ++i) {
        const city::StandingReflector& reflector = city.reflectors[i];
        const glm::dvec3 middle(reflector.centre());
        const glm::dvec3 direction = towardsLane(city, middle);
        const double half = 0.5 * static_cast<double>(std::max(reflector.height, 2 * reflector.radius));
        const double close = half / std::tan(0.25 * glm::radians(fieldOfView)) + reflector.radius;
        shots.push_back({reflector.name + " near", look(middle, direction, close), i});
        shots.push_back({reflector.name + " far", look(middle, direction, farAway), i});
        sum += middle;
    }
    const glm::dvec3 middle = sum / static_cast<double>(city.reflectors.size());
    shots.push_back({"square", look(middle, towardsLane(city, middle), farAway), std::nullopt});
    return shots;
}

std::vector<PairShot> pairShots(const city::CityModel& city, glm::ivec2 resolution) {
    std::vector<PairShot> shots;
    const auto chrome = [](const city::StandingReflector& r) {
        return r.stuff == city::StandingReflector::Stuff::chrome;
    };
    for (std::uint32_t i = 0; i < city.reflectors.size(); ++i)
        for (std::uint32_t j = 0; j < city.reflectors.size(); ++j) {
            const city::StandingReflector &sphere = city.reflectors[i], &other = city.reflectors[j];
            if (i == j || !chrome(sphere) || !chrome(other) ||
                sphere.shape != city::StandingReflector::Shape::sphere)
                continue;
            const glm::dvec3 middle(sphere.centre());
            const glm::dvec3 lane = towardsLane(city, middle);
            const glm::dvec3 towards = glm::cross(lane, glm::dvec3(0, 0, 1));
            glm::dvec3 foot = glm::dvec3(sphere.foot) + beside * towards;
            foot.z = groundBelow(city, foot);
            // Seen from the lane's side, it is met halfway between the two directions.
            const glm::dvec3 eye(glm::dvec2(middle + beside * lane), eyeHeight);
            const glm::dvec3 at =
                middle + static_cast<double>(sphere.radius) * glm::normalize(lane + towards);
            shots.push_back({other.name + " beside the " + sphere.name,
                             lookAt(eye, at, glm::radians(lens), resolution), i, j, foot});
        }
    return shots;
}

void bringBeside(FrameScene& frame, const PairShot& shot) {
    for (vehicles::VehiclePose& pose : frame.vehicles)
        if (pose.id == firstStandingId + shot.other) pose.position = shot.foot;
}

bool metTwice(const city::CityModel& city, const PairShot& shot, std::size_t pixel) {
    const View& view = shot.view;
    const auto x = static_cast<int>(pixel) % view.size.x, y = static_cast<int>(pixel) / view.size.x;
    const glm::dvec4 p = glm::inverse(glm::dmat4(view.clipFromView * view.viewFromWorld)) *
                         glm::dvec4((x + 0.5) / view.size.x * 2 - 1, 1 - (y + 0.5) / view.size.y * 2, 0.5, 1);
    const glm::dvec3 d = glm::normalize(glm::dvec3(p) / p.w);
    const city::StandingReflector &sphere = city.reflectors[shot.sphere],
                                  &other = city.reflectors[shot.other];
    // Along a ray to a ball, or, with its height left out, to a cylinder.
    const auto reach = [](const glm::dvec3& from, const glm::dvec3& to,
                          double radius) -> std::optional<double> {
        const double a = glm::dot(to, to), b = glm::dot(from, to), c = glm::dot(from, from) - radius * radius;
        if (!(b < 0) || !(b * b > a * c)) return {};
        return (-b - std::sqrt(b * b - a * c)) / a;
    };
    const glm::dvec3 centre(sphere.centre());
    const std::optional<double> first = reach(view.eye - centre, d, sphere.radius);
    if (!first) return false;
    const glm::dvec3 at = view.eye + *first * d, n = glm::normalize(at - centre);
    const glm::dvec3 r = d - 2.0 * glm::dot(d, n) * n;
    if (other.shape == city::StandingReflector::Shape::sphere)
        return reach(at - shot.foot - glm::dvec3(0, 0, other.radius), r, other.radius).has_value();
    const glm::dvec3 off = at - shot.foot, flat(1, 1, 0);
    const std::optional<double> second = reach(off * flat, r * flat, other.radius);
    if (!second) return false;
    const double height = off.z + *second * r.z;
    return height > 0 && height < other.height;
}

void parkBeside(FrameScene& frame, const Scene& scene, std::uint32_t reflector, double apart) {
    if (frame.vehicles.empty() || reflector >= scene.city.reflectors.size()) return;
    vehicles::VehiclePose& pose = frame.vehicles.front();
    if (stands(pose) || pose.model >= scene.models.size()) return;
    const city::StandingReflector& stone = scene.city.reflectors[reflector];
    const glm::dvec3 direction = towardsLane(scene.city, glm::dvec3(stone.centre()));
    const glm::dvec3 right = glm::cross(-direction, glm::dvec3(0, 0, 1));
    const double away = stone.radius + apart + 0.5 * scene.models[pose.model].width;
    pose.position = glm::dvec3(stone.foot) + away * right;
    pose.position.z = groundBelow(scene.city, pose.position);
    pose.heading = std::atan2(direction.y, direction.x);
    pose.pitch = 0;
    pose.speed = 0;
    pose.steering = 0;
}

vehicles::Traffic busyTraffic(const Scene& scene, std::uint64_t seed, std::uint32_t cars, double seconds) {
    const auto closeness = [&](const vehicles::Traffic& traffic) {
        double sum = 0;
        for (const city::StandingReflector& reflector : scene.city.reflectors)
            for (const vehicles::VehiclePose& pose : traffic.poses())
                sum += std::max(0.0, nearby - glm::length(pose.position - glm::dvec3(reflector.centre())));
        return sum;
    };
    vehicles::Traffic traffic = startTraffic(scene, seed, cars);
    double best = closeness(traffic);
    std::uint64_t steps = 0, bestSteps = 0;
    for (const double start = traffic.time(); traffic.size() > 0 && traffic.time() < start + seconds;) {
        traffic.step();
        ++steps;
        if (const double now = closeness(traffic); now > best) {
            best = now;
            bestSteps = steps;
        }
    }
    vehicles::Traffic again = startTraffic(scene, seed, cars);
    for (std::uint64_t i = 0; i < bestSteps; ++i) again.step();
    return again;
}

}  // namespace app
