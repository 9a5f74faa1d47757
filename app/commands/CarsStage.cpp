#include "app/commands/CarsStage.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <iterator>
#include <map>

#include "app/frame/AssembleFrame.h"
#include "app/frame/StandingReflectors.h"

namespace app {

namespace {

constexpr double fieldOfView = 60;

/// A place to look down a street from, a bus driver's height above a lane.
struct Lookout {
    glm::dvec3 eye{0}, target{1, 0, 0};
};

std::vector<Lookout> lookouts(const city::CityModel& city) {
    std::vector<Lookout> found;
    for (const city::Lane& lane : city.roads.lanes) {
        if (lane.kind != city::LaneKind::car || laneLength(lane) < 60) continue;
        const glm::dvec3 a(lane.centreLine.front()), b(lane.centreLine.back());
        found.push_back({a + glm::dvec3(0, 0, 5), b + glm::dvec3(0, 0, 0.5)});
    }
    return found;
}

}  // namespace

CarsStage setCarsStage(const Scene& scene, SceneRenderer& renderer, std::uint32_t cars, std::uint64_t seed,
                       glm::ivec2 resolution) {
    CarsStage best;
    std::vector<Lookout> places = lookouts(scene.city);
    constexpr std::size_t placesTried = 6;
    const std::size_t stride = std::max<std::size_t>(1, places.size() / placesTried);
    for (std::size_t p = 0; p < places.size() && best.visible < cars; p += stride) {
        const View view = lookAt(places[p].eye, places[p].target, glm::radians(fieldOfView), resolution);
        for (const std::uint32_t wanted : {2 * cars, 4 * cars, 8 * cars}) {
            vehicles::TrafficOptions traffic;
            traffic.seed = seed;
            traffic.cars = wanted;
            const glm::dvec3 ahead = glm::normalize(places[p].target - places[p].eye);
            traffic.focus = vehicles::Focus{glm::vec3(places[p].eye + 60.0 * ahead), 400};
            vehicles::Traffic simulation(scene.city.roads, scene.kinds, traffic);
            for (int step = 0; step < 120; ++step) simulation.step();
            renderer.prepare(assembleFrame(scene.city, simulation, scene.lighting, {view}, scene.staged));
            std::size_t visible = 0;
            for (const auto& v : renderer.visibleVehicles(view)) visible += v.index < simulation.size();
            const bool full = simulation.size() < wanted;
            if (visible > best.visible) {
                best.view = view;
                best.visible = visible;
                best.traffic.emplace(std::move(simulation));
            }
            if (best.visible >= cars || full) break;
        }
    }
    return best;
}

std::vector<View> viewsDownStreets(const city::CityModel& city, glm::ivec2 resolution) {
    std::vector<View> views;
    for (const Lookout& place : lookouts(city))
        views.push_back(lookAt(place.eye, place.target, glm::radians(fieldOfView), resolution));
    return views;
}

std::vector<SeenVehicle> seenIn(const SceneRenderer& renderer, std::span<const View> views) {
    std::map<std::uint32_t, float> sizes;
    for (const View& view : views)
        for (const auto& v : renderer.visibleVehicles(view)) {
            float& size = sizes[v.index];
            size = std::max(size, v.diameterPixels);
        }
    std::vector<SeenVehicle> seen;
    for (const auto& [index, size] : sizes) seen.push_back({index, size});
    return seen;
}

void Cast::select(FrameScene& scene, const View& view, SceneRenderer& renderer) {
    renderer.prepare(scene);
    std::vector<SeenVehicle> seen = seenIn(renderer, std::span(&view, 1));
    std::erase_if(seen, [&](const SeenVehicle& v) { return stands(scene.vehicles[v.index]); });
    std::stable_sort(seen.begin(), seen.end(), [&](const SeenVehicle& a, const SeenVehicle& b) {
        const bool keptA = kept_.contains(scene.vehicles[a.index].id),
                   keptB = kept_.contains(scene.vehicles[b.index].id);
        return keptA != keptB ? keptA : a.diameterPixels > b.diameterPixels;
    });
    seen.resize(std::min<std::size_t>(seen.size(), count_));
    kept_.clear();
    std::vector<vehicles::VehiclePose> stay;
    for (const SeenVehicle& v : seen) {
        kept_.insert(scene.vehicles[v.index].id);
        stay.push_back(scene.vehicles[v.index]);
    }
    std::ranges::copy_if(scene.vehicles, std::back_inserter(stay), stands);
    scene.vehicles = std::move(stay);
}

}  // namespace app
