#pragma once

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

struct WheelShape {
    float radius = 0.32f;  ///< metres, over the tread
    float width = 0.205f;
    float rimRadius = 0.21f;  ///< where the tyre meets the rim
    int spokes = 5;           ///< 0: a pressed steel disc, as on buses
    bool tyre = true;         ///< false: a steel wheel, as on trams
    bool cover = false;       ///< a chrome cover over all of the rim, in place of spokes
};

/// A left-hand wheel as VehicleModel::wheel asks: axle along y, outside towards +y, about 1,500 triangles.
city::Mesh wheelMesh(const WheelShape& shape);

/// The same outline for far levels, without its inner side: 5 triangles a segment with the rim, 3 without.
city::Mesh plainWheelMesh(const WheelShape& shape, int segments, bool rim);

}  // namespace vehicles
