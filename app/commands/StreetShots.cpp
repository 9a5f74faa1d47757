#include "app/commands/StreetShots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "app/commands/FacingFronts.h"

namespace app {

namespace {

constexpr double eyeHeight = 1.6;   ///< metres: somebody who stands in the street
constexpr double shade = 0.3;       ///< light on what the sun does not reach, against what it does
constexpr double clearCoat = 0.04;  ///< mirrored by paint at normal incidence
constexpr glm::vec3 lightPaint{0.75f, 0.74f, 0.7f};  // seen in glass, which mirrors little
constexpr glm::vec3 darkPaint{0.008f, 0.009f, 0.012f};

/// Ray parameter at which a ray meets something of the city.
double traced(const reflection::TriangleTracer& triangles, const glm::dvec3& from, const glm::dvec3& way) {
    std::array<float, 1> x{static_cast<float>(way.x)}, y{static_cast<float>(way.y)},
        z{static_cast<float>(way.z)}, t{0};
    triangles.traceFan(glm::vec3(from), x, y, z, t);
    return static_cast<double>(t[0]);
}

bool clear(const reflection::TriangleTracer& triangles, const glm::dvec3& from, const glm::dvec3& to) {
    return traced(triangles, from, to - from) > 0.97;
}

/// Share of a front that the sun reaches, by a few places on it.
double sunOn(const city::GlassFront& front, const glm::dvec3& sun,
             const reflection::TriangleTracer& triangles) {
    if (glm::dot(front.normal, sun) <= 0.05) return 0;
    constexpr int places = 6;
    int lit = 0;
    for (int i = 0; i < places; ++i) {
        const double s = (i + 0.5) / places;
        const glm::dvec3 at = front.outline[0] + s * (front.outline[1] - front.outline[0]) +
                              0.5 * (front.outline[3] - front.outline[0]) + 0.1 * front.normal;
        lit += std::isinf(traced(triangles, at, sun)) ? 1 : 0;
    }
    return static_cast<double>(lit) / places;
}

double lightOn(const city::GlassFront& front, const glm::dvec3& sun,
               const reflection::TriangleTracer& triangles) {
    return shade + (1 - shade) * sunOn(front, sun, triangles);
}

/// Of the frames of a front's panes: what dark glass and dark paint show best.
double brightness(const city::CityModel& city, const city::GlassFront& front) {
    if (front.panes.vertices.empty()) return 0;
    const glm::vec3& tint = city.materials[front.panes.vertices.front().material].tint;
    return static_cast<double>(glm::dot(tint, glm::vec3(0.21f, 0.72f, 0.07f)));
}

/// A place on a lane for a car.
struct Stand {
    glm::dvec3 position{0}, forward{1, 0, 0};
    std::uint32_t lane = 0;
};

std::vector<Stand> stands(const city::RoadNetwork& roads, double step) {
    std::vector<Stand> found;
    for (std::uint32_t l = 0; l < roads.lanes.size(); ++l) {
        const city::Lane& lane = roads.lanes[l];
        if (lane.kind != city::LaneKind::car) continue;
        for (std::size_t i = 0; i + 1 < lane.centreLine.size(); ++i) {
            const glm::dvec3 a(lane.centreLine[i]), b(lane.centreLine[i + 1]);
            const double length = glm::length(b - a);
            const int pieces = std::max(1, static_cast<int>(length / step));
            for (int p = 0; p < pieces; ++p)
                found.push_back({a + (b - a) * ((p + 0.5) / pieces), (b - a) / length, l});
        }
    }
    return found;
}

vehicles::VehiclePose poseAt(const Stand& stand, std::uint32_t id, std::uint32_t model) {
    vehicles::VehiclePose pose;
    pose.id = id;
    pose.model = model;
    pose.position = stand.position;
    pose.heading = std::atan2(stand.forward.y, stand.forward.x);
    pose.pitch = std::asin(std::clamp(stand.forward.z, -1.0, 1.0));
    return pose;
}

/// The box around a vehicle, standing level.
struct VehicleBox {
    glm::dvec3 position{0}, forward{1, 0, 0}, left{0, 1, 0};
    double length = 4.5, width = 1.8, height = 1.5;

    VehicleBox(const vehicles::VehiclePose& pose, const vehicles::VehicleModel& model)
        : position(pose.position),
          forward(std::cos(pose.heading), std::sin(pose.heading), 0),
          left(-forward.y, forward.x, 0),
          length(model.length),
          width(model.width),
          height(model.height) {}

