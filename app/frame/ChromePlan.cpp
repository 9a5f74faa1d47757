#include "app/frame/ChromePlan.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleLevels.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

/// A share reaches 1 where what it grows with is so many times what it begins at.
constexpr double full = 2;

/// A part shows at least what is within so many times its distance from its map's middle: there the map is
/// off.
constexpr double mapRadii = 3;

/// Of the size at which a part needs its reflector, from where on it is made in the background.
constexpr double madeFrom = 0.5;

double rise(double value, double from) {
    const double t = std::clamp((value / from - 1) / (full - 1), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

glm::dmat4 rigid(const glm::dmat3& turn, const glm::dvec3& origin) {
    return glm::dmat4(glm::dvec4(turn[0], 0), glm::dvec4(turn[1], 0), glm::dvec4(turn[2], 0),
                      glm::dvec4(origin, 1));
}

/// Half the sides of the box that a vehicle fills, and its middle in the vehicle's frame.
struct Body {
    glm::dvec3 half, middle;
};
Body bodyOf(const vehicles::VehicleModel& model) {
    const glm::dvec3 size(model.length, model.width, model.height);
    return {0.5 * size, glm::dvec3(0, 0, 0.5 * size.z)};
}

/// From a place to a vehicle's box, metres; 0 within it.
double distanceTo(const vehicles::VehiclePose& pose, const vehicles::VehicleModel& model,
                  const glm::dvec3& place) {
    const Body body = bodyOf(model);
    const glm::dvec3 local = (place - pose.position) * glm::dmat3(worldFromVehicle(pose)) - body.middle;
    return glm::length(glm::max(glm::abs(local) - body.half, glm::dvec3(0)));
}

/// Metres from a part to the middle of its vehicle's map, which is made around the model's.
double offItsMap(const ChromeJob& job, const vehicles::VehiclePose& pose,
                 const vehicles::VehicleModel& model) {
    const glm::dvec3 own =
        (glm::dvec3(job.worldFromPart[3]) - pose.position) * glm::dmat3(worldFromVehicle(pose));
    return std::max(glm::length(own - glm::dvec3(0, 0, model.reflectionCentre * model.height)), job.radius);
}

/// A part on a side of its vehicle's box is not seen from beyond the plane of that side.
bool behindItsVehicle(const glm::dvec3& part, double radius, const glm::dvec3& eye, const Body& body) {
    for (const int axis : {0, 1}) {
        const double at = part[axis] - body.middle[axis];
        if (std::abs(at) < 0.7 * body.half[axis]) continue;
        const double side = at > 0 ? 1 : -1;
        if (side * (eye[axis] - part[axis]) < -radius) return true;
    }
    return false;
}

}  // namespace

ChromeJob chromePartAt(std::span<const vehicles::VehiclePose> poses,
                       std::span<const vehicles::VehicleModel> models, const ChromePart& part,
                       std::uint32_t vehicle, std::uint32_t number, std::uint32_t wheel, double radii) {
    const vehicles::VehiclePose& pose = poses[vehicle];
    const vehicles::VehicleModel& model = models[pose.model];
    const glm::dmat3 turn(worldFromVehicle(pose));
    glm::dvec3 own(part.centre);
    glm::dmat3 vehicleFromPart(1);
    if (wheel != ChromeJob::noWheel) {
        vehicleFromPart = glm::dmat3(vehicleFromWheel(model.wheels[wheel], pose));
        own = glm::dvec3(model.wheels[wheel].centre) + vehicleFromPart * own;
    }
    ChromeJob job;
    job.name = {0, pose.id, number, wheel};
    job.vehicle = vehicle;
    job.part = number;
    job.wheel = wheel;
    job.radius = static_cast<double>(part.radius);
    job.worldFromPart = rigid(turn * vehicleFromPart, pose.position + turn * own);
    const double narrow = 0.5 * static_cast<double>(part.width);
    job.reach = std::max(radii * narrow + job.radius - narrow, mapRadii * offItsMap(job, pose, model));
    return job;
}

double closeTo(ChromeJob& job, std::span<const vehicles::VehiclePose> poses,
               std::span<const vehicles::VehicleModel> models) {
    double nearest = std::numeric_limits<double>::infinity();
    job.close.clear();
    for (std::uint32_t i = 0; i < poses.size(); ++i) {
        const vehicles::VehiclePose& other = poses[i];
        if (i == job.vehicle || other.model >= models.size()) continue;
        const double apart = distanceTo(other, models[other.model], glm::dvec3(job.worldFromPart[3]));
        if (apart >= job.reach) continue;
        job.close.push_back(i);
        nearest = std::min(nearest, std::max(apart, job.radius));
    }
    return nearest;
}

reflection::PixelRect pixelsOfBall(const glm::mat4& clipFromRelative, const glm::ivec2& size,
                                   const glm::vec3& centre, float radius) {
    if (glm::length(centre) <= 1.1f * radius) return {glm::ivec2(0), size};
    const glm::vec4 middle = clipFromRelative * glm::vec4(centre, 1);
    if (middle.w < -2 * radius) return {};
    city::Aabb box;
    box.extend(centre - radius);
    box.extend(centre + radius);
    return pixelsOfBox(clipFromRelative, size, box);
}

reflection::PixelRect pixelsOfBox(const glm::mat4& clipFromBox, const glm::ivec2& size,
                                  const city::Aabb& box) {
    if (box.empty()) return {};
    // Its eight corners; where one lies behind the eye, the whole image.
    glm::vec2 low(1e9f), high(-1e9f);
    int behind = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec4 clip = clipFromBox * glm::vec4((corner & 1) != 0 ? box.max.x : box.min.x,
                                                       (corner & 2) != 0 ? box.max.y : box.min.y,
                                                       (corner & 4) != 0 ? box.max.z : box.min.z, 1);
        if (!(clip.w > 0)) {
            ++behind;
            continue;
        }
        const glm::vec2 p = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(size);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (behind == 8) return {};
    if (behind > 0) return {glm::ivec2(0), size};
    const auto inside = [&](const glm::vec2& p) {
        return glm::ivec2(glm::clamp(p, glm::vec2(0), glm::vec2(size)));
    };
    return {inside(glm::floor(low)), inside(glm::ceil(high))};
}

float ChromeFades::shareOf(const ChromeName& name) const {
    const auto at = shares_.find(name);
    return at == shares_.end() ? 0 : at->second;
}

void ChromeFades::follow(ChromePlan& plan) {
    std::map<ChromeName, float> now;
    for (const ChromeName& name : plan.without) now[name] = 0;
    for (ChromeJob& job : plan.jobs) {
        const auto was = shares_.find(job.name);
        if (was != shares_.end()) job.share = std::clamp(job.share, was->second - step, was->second + step);
        now[job.name] = job.share;
    }
    std::erase_if(plan.jobs, [](const ChromeJob& job) { return !(job.share > 0); });
    shares_ = std::move(now);
}

ChromePlan planChrome(const FrameScene& scene, std::span<const std::uint32_t> seen,
                      std::span<const vehicles::VehicleModel> models, const ChromeParts& parts,
                      const ChromePlanOptions& options, const ChromeFades* before) {
    ChromePlan plan;
    if (!options.on || parts.empty()) return plan;
    const auto add = [&](std::uint32_t viewIndex, std::uint32_t index, std::uint32_t p, std::uint32_t wheel) {
        ++plan.parts;
        const View& view = scene.views[viewIndex];
        const vehicles::VehiclePose& pose = scene.vehicles[index];
        const vehicles::VehicleModel& model = models[pose.model];
        const ChromePart& part = parts.of(pose.model)[p];
        if (!(part.closed && part.convex)) {
            ++plan.open;
            return;
        }
        ChromeJob job = chromePartAt(scene.vehicles, models, part, index, p, wheel, options.closeRadii);
        job.name.view = viewIndex;
        job.view = viewIndex;
        const glm::dmat3 turn(worldFromVehicle(pose));
        const glm::dvec3 origin(job.worldFromPart[3]);
        const glm::dvec3 own = (origin - pose.position) * turn;

        const glm::mat4 clip = view.clipFromView * view.viewFromWorld;
        const glm::dvec3 towards = origin - view.eye;
        glm::dmat4 relativeFromPart = job.worldFromPart;
        relativeFromPart[3] = glm::dvec4(towards, 1);
        city::Aabb box;
        box.extend(-part.half);
        box.extend(part.half);
        if (pixelsOfBall(clip, view.size, glm::vec3(towards), part.radius).empty() ||
            pixelsOfBox(clip * glm::mat4(relativeFromPart), view.size, box).empty() ||
            (!stands(pose) &&
             behindItsVehicle(own, job.radius, (view.eye - pose.position) * turn, bodyOf(model)))) {
            ++plan.outOfSight;
            return;
        }
        const double distance = std::max(glm::length(towards), job.radius);
        const double perRadian = 0.5 * view.size.y * std::abs(static_cast<double>(view.clipFromView[1][1]));
        job.pixels = static_cast<double>(part.width) / distance * perRadian;
        // What stands has the ground below it, a vehicle's part its own vehicle, which the map does not show.
        const double off = offItsMap(job, pose, model);
        double nearest = stands(pose) ? std::max(origin.z - pose.position.z, job.radius) : job.radius;
        nearest = std::min(nearest, closeTo(job, scene.vehicles, models));
        const double shift = job.pixels * off / (std::numbers::pi * nearest);
        const double share =
            nearest >= job.reach ? 0 : rise(job.pixels, options.leastPixels) * rise(shift, options.shift);
        const bool early = job.pixels > madeFrom * options.leastPixels && nearest < job.reach;
        const bool isMade = options.wait || !early || parts.ready(part);
        if (nearest >= job.reach)
            ++plan.nothingClose;
        else if (!(share > 0))
            ++plan.tooSmall;
        else if (!isMade)
            ++plan.making;
        job.share = isMade ? static_cast<float>(share) : 0;
        if (job.share > 0 || (before != nullptr && before->shareOf(job.name) > 0))
            plan.jobs.push_back(std::move(job));
        else
            plan.without.push_back(job.name);
    };
    for (std::uint32_t v = 0; v < scene.views.size(); ++v)
        for (const std::uint32_t index : seen) {
            if (index >= scene.vehicles.size()) continue;
            if (!options.vehicles && !stands(scene.vehicles[index])) continue;
            const std::uint32_t model = scene.vehicles[index].model;
            if (model >= models.size()) continue;
            const std::span<const ChromePart> own = parts.of(model);
            for (std::uint32_t p = 0; p < own.size(); ++p) {
                if (!own[p].onWheel) add(v, index, p, ChromeJob::noWheel);
                for (std::uint32_t w = 0; own[p].onWheel && w < models[model].wheels.size(); ++w)
                    add(v, index, p, w);
            }
        }
    std::stable_sort(plan.jobs.begin(), plan.jobs.end(),
                     [](const ChromeJob& a, const ChromeJob& b) { return a.pixels > b.pixels; });
    const auto wanted = static_cast<std::size_t>(
        std::ranges::count_if(plan.jobs, [](const ChromeJob& job) { return job.share > 0; }));
    if (wanted > options.mostJobs) {
        // What is barely larger than the first that has no room is barely seen: places change unnoticed.
        std::size_t room = options.mostJobs;
        const auto first = std::ranges::find_if(
            plan.jobs, [&](const ChromeJob& job) { return job.share > 0 && room-- == 0; });
        const double limit = first->pixels;
        constexpr double lead = 0.25;
        for (ChromeJob& job : plan.jobs) {
            if (!(job.share > 0)) continue;
            job.share *= static_cast<float>(std::clamp((job.pixels / limit - 1) / lead, 0.0, 1.0));
            plan.leftOut += !(job.share > 0);
        }
        std::erase_if(plan.jobs, [&](const ChromeJob& job) {
            if (job.share > 0 || (before != nullptr && before->shareOf(job.name) > 0)) return false;
            plan.without.push_back(job.name);
            return true;
        });
    }
    return plan;
}

}  // namespace app
