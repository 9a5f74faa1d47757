#pragma once

#include "vehicles/models/Shell.h"
#include "vehicles/models/Wheel.h"

namespace vehicles {

/// Glass with its dark seal: inside the outline glass, 4 mm deep, round it `seal` metres of trim.
void addGlass(Shell& half, const Field& region, float seal = 0.014f);

/// A gap between panels: a dark line of 8 mm along the field's zero line, on paint only.
void addGap(Shell& half, const Field& field);

/// A region of another surface: a lamp, a grille, a plate, with an edge of `edge` metres of `edgeSurface`
/// round it.
void addPanel(Shell& half, const Field& region, Surface surface, float edge = 0,
              Surface edgeSurface = Surface::trim);

/// A door mirror on the left: its cap, its glass in chrome to the rear, on a foot of trim.
void addDoorMirror(city::Mesh& parts, const glm::vec3& at, float size = 1, Surface cap = Surface::paint);

/// A door handle on the left, along x.
void addHandle(city::Mesh& parts, const glm::vec3& at, Surface surface = Surface::chrome);

/// Where the shell's left half is met from outside by a line along y through (x, z): its greatest y, or 0 if
/// it is missed.
float sideAt(const Shell& half, float x, float z);

/// Puts a vehicle together: mirrors the half shell and the parts, adds `oneSided` parts as they are, stands
/// the wheels under it (axles at the given x, `track` between the wheels' middles), and makes the levels of
/// detail.
struct Assembly {
    std::string name;
    float length = 0, width = 0, height = 0, track = 0;
    WheelShape wheel;
    std::vector<float> axles;       ///< x, the first one steers
    std::size_t triangles = 11000;  ///< at least, of the finest body's shell
    float tolerance =
        0.0006f;  ///< metres by which the shell may be simplified; more shows as facets in reflections
    bool allSteer = false, noneSteer = false;
};
VehicleModel assemble(const Assembly& plan, Shell half, const city::Mesh& parts, const city::Mesh& oneSided,
                      const std::function<void(Shell&)>& lastCuts = {});

}  // namespace vehicles