    /// Ray parameter where a ray enters, infinity where it does not.
    double meets(const glm::dvec3& origin, const glm::dvec3& way) const {
        const glm::dvec3 from = origin - position;
        const std::array<double, 3> o{glm::dot(from, forward), glm::dot(from, left), from.z - 0.5 * height};
        const std::array<double, 3> d{glm::dot(way, forward), glm::dot(way, left), way.z};
        const std::array<double, 3> half{0.5 * length, 0.5 * width, 0.5 * height};
        double enter = 0, leave = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
            if (d[k] == 0) {
                if (std::abs(o[k]) > half[k]) return std::numeric_limits<double>::infinity();
                continue;
            }
            const double a = (-half[k] - o[k]) / d[k], b = (half[k] - o[k]) / d[k];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave ? enter : std::numeric_limits<double>::infinity();
    }
};

/// The frame's vehicles without those that the car would touch or that stand before the eye, and the car.
std::vector<vehicles::VehiclePose> withCar(const Scene& scene, const FrameScene& frame,
                                           const vehicles::VehiclePose& car, const glm::dvec3& eye,
                                           double eyeRoom) {
    std::vector<vehicles::VehiclePose> stay;
    const double length = scene.models[car.model].length;
    for (const vehicles::VehiclePose& v : frame.vehicles) {
        const double half = 0.5 * (length + static_cast<double>(scene.models[v.model].length));
        const glm::dvec3 d = v.position - car.position;
        const glm::dvec3 forward(std::cos(car.heading), std::sin(car.heading), 0);
        const bool touches =
            glm::length(d) < half + 1.5 && std::abs(glm::dot(d, glm::dvec3(-forward.y, forward.x, 0))) < 2.3;
        if (!touches && glm::length(v.position - eye) > eyeRoom + half) stay.push_back(v);
    }
    stay.push_back(car);
    return stay;
}

/// A saloon where the scene has one.
std::uint32_t carModel(const Scene& scene) {
    return scene.models.size() > 1 ? 1 : 0;
}

std::uint32_t newId(const FrameScene& frame) {
    std::uint32_t id = 0;
    for (const vehicles::VehiclePose& v : frame.vehicles) id = std::max(id, v.id + 1);
    return id;
}

/// What rays through a coarse grid over a picture find.
struct Shares {
    double mirrorsOne = 0;    ///< glass of `one` in which `other` is to be seen
    double mirrorsOther = 0;  ///< and the other way round
    double car = 0;
    double carMirrored = 0;  ///< glass of either that shows the car
};

struct Shops {
    const city::GlassFront& one;
    const city::GlassFront& other;
    double lightOne, lightOther;
};

Shares sharesOf(const Shops& shops, const VehicleBox& car, const reflection::TriangleTracer& triangles,
                const glm::dvec3& eye, const glm::dvec3& target, double fieldOfView, glm::ivec2 size) {
    constexpr int columns = 32, rows = 18, count = columns * rows;
    const glm::dvec3 ahead = glm::normalize(target - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 0, 1)));
    const glm::dvec3 up = glm::cross(right, ahead);
    const double tall = std::tan(0.5 * fieldOfView), wide = tall * size.x / size.y;
    std::array<float, count> x{}, y{}, z{}, t{};
    for (int i = 0; i < count; ++i) {
        const double u = (i % columns + 0.5) * 2 / columns - 1, v = (i / columns + 0.5) * 2 / rows - 1;
        const glm::vec3 way(ahead + u * wide * right + v * tall * up);
        const auto k = static_cast<std::size_t>(i);
        x[k] = way.x, y[k] = way.y, z[k] = way.z;
    }
    triangles.traceFan(glm::vec3(eye), x, y, z, t);
    Shares shares;
    // What glass of `here` shows of `there`, or of the car, on this ray, as light.
    const auto show = [&](const city::GlassFront& here, const city::GlassFront& there, double light,
                          const glm::dvec3& way, double reached, double& share) {
        const auto hit = meetFront(here, eye, way);
        if (!hit || std::abs(hit->way - reached) > 0.02 * reached + 0.2 / glm::length(way)) return;
        const glm::dvec3 start = hit->at + 0.1 * here.normal;
        const double free = traced(triangles, start, hit->mirror);
        const double mirrored = schlick(static_cast<double>(here.glass.reflectance), hit->cosine) / count;
        const auto far = meetFront(there, start, hit->mirror);
        if (car.meets(start, hit->mirror) < free)
            shares.carMirrored += mirrored;
        else if (far && free > 0.97 * far->way)
            share += light * mirrored;
    };
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const glm::dvec3 way(x[k], y[k], z[k]);
        const double reached = static_cast<double>(t[k]);
        if (car.meets(eye, way) < reached) {
            shares.car += 1.0 / count;
            continue;
        }
        show(shops.one, shops.other, shops.lightOther, way, reached, shares.mirrorsOne);
        show(shops.other, shops.one, shops.lightOne, way, reached, shares.mirrorsOther);
    }
    return shares;
}

}  // namespace

