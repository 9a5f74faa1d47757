#pragma once

#include "vehicles/models/Shell.h"

namespace vehicles {

struct WheelArch {
    float x = 0, z = 0;    ///< the axle, metres
    float radius = 0.36f;  ///< of the opening
    float inner = 0.55f;   ///< |y| at which the housing ends
    float flare = 0.012f;  ///< how far the lip stands out
};

/// Cuts the arch out of the left half of a body and closes it: a lip of paint, then a dark housing (surface
/// interior) down to `inner`, added to `parts`. The opening's edge lies on the circle exactly.
void cutWheelArch(Shell& half, city::Mesh& parts, const WheelArch& arch);

}  // namespace vehicles
