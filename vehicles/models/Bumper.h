#pragma once

#include "vehicles/models/Shell.h"

namespace vehicles {

/// A bumper bar that follows the shell round its front or rear at one height.
struct BumperShape {
    float z = 0.45f;           ///< height of its middle, metres
    float halfHeight = 0.05f;  ///< metres
    float depth = 0.04f;       ///< metres by which its outside bulges
    float standOff = 0.02f;    ///< metres between the shell and the bar's edges
    float centre = 1.3f;       ///< x on the plane of symmetry from where the outline is looked round
    float halfAngle = 1.2f;    ///< radians from straight ahead (or back) to its end
    bool rear = false;
};

/// Adds the left half of a chrome bumper bar: an elliptic section swept along the shell's outline, rounded
/// off at its end and closed behind within the body: with its mirror image a whole convex body, as searches
/// for what it reflects want it (reflection/chrome). Normals are those of the swept surface. Where the shell
/// is missed nothing is added. Cost: the shell's triangles, once for each of some sixty directions.
void addBumper(city::Mesh& parts, const Shell& half, const BumperShape& shape);

/// How far the shell's left half is met by a ray in the plane at height z: from (x, 0) in the direction of
/// `angle` (radians from +x towards +y). The farthest hit in metres; 0 where there is none.
float outlineAt(const Shell& half, float z, float x, float angle);

}  // namespace vehicles