std::optional<StreetShot> betweenShops(const Scene& scene, const FrameScene& frame,
                                       const reflection::TriangleTracer& triangles, glm::ivec2 size) {
    constexpr double fieldOfView = glm::radians(62.0);
    constexpr std::size_t mostPairs = 48;
    constexpr double enoughMirrored = 0.001;  ///< of the picture, as light
    constexpr double enoughCar = 0.08, leastCar = 0.02, mostCar = 0.2;
    const glm::dvec3 sun(frame.lighting.sunDirection);
    const std::vector<Stand> lanes = stands(scene.city.roads, 2);
    const std::uint32_t model = carModel(scene);
    std::optional<StreetShot> best;
    double bestScore = 0;
    std::size_t pairs = 0;
    for (const FacingFronts& pair : facingFronts(scene.glass.fronts)) {
        const city::GlassFront& one = scene.glass.fronts[pair.one];
        const city::GlassFront& other = scene.glass.fronts[pair.other];
        const glm::dvec3 along = glm::normalize(one.outline[1] - one.outline[0]);
        // On each lane between them the place nearest to the middle of what is faced.
        std::vector<Stand> between;
        std::vector<double> off;
        for (const Stand& stand : lanes) {
            const glm::dvec3 from = stand.position - one.outline[0];
            const double before = glm::dot(from, one.normal), at = glm::dot(from, along);
            if (before < 2 || before > pair.across - 2 || at < pair.from || at > pair.to ||
                std::abs(from.z) > 2.5 || std::abs(glm::dot(stand.forward, along)) < 0.95)
                continue;
            const double distance = std::abs(at - 0.5 * (pair.from + pair.to));
            if (!between.empty() && between.back().lane == stand.lane) {
                if (distance < off.back()) between.back() = stand, off.back() = distance;
                continue;
            }
            between.push_back(stand);
            off.push_back(distance);
        }
        if (between.empty()) continue;
        const glm::dvec3 middle = one.outline[0] + 0.5 * (pair.from + pair.to) * along +
                                  glm::dvec3(0, 0, one.outline[2].z - one.outline[0].z) + 0.1 * one.normal;
        if (!clear(triangles, middle, middle + (pair.across - 0.2) * one.normal)) continue;
        if (++pairs > mostPairs) break;
        const Shops shops{one, other, lightOn(one, sun, triangles), lightOn(other, sun, triangles)};
        for (const Stand& stand : between) {
            vehicles::VehiclePose pose = poseAt(stand, newId(frame), model);
            pose.paint = lightPaint;
            const VehicleBox car(pose, scene.models[model]);
            const double at = glm::dot(stand.position - one.outline[0], along);
            for (const double d : {1.3, 2.2, 3.5, 5.0})
                for (const double back : {-12.0, -9.5, -7.5, -6.0, 6.0, 7.5, 9.5, 12.0}) {
                    if (d > pair.across - 2) continue;
                    glm::dvec3 eye = one.outline[0] + (at + back) * along + d * one.normal;
                    eye.z = stand.position.z + eyeHeight;
                    if (!clear(triangles, eye, stand.position + glm::dvec3(0, 0, 1.2))) continue;
                    for (const double turn : {-20.0, -8.0, 4.0, 16.0, 28.0}) {
                        const double angle = glm::radians(turn);
                        const glm::dvec3 target =
                            eye - std::copysign(std::cos(angle), back) * along - std::sin(angle) * one.normal;
                        const Shares shares = sharesOf(shops, car, triangles, eye, target, fieldOfView, size);
                        if (shares.car < leastCar || shares.car > mostCar) continue;
                        const double score =
                            shares.mirrorsOne * shares.mirrorsOther * std::min(shares.car, enoughCar) *
                            (0.6 * enoughMirrored + std::min(shares.carMirrored, enoughMirrored));
                        if (score <= bestScore) continue;
                        bestScore = score;
                        best = StreetShot{lookAt(eye, target, fieldOfView, size),
                                          withCar(scene, frame, pose, eye, 3)};
                    }
                }
        }
    }
    return best;
}

namespace {

/// A piece of a door: of the vehicle's frame.
struct DoorPiece {
    glm::dvec3 at{0}, normal{0, 1, 0};
    double area = 0;
};

/// The paint of the left side between the wheels, below the windows.
std::vector<DoorPiece> doorOf(const vehicles::VehicleModel& model) {
    std::vector<DoorPiece> pieces;
    if (model.levels.empty()) return pieces;
    const city::Mesh& mesh = model.levels.front().body;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const city::Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                           &c = mesh.vertices[mesh.indices[i + 2]];
        if (a.material != static_cast<std::uint32_t>(vehicles::Surface::paint)) continue;
        DoorPiece piece;
        piece.at = glm::dvec3(a.position + b.position + c.position) / 3.0;
        if (std::abs(piece.at.x) > 0.2 * static_cast<double>(model.length) ||
            piece.at.z < 0.25 * static_cast<double>(model.height) ||
            piece.at.z > 0.62 * static_cast<double>(model.height))
            continue;
        const glm::dvec3 sum(a.normal + b.normal + c.normal);
        const double length = glm::length(sum);
        if (!(length > 0) || sum.y < 0.8 * length) continue;
        piece.normal = sum / length;
        piece.area =
            0.5 * glm::length(glm::dvec3(glm::cross(b.position - a.position, c.position - a.position)));
        pieces.push_back(piece);
    }
    return pieces;
}

}  // namespace

