#include "city/model/Ledge.h"

#include <cmath>

#include "city/model/PolygonAlgebra.h"

namespace city {

namespace {

/// Upright faces on the right-hand side of a ring's edges.
void addFaces(const std::vector<glm::vec2>& ring, float bottom, float top, std::uint32_t material,
              Mesh& mesh) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::vec2 a = ring[i];
        const glm::vec2 b = ring[(i + 1) % ring.size()];
        const float length = std::hypot(b.x - a.x, b.y - a.y);
        if (!(length > 0)) continue;
        const glm::vec3 normal((b.y - a.y) / length, -(b.x - a.x) / length, 0);
        mesh.addQuad({glm::vec3(a, bottom), normal, {0, 0}, material},
                     {glm::vec3(b, bottom), normal, {length, 0}, material},
                     {glm::vec3(b, top), normal, {length, top - bottom}, material},
                     {glm::vec3(a, top), normal, {0, top - bottom}, material});
    }
}

void addDeck(const std::vector<Footprint>& areas, float z, bool up, std::uint32_t material, Mesh& mesh) {
    for (const Footprint& area : areas) {
        const std::vector<glm::vec2> corners = triangulateClean(area);
        const auto vertex = [&](glm::vec2 p) {
            return Vertex{glm::vec3(p, z), {0, 0, up ? 1 : -1}, p, material};
        };
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
            mesh.addTriangle(vertex(corners[i]), vertex(corners[up ? i + 1 : i + 2]),
                             vertex(corners[up ? i + 2 : i + 1]));
    }
}

}  // namespace

void appendLedge(const Footprint& footprint, const Ledge& ledge, Mesh& mesh) {
    if (!(ledge.top > ledge.bottom && ledge.overhang > cornerTolerance) ||
        !std::isfinite(ledge.top - ledge.bottom))
        return;
    for (const Footprint& part : cleanFootprint({footprint.outer, {}}).parts) {
        const std::vector<Footprint> wall{part};
        const std::vector<Footprint> outer = offset(part, ledge.overhang);
        const std::vector<Footprint> inner =
            ledge.inward > cornerTolerance ? offset(part, -double(ledge.inward)) : wall;
        for (const Footprint& ring : outer)
            addFaces(ring.outer, ledge.bottom, ledge.top, ledge.material, mesh);
        addDeck(difference(outer, wall), ledge.bottom, false, ledge.material, mesh);
        addDeck(difference(outer, inner), ledge.top, true, ledge.material, mesh);
        if (!(ledge.inward > cornerTolerance)) continue;
        for (const Footprint& ring : inner) {
            const std::vector<glm::vec2> backwards(ring.outer.rbegin(), ring.outer.rend());
            addFaces(backwards, ledge.bottom, ledge.top, ledge.material, mesh);
        }
    }
}

}  // namespace city
