#pragma once

#include "vehicles/import/ReadGltf.h"
#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// The surface of every triangle of the scene: by the material's name; then by its transparency and metal;
/// then, as in kits that colour everything from one palette, by the colour: dark bluish is glass, dark grey
/// trim (on wheels: tyre), small light areas at the ends lamps, all else paint. Linear in the number of
/// triangles.
std::vector<Surface> guessSurfaces(const GltfScene& scene);

}  // namespace vehicles