std::optional<StreetShot> windowInDoor(const Scene& scene, const FrameScene& frame,
                                       const reflection::TriangleTracer& triangles, glm::ivec2 size) {
    constexpr double fieldOfView = glm::radians(40.0);
    constexpr double nearest = 3.2, farthest = 16;  ///< metres from the glass to the lane's middle
    constexpr double enough = 0.6;  ///< share of the door: something beside the window is to be seen too
    const std::uint32_t model = carModel(scene);
    const std::vector<DoorPiece> door = doorOf(scene.models[model]);
    const glm::dvec3 sun(frame.lighting.sunDirection);
    const std::vector<Stand> lanes = stands(scene.city.roads, 2.5);
    std::optional<StreetShot> best;
    double bestScore = 0;
    for (const city::GlassFront& front : scene.glass.fronts) {
        if (front.pattern != city::Pattern::shopFront) continue;
        const double width = glm::length(front.outline[1] - front.outline[0]);
        const glm::dvec3 along = glm::normalize(front.outline[1] - front.outline[0]);
        double light = 0;
        for (const Stand& stand : lanes) {
            const glm::dvec3 from = stand.position - front.outline[0];
            const double before = glm::dot(from, front.normal), at = glm::dot(from, along);
            if (before < nearest || before > farthest || at < -8 || at > width + 8 ||
                std::abs(from.z) > 2.5 || std::abs(glm::dot(stand.forward, along)) < 0.97)
                continue;
            if (light == 0) light = brightness(scene.city, front) * lightOn(front, sun, triangles);
            vehicles::VehiclePose pose = poseAt(stand, newId(frame), model);
            pose.paint = darkPaint;
            const glm::dvec3 forward(std::cos(pose.heading), std::sin(pose.heading), 0);
            // The side that the shop sees; the body is the same on both.
            const glm::dvec3 left(-forward.y, forward.x, 0);
            const double side = glm::dot(left, front.normal) < 0 ? 1 : -1;
            const glm::dvec3 outwards = side * left;
            const double half = 0.5 * static_cast<double>(scene.models[model].width);
            const glm::dvec3 middle = stand.position + half * outwards + glm::dvec3(0, 0, 0.68);
            for (const double away : {2.0, 2.6})
                for (const double turn : {-40.0, -30.0, -20.0, -10.0, 10.0, 20.0, 30.0, 40.0})
                    for (const double height : {0.9, 1.2}) {
                        const double angle = glm::radians(turn);
                        glm::dvec3 eye =
                            middle + away * (std::cos(angle) * outwards + std::sin(angle) * forward);
                        eye.z = stand.position.z + height;
                        if (glm::dot(eye - front.outline[0], front.normal) < 0.6) continue;
                        double seen = 0, shown = 0, mirrored = 0;
                        for (const DoorPiece& piece : door) {
                            const auto world = [&](const glm::dvec3& v) {
                                return v.x * forward + side * v.y * left + glm::dvec3(0, 0, v.z);
                            };
                            const glm::dvec3 place = stand.position + world(piece.at),
                                             n = world(piece.normal);
                            const glm::dvec3 way = place - eye;
                            const double distance = glm::length(way), cosine = -glm::dot(way, n) / distance;
                            if (cosine <= 0) continue;
                            const double solid = piece.area * cosine / (distance * distance);
                            seen += solid;
                            const auto hit = meetFront(front, place, mirroredBy(n, way));
                            if (!hit) continue;
                            shown += solid;
                            mirrored += solid * schlick(clearCoat, cosine);
                        }
                        if (!(shown > 0)) continue;
                        const double score = light * mirrored * std::min(1.0, enough * seen / shown);
                        if (score <= bestScore || !clear(triangles, eye, middle + 0.1 * outwards) ||
                            !clear(triangles, middle + 0.1 * outwards,
                                   middle + (before - half - 0.3) * outwards + glm::dvec3(0, 0, 1)))
                            continue;
                        bestScore = score;
                        best = StreetShot{lookAt(eye, middle, fieldOfView, size),
                                          withCar(scene, frame, pose, eye, 2)};
                    }
        }
    }
    return best;
}

}  // namespace app
