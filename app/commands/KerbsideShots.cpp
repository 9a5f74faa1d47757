#include "app/commands/KerbsideShots.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <optional>

#include "app/frame/ChromePlan.h"
#include "app/frame/StagedVehicles.h"
#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

constexpr double fieldOfView = 60;  // degrees, as the tour's
constexpr double worthAView = 12;   // pixels of a part's width
constexpr double step = 1.0 / 60;   // seconds between the moments looked at

bool staged(const vehicles::VehiclePose& pose) {
    return pose.id >= firstStagedId && pose.id < firstStandingId;
}

/// A vehicle's box and places in its frame.
struct Box {
    glm::dvec3 low, high;
    glm::dmat3 turn;
    glm::dvec3 origin;

    Box(const vehicles::VehiclePose& pose, const vehicles::VehicleModel& model)
        : low(-0.5 * model.length, -0.5 * model.width, 0),
          high(0.5 * model.length, 0.5 * model.width, model.height),
          turn(worldFromVehicle(pose)),
          origin(pose.position) {}

    double distanceTo(const glm::dvec3& place) const {
        const glm::dvec3 p = (place - origin) * turn;
        return glm::length(glm::max(glm::max(low - p, p - high), glm::dvec3(0)));
    }
    bool between(const glm::dvec3& from, const glm::dvec3& to) const {
        const glm::dvec3 a = (from - origin) * turn, d = (to - origin) * turn - a;
        double enter = 0, leave = 1;
        for (int k = 0; k < 3; ++k) {
            if (d[k] == 0) {
                if (a[k] < low[k] || a[k] > high[k]) return false;
                continue;
            }
            const double s = (low[k] - a[k]) / d[k], t = (high[k] - a[k]) / d[k];
            enter = std::max(enter, std::min(s, t));
            leave = std::min(leave, std::max(s, t));
        }
        return enter <= leave;
    }
};

/// Is the vehicle's middle in the picture?
bool inPicture(const View& view, const vehicles::VehiclePose& pose, const vehicles::VehicleModel& model) {
    const glm::dvec3 middle = pose.position + glm::dvec3(0, 0, 0.5 * static_cast<double>(model.height));
    const glm::dvec4 clip =
        glm::dmat4(view.clipFromView) * glm::dmat4(view.viewFromWorld) * glm::dvec4(middle - view.eye, 1);
    return clip.w > 0 && std::abs(clip.x) < clip.w && std::abs(clip.y) < clip.w;
}

/// The largest piece of a staged vehicle's chrome in the frame's view.
std::optional<ChromeJob> largest(const FrameScene& frame, const Scene& scene, const ChromeParts& parts) {
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t i = 0; i < frame.vehicles.size(); ++i)
        if (staged(frame.vehicles[i]) && frame.vehicles[i].speed == 0) candidates.push_back(i);
    ChromePlanOptions options;
    options.leastPixels = worthAView;
    const ChromePlan plan = planChrome(frame, candidates, scene.models, parts, options);
    if (plan.jobs.empty()) return std::nullopt;
    return plan.jobs.front();
}

}  // namespace

void moveStaged(FrameScene& frame, const Scene& scene, double seconds) {
    const std::vector<vehicles::VehiclePose> poses = stagedPoses(scene.staged, settlingTime + seconds);
    for (vehicles::VehiclePose& pose : frame.vehicles)
        if (staged(pose))
            for (const vehicles::VehiclePose& now : poses)
                if (now.id == pose.id) pose = now;
}

std::vector<KerbsideShot> kerbsideShots(const Scene& scene, const ChromeParts& parts, const FrameScene& frame,
                                        glm::ivec2 resolution, double seconds) {
    std::vector<KerbsideShot> shots;
    std::optional<city::TourStop> last;
    for (const city::TourStop& stop : scene.city.tour) {
        // Each view is there twice: when it begins, and when it ends.
        if (last && last->eye == stop.eye && last->target == stop.target) continue;
        last = stop;
        KerbsideShot shot;
        shot.frame = frame;
        shot.frame.views = {
            lookAt(glm::dvec3(stop.eye), glm::dvec3(stop.target), glm::radians(fieldOfView), resolution)};
        moveStaged(shot.frame, scene, 0);
        const std::optional<ChromeJob> job = largest(shot.frame, scene, parts);
        if (!job) continue;
        shot.vehicle = job->vehicle;
        const vehicles::VehiclePose& own = shot.frame.vehicles[job->vehicle];
        const ChromePart& part = parts.of(own.model)[job->part];
        const glm::dvec3 middle(job->worldFromPart[3]);
        shot.pixels = job->pixels;
        shot.away = glm::length(middle - glm::dvec3(stop.eye));
        // What must be seen of it.
        std::vector<glm::dvec3> places;
        for (const city::Vertex& v : parts.meshOf(part).vertices)
            places.emplace_back(job->worldFromPart * glm::dvec4(glm::dvec3(v.position), 1));
        double best = std::numeric_limits<double>::infinity();
        for (double t = 0; t < seconds; t += step) {
            FrameScene moved;
            moved.vehicles = shot.frame.vehicles;
            moveStaged(moved, scene, t);
            for (const vehicles::VehiclePose& pose : moved.vehicles) {
                if (!staged(pose) || pose.speed == 0) continue;
                if (!inPicture(shot.frame.views.front(), pose, scene.models[pose.model])) continue;
                const Box box(pose, scene.models[pose.model]);
                const double apart = box.distanceTo(middle) + 1e-3 * glm::length(pose.position - middle);
                if (apart >= best) continue;
                if (std::ranges::any_of(places,
                                        [&](const glm::dvec3& p) { return box.between(stop.eye, p); }))
                    continue;
                best = apart;
                shot.seconds = t;
                shot.apart = box.distanceTo(middle);
            }
        }
        moveStaged(shot.frame, scene, shot.seconds);
        shot.name = scene.models[own.model].name + (job->wheel == ChromeJob::noWheel ? ", body" : ", wheel") +
                    ", view " + std::to_string(shots.size() + 1);
        shots.push_back(std::move(shot));
    }
    return shots;
}

}  // namespace app
