#include "vehicles/models/Assemble.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "vehicles/models/Levels.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"

namespace vehicles {

void addGlass(Shell& half, const Field& region, float seal) {
    half.refine(region, 0.02f);
    half.assign(grown(region, seal), Surface::trim);
    half.assign(region, Surface::glass);
    half.recess(grown(region, 1e-4f), 0.004f);
}

void addGap(Shell& half, const Field& field) {
    half.refine(field, 0.03f);
    half.assignLine(field, 0.004f, Surface::trim, {Surface::paint});
}

void addPanel(Shell& half, const Field& region, Surface surface, float edge, Surface edgeSurface) {
    half.refine(region, 0.02f);
    if (edge > 0) half.assign(grown(region, edge), edgeSurface);
    half.assign(region, surface);
}

void addDoorMirror(city::Mesh& parts, const glm::vec3& at, float size, Surface cap) {
    const glm::vec3 half = size * glm::vec3(0.065f, 0.105f, 0.072f);
    const glm::vec3 centre = at + glm::vec3(0, 0.06f + half.y, 0.02f);
    addRounded(parts, centre, half, 3.0f, 18, cap);
    addRounded(parts, centre - glm::vec3(0.62f * half.x, 0, 0),
               glm::vec3(0.42f * half.x, 0.87f * half.y, 0.84f * half.z), 4.0f, 14, Surface::chrome);
    addRounded(parts, at + glm::vec3(0, 0.05f, -0.02f), size * glm::vec3(0.035f, 0.085f, 0.022f), 3.0f, 10,
               Surface::trim);
}

void addHandle(city::Mesh& parts, const glm::vec3& at, Surface surface) {
    addRounded(parts, at + glm::vec3(0, 0.012f, 0), {0.095f, 0.016f, 0.014f}, 3.5f, 12, surface);
}

float sideAt(const Shell& half, float x, float z) {
    float best = 0;
    for (const auto& t : half.triangles) {
        const glm::vec3 a = half.positions[t.corner[0]], b = half.positions[t.corner[1]],
                        c = half.positions[t.corner[2]];
        const float area = (b.x - a.x) * (c.z - a.z) - (c.x - a.x) * (b.z - a.z);
        if (std::abs(area) < 1e-12f) continue;
        const float v = ((x - a.x) * (c.z - a.z) - (c.x - a.x) * (z - a.z)) / area;
        const float w = ((b.x - a.x) * (z - a.z) - (x - a.x) * (b.z - a.z)) / area;
        if (v < 0 || w < 0 || v + w > 1) continue;
        best = std::max(best, a.y + v * (b.y - a.y) + w * (c.y - a.y));
    }
    return best;
}

VehicleModel assemble(const Assembly& plan, Shell half, const city::Mesh& parts, const city::Mesh& oneSided,
                      const std::function<void(Shell&)>& lastCuts) {
    VehicleModel model;
    model.name = plan.name;
    model.length = plan.length;
    model.width = plan.width;
    model.height = plan.height;
    model.wheelRadius = plan.wheel.radius;
    model.wheel = wheelMesh(plan.wheel);
    for (std::size_t i = 0; i < plan.axles.size(); ++i)
        for (const float side : {1.0f, -1.0f})
            model.wheels.push_back({{plan.axles[i], side * plan.track / 2, plan.wheel.radius},
                                    !plan.noneSteer && (plan.allSteer || i == 0),
                                    side < 0});
    // A symmetric body is simplified as a half, so that it stays symmetric.
    if (!lastCuts) half.simplify(plan.triangles / 2, plan.tolerance);
    half.mirror();
    if (lastCuts) {
        lastCuts(half);
        half.simplify(plan.triangles, plan.tolerance);
    }
    VehicleModel::Level level;
    level.body = half.mesh();
    city::Mesh sides = parts;
    addMirrored(sides);
    level.body.append(sides);
    level.body.append(oneSided);
    model.levels.push_back(std::move(level));
    makeLevels(model);
    return model;
}

}  // namespace vehicles
