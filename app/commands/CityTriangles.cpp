#include "app/commands/CityTriangles.h"

namespace app {

void addCity(reflection::TriangleTracer& tracer, const city::CityModel& city) {
    for (const city::Chunk& chunk : city.chunks) tracer.add(chunk.mesh);
    for (const city::Placement& placement : city.placements)
        if (const auto& levels = city.prototypes[placement.prototype].levels; !levels.empty())
            tracer.add(levels.front().mesh, placement.worldFromPrototype);
}

}  // namespace app
