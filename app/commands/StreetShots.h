#pragma once

#include <optional>
#include <vector>

#include "app/commands/LoadScene.h"
#include "app/frame/FrameScene.h"
#include "reflection/truth/TriangleTracer.h"

namespace app {

/// A view of a street with one car set down in it for the picture; whoever was in its way or in the eye's is
/// gone.
struct StreetShot {
    View view;
    std::vector<vehicles::VehiclePose> vehicles;  ///< the car is the last
};

/// Two shop fronts that face each other with a car on a lane between them, seen from somebody's eyes before
/// one of them along the street, so that each shows the other in its glass. Chosen among the city's facing
/// fronts, lanes between them and places before them by what rays from the eye find: how much of the picture
/// is glass of either in which the other is to be seen, weighed by Fresnel's law and by whether the sun
/// shines on it, and how much is car. Nothing where there is no such place. Cost: up to some ten million
/// rays. Deterministic.
std::optional<StreetShot> betweenShops(const Scene& scene, const FrameScene& frame,
                                       const reflection::TriangleTracer& triangles, glm::ivec2 size);

/// The door of a dark car from so near that it shows the window of the shop behind whoever looks. Chosen
/// among lanes before shops and places beside the door by where light from the eye goes that its paint, as it
/// is curved, mirrors. Nothing where no lane passes before a shop. Cost: as above.
std::optional<StreetShot> windowInDoor(const Scene& scene, const FrameScene& frame,
                                       const reflection::TriangleTracer& triangles, glm::ivec2 size);

}  // namespace app
