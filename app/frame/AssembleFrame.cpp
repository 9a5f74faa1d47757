#include "app/frame/AssembleFrame.h"

#include <utility>

#include "app/frame/StandingReflectors.h"

namespace app {

FrameScene assembleFrame(const city::CityModel& city, const vehicles::Traffic& traffic,
                         const Lighting& lighting, std::vector<View> views,
                         std::span<const StagedVehicle> staged) {
    FrameScene scene;
    scene.time = traffic.time();
    scene.views = std::move(views);
    scene.vehicles.assign(traffic.poses().begin(), traffic.poses().end());
    const std::vector<vehicles::VehiclePose> put = stagedPoses(staged, scene.time);
    scene.vehicles.insert(scene.vehicles.end(), put.begin(), put.end());
    const std::vector<vehicles::VehiclePose> standing =
        standingPoses(city, static_cast<std::uint32_t>(traffic.kindCount()));
    scene.vehicles.insert(scene.vehicles.end(), standing.begin(), standing.end());
    scene.signalColours.reserve(city.signalHeads.size());
    for (const city::SignalHead& head : city.signalHeads) {
        const bool known = head.junction < city.roads.junctions.size();
        scene.signalColours.push_back(known ? traffic.signal(head.junction, head.signalGroup)
                                            : vehicles::SignalColour::red);
    }
    scene.lighting = lighting;
    return scene;
}

FrameScene emptyFrame(const city::CityModel& city, const Lighting& lighting) {
    FrameScene frame;
    frame.lighting = lighting;
    frame.signalColours.assign(city.signalHeads.size(), vehicles::SignalColour::red);
    return frame;
}

}  // namespace app
