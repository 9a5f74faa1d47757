#include "app/frame/ReflectionPlan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "app/frame/StandingReflectors.h"

namespace app {

namespace {

/// Half the width of a city street between facades, metres: what r in the error estimate stands for.
constexpr double streetHalfWidth = 8;
/// Neighbours farther than this do not fill enough of a map to count.
constexpr double neighbourRange = 15;
/// Farther vehicles are blots even in the finest map of what stands, metres (see
/// ReflectionEngine::gatherNeighbours).
constexpr double standingRange = 45;
/// Frames a map outlives its vehicle's last sight: a car behind a tree or a tour's cut back keeps its map for
/// a second.
constexpr std::uint64_t framesKept = 60;
/// Vehicles no farther apart than this see the same facades, more or less, metres: the length of a building.
constexpr double sameStreet = 30;
/// Centres of two vehicles are no nearer to each other than this, metres: the width of a car.
constexpr double nearestNeighbour = 1.7;

/// Pixels by which a reflected feature is off where the map's centre is off by so many metres.
double errorOnScreen(float diameterPixels, double metres) {
    return static_cast<double>(diameterPixels) * metres / (3.14159265 * streetHalfWidth);
}

constexpr int sizeClasses = static_cast<int>(reflection::localMapFaceSizes.size());

std::uint64_t texelsOf(int sizeClass) {
    const auto side =
        static_cast<std::uint64_t>(reflection::localMapFaceSizes[static_cast<std::size_t>(sizeClass)]);
    return 6 * side * side;
}

}  // namespace

int sizeClassFor(float diameterPixels, float texelsPerPixel, int held) {
    const auto wanted = [texelsPerPixel](float pixels) {
        int c = sizeClasses - 1;
        while (c > 0 && static_cast<float>(reflection::localMapFaceSizes[static_cast<std::size_t>(c)]) <
                            pixels * texelsPerPixel)
            --c;
        return c;
    };
    const int now = wanted(diameterPixels);
    if (held < 0 || now == held) return now;
    // Finer at once when clearly needed, coarser only when clearly not.
    return now < held ? std::min(held, wanted(diameterPixels / 1.2f))
                      : std::max(held, wanted(diameterPixels * 1.2f));
}

void ReflectionPlanner::reset() {
    held_.clear();
    for (std::size_t c = 0; c < free_.size(); ++c) free_[c].clear();
    std::fill(layers_.begin(), layers_.end(), 0);
}

int ReflectionPlanner::classWithRoom(int wanted, int layersAtMost, std::uint64_t texels) const {
    const auto hasRoom = [&](int c) {
        const auto k = static_cast<std::size_t>(c);
        return !free_[k].empty() || layers_[k] < layersAtMost;
    };
    for (int c = wanted; c < sizeClasses; ++c)
        if (hasRoom(c)) return c;
    for (int c = wanted - 1; c >= 0 && texelsOf(c) <= texels; --c)
        if (hasRoom(c)) return c;
    return -1;
}

reflection::LocalMapSlot ReflectionPlanner::allocate(int sizeClass) {
    auto& free = free_[static_cast<std::size_t>(sizeClass)];
    reflection::LocalMapSlot slot;
    slot.sizeClass = static_cast<std::int16_t>(sizeClass);
    if (free.empty()) {
        slot.layer = static_cast<std::int16_t>(layers_[static_cast<std::size_t>(sizeClass)]++);
    } else {
        slot.layer = free.back();
        free.pop_back();
    }
    return slot;
}

void ReflectionPlanner::release(reflection::LocalMapSlot slot) {
    if (slot.valid()) free_[static_cast<std::size_t>(slot.sizeClass)].push_back(slot.layer);
}

const ReflectionPlanner::Held* ReflectionPlanner::lenderFor(const MapJob& job, float diameterPixels,
                                                            float threshold,
                                                            std::span<const Held* const> lenders) {
    if (errorOnScreen(diameterPixels, nearestNeighbour) >= threshold) return nullptr;
    const Held* best = nullptr;
    double least = threshold;
    for (const Held* lender : lenders) {
        if (lender->slot.sizeClass > job.slot.sizeClass) continue;  // coarser than wanted
        const double error = errorOnScreen(
            diameterPixels, glm::distance(lender->centre, job.centre) + lender->neighbourMotion);
        if (error < least) {
            least = error;
            best = lender;
        }
    }
    return best;
}

const ReflectionPlanner::Held* ReflectionPlanner::nearestOf(std::span<const Held* const> lenders,
                                                            const glm::dvec3& centre) {
    const Held* best = nullptr;
    double least = sameStreet;
    for (const Held* lender : lenders)
        if (const double apart = glm::distance(lender->centre, centre); apart < least) {
            least = apart;
            best = lender;
        }
    return best;
}

ReflectionPlan ReflectionPlanner::plan(const FrameScene& scene, std::span<const SeenVehicle> seen,
                                       std::span<const float> centreHeights, const PlanOptions& options) {
    ++frame_;
    const double elapsed = std::clamp(scene.time - lastTime_, 0.0, 1.0);
    lastTime_ = scene.time;
    ReflectionPlan plan;
    plan.slots.resize(scene.vehicles.size());
    plan.visible = static_cast<std::uint32_t>(seen.size());

    std::vector<MapJob> wanted;
    std::vector<float> diameters(scene.vehicles.size(), 0.0f);
    std::vector<const Held*> lenders;  // with maps that are good this frame
    for (const SeenVehicle& vehicle : seen) {
        diameters[vehicle.index] = vehicle.diameterPixels;
        const vehicles::VehiclePose& pose = scene.vehicles[vehicle.index];
        Held& map = held_[pose.id];
        map.lastSeen = frame_;
        const int sizeClass =
            options.sizeClass >= 0
                ? std::min(options.sizeClass, static_cast<int>(reflection::localMapFaceSizes.size()) - 1)
                : sizeClassFor(vehicle.diameterPixels, options.texelsPerPixel, map.slot.sizeClass);
        const glm::dvec3 centre =
            pose.position +
            glm::dvec3(0, 0, pose.model < centreHeights.size() ? centreHeights[pose.model] : 0.8f);

        double pixels = std::numeric_limits<double>::infinity();
        if (map.built) {
            const double moved = options.ownMotion * glm::distance(centre, map.centre) + map.neighbourMotion;
            pixels = errorOnScreen(vehicle.diameterPixels, moved);
            // A map of the wrong detail is replaced when its turn comes; until then the old one is shown.
            if (sizeClass != map.slot.sizeClass)
                pixels += vehicle.diameterPixels /
                          static_cast<float>(
                              reflection::localMapFaceSizes[static_cast<std::size_t>(map.slot.sizeClass)]);
        }
        if (options.mapsInTurn > 0 && map.built)
            pixels = static_cast<double>(frame_ - map.lastBuilt);  // its age stands for its error
        else if (map.built && !options.everyFrame && pixels < options.errorThreshold) {
            ++plan.fresh;
            lenders.push_back(&map);
            continue;
        }
        MapJob job;
        job.vehicle = vehicle.index;
        job.slot.sizeClass = static_cast<std::int16_t>(sizeClass);
        job.centre = centre;
        job.error = static_cast<float>(pixels);
        wanted.push_back(job);
    }

    // New maps first, then by error; larger vehicles (finer maps) and ids decide ties so that the order is
    // always the same.
    std::sort(wanted.begin(), wanted.end(), [&](const MapJob& a, const MapJob& b) {
        if (a.error != b.error) return a.error > b.error;
        if (a.slot.sizeClass != b.slot.sizeClass) return a.slot.sizeClass < b.slot.sizeClass;
        return scene.vehicles[a.vehicle].id < scene.vehicles[b.vehicle].id;
    });
    std::uint32_t inTurn = 0;
    for (MapJob& job : wanted) {
        Held& map = held_[scene.vehicles[job.vehicle].id];
        if (options.mapsInTurn > 0) {
            if (map.built && inTurn++ >= options.mapsInTurn) {
                ++plan.postponed;
                continue;
            }
        } else if (options.share && !options.everyFrame) {
            const Held* lender = lenderFor(job, diameters[job.vehicle], options.errorThreshold, lenders);
            if (lender != nullptr) {
                release(map.slot);
                map.slot = {};
                map.built = false;
                plan.slots[job.vehicle] = lender->slot;
                ++plan.shared;
                continue;
            }
        }
        const std::uint64_t cost = texelsOf(job.slot.sizeClass);
        const bool affordable = plan.jobs.empty() || plan.texels + cost <= options.texelBudget ||
                                options.everyFrame || options.mapsInTurn > 0;
        if (!affordable && map.built) {
            ++plan.postponed;
            continue;
        }
        if (!affordable && options.share) {
            // A vehicle must not appear without a reflection: a neighbour's map now, its own when its turn
            // comes. When many appear at once, this costs nothing.
            if (const Held* lender = nearestOf(lenders, job.centre); lender != nullptr) {
                plan.slots[job.vehicle] = lender->slot;
                ++plan.borrowed;
                ++plan.postponed;
                continue;
            }
        }
        if (!affordable && job.slot.sizeClass + 1 < sizeClasses) {
            // Where nobody is near, a coarse map of its own.
            job.slot.sizeClass = static_cast<std::int16_t>(sizeClasses - 2);
        }
        if (map.slot.sizeClass != job.slot.sizeClass) {
            const std::uint64_t left =
                options.texelBudget > plan.texels ? options.texelBudget - plan.texels : 0;
            const int room = classWithRoom(job.slot.sizeClass, options.layersAtMost, left);
            if (room < 0) {
                ++(map.built ? plan.postponed : plan.crowdedOut);
                continue;
            }
            release(map.slot);
            map.slot = allocate(room);
        }
        job.slot = map.slot;
        map.centre = job.centre;
        map.neighbourMotion = 0;
        map.lastBuilt = frame_;
        map.built = true;
        lenders.push_back(&map);
        plan.texels += texelsOf(job.slot.sizeClass);
        plan.jobs.push_back(job);
    }

    for (const SeenVehicle& vehicle : seen)
        if (const Held& map = held_[scene.vehicles[vehicle.index].id]; map.built)
            plan.slots[vehicle.index] = map.slot;

    countMotion(scene, elapsed);
    for (auto it = held_.begin(); it != held_.end();) {
        if (it->second.lastSeen + framesKept < frame_) {
            release(it->second.slot);
            it = held_.erase(it);
        } else {
            ++it;
        }
    }
    return plan;
}

/// How far the neighbours moved since the last frame, for maps out of sight as well: they may be shown again.
/// A vehicle passing at distance r changes about (size / r)^2 of the map. Of what stands nothing else ever
/// changes, it is looked at from near by, and its map is cheap to bring up to date: there the vehicle's own
/// shift counts, as that of something at r, by the share size / r of the mirror's width that it takes.
void ReflectionPlanner::countMotion(const FrameScene& scene, double elapsed) {
    // By x, so that of a great many vehicles each map looks only at those in a strip around it.
    std::vector<const vehicles::VehiclePose*> moving;
    for (const vehicles::VehiclePose& pose : scene.vehicles)
        if (pose.speed != 0) moving.push_back(&pose);
    std::sort(moving.begin(), moving.end(),
              [](const auto* a, const auto* b) { return a->position.x < b->position.x; });
    for (const vehicles::VehiclePose& own : scene.vehicles) {
        const auto map = held_.find(own.id);
        if (map == held_.end() || !map->second.built) continue;
        double motion = 0;
        const bool standing = stands(own);
        const double range = standing ? standingRange : neighbourRange;
        const auto first = std::lower_bound(
            moving.begin(), moving.end(), own.position.x - range,
            [](const vehicles::VehiclePose* pose, double x) { return pose->position.x < x; });
        for (auto it = first; it != moving.end(); ++it) {
            const vehicles::VehiclePose& other = **it;
            if (other.position.x > own.position.x + range) break;
            if (other.id == own.id) continue;
            const glm::dvec3 apart = other.position - own.position;
            const double squared = glm::dot(apart, apart);
            if (squared > range * range) continue;
            if (standing) {
                constexpr double vehicleLength = 4;
                const double away = std::max(std::sqrt(squared), 1.0);
                motion = std::max(motion, other.speed * elapsed * streetHalfWidth / away *
                                              std::min(1.0, vehicleLength / away));
                continue;
            }
            constexpr double vehicleSize = 2;
            motion = std::max(motion, other.speed * elapsed *
                                          std::min(1.0, vehicleSize * vehicleSize / std::max(squared, 1.0)));
        }
        map->second.neighbourMotion += motion;
    }
}

}  // namespace app
