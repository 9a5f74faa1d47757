#include "city/roads/StreetSurfaces.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "city/roads/BuildRoadNetwork.h"
#include "city/roads/StreetAreas.h"
#include "city/roads/StreetMarkings.h"

namespace city {

namespace {

// Layers, metres. A centimetre is twice what 24 bits of depth tell apart at 150 m behind a near plane at 0.25
// m.
constexpr float levelHeight = 0;
constexpr float markingHeight = 0.012f;
constexpr float railHeight = 0.024f;
constexpr float kerbHeight = 0.12f;
constexpr float footing = -0.06f;  // raised edges reach below the ground, which others draw at -0.05

class Pieces {
  public:
    explicit Pieces(double size) : size_(size) {}

    void addArea(const Region& region, float height, std::uint32_t material) {
        if (region.empty()) return;
        const auto [minX, minY, maxX, maxY] = region.bounds();
        for (double x = std::floor(minX / size_); x * size_ < maxX; ++x) {
            const Region column = region.clipped(x * size_, minY - 1, (x + 1) * size_, maxY + 1);
            if (column.empty()) continue;
            for (double y = std::floor(minY / size_); y * size_ < maxY; ++y) {
                const Region cell =
                    column.clipped(x * size_ - 1, y * size_, (x + 1) * size_ + 1, (y + 1) * size_);
                const std::vector<glm::dvec2> corners = cell.triangles();
                if (corners.empty()) continue;
                addTriangles(meshes_[{static_cast<long>(x), static_cast<long>(y)}], corners, height,
                             material);
            }
        }
    }

    void addStrip(const PaintedStrip& strip, float height, std::uint32_t material) {
        if (strip.line.size() < 2) return;
        const double half = 0.5 * strip.width;
        const Polyline left = edgeOf(strip.line, -half);
        const Polyline right = edgeOf(strip.line, half);
        for (std::size_t i = 1; i < strip.line.size(); ++i) {
            Mesh& mesh = meshAt(strip.line[i]);
            mesh.addQuad(corner(left[i - 1], height, material), corner(right[i - 1], height, material),
                         corner(right[i], height, material), corner(left[i], height, material));
        }
    }

    /// Upright faces around a raised area, seen from outside.
    void addFaces(const Region& region, float top, float bottom, std::uint32_t material) {
        for (const std::vector<glm::dvec2>& ring : region.borders()) {
            double along = 0;
            for (std::size_t i = 1; i < ring.size(); ++i) {
                const glm::dvec2 a = ring[i - 1];
                const glm::dvec2 b = ring[i];
                const double d = glm::distance(a, b);
                if (d < 1e-6) continue;
                const glm::vec3 normal((b.y - a.y) / d, -(b.x - a.x) / d, 0);
                const auto at = [&](const glm::dvec2& p, float z, double s) {
                    return Vertex{{p.x, p.y, z}, normal, {s, z}, material};
                };
                meshAt({a, 0}).addQuad(at(a, bottom, along), at(b, bottom, along + d), at(b, top, along + d),
                                       at(a, top, along));
                along += d;
            }
        }
    }

    std::vector<Mesh> take() {
        std::vector<Mesh> out;
        for (auto& [cell, mesh] : meshes_) out.push_back(std::move(mesh));
        return out;
    }

  private:
    static Vertex corner(const glm::dvec3& p, float height, std::uint32_t material) {
        return {{p.x, p.y, height}, {0, 0, 1}, {p.x, p.y}, material};
    }

    /// Parallel to a line, one point for each of its points.
    static Polyline edgeOf(const Polyline& line, double offset) {
        Polyline out(line.size());
        for (std::size_t i = 0; i < line.size(); ++i) {
            glm::dvec3 d = line[std::min(i + 1, line.size() - 1)] - line[i == 0 ? 0 : i - 1];
            d.z = 0;
            const double n = glm::length(d);
            out[i] = line[i] + (n > 0 ? rightOf(d / n) * offset : glm::dvec3(0));
        }
        return out;
    }

    static void addTriangles(Mesh& mesh, const std::vector<glm::dvec2>& corners, float height,
                             std::uint32_t material) {
        // Corners of one area and height that fall on one point are one vertex.
        std::map<std::pair<double, double>, std::uint32_t> index;
        for (const glm::dvec2& p : corners) {
            const auto [entry, fresh] =
                index.try_emplace({p.x, p.y}, static_cast<std::uint32_t>(mesh.vertices.size()));
            if (fresh) mesh.vertices.push_back(corner({p, 0}, height, material));
            mesh.indices.push_back(entry->second);
        }
    }

    Mesh& meshAt(const glm::dvec3& p) {
        return meshes_[{static_cast<long>(std::floor(p.x / size_)),
                        static_cast<long>(std::floor(p.y / size_))}];
    }

    double size_;
    std::map<std::pair<long, long>, Mesh> meshes_;
};

}  // namespace

std::vector<Mesh> buildStreetSurfaces(const StreetGraph& streets, const StreetMaterials& materials,
                                      float splitLength) {
    const StreetLayout layout = layOutStreets(streets);
    const StreetAreas areas = areasOf(layout);
    Pieces pieces(std::isfinite(splitLength) ? std::max(10.0, static_cast<double>(splitLength)) : 100.0);
    pieces.addArea(areas.carriageway, levelHeight, materials.asphalt);
    pieces.addArea(areas.tramBed, levelHeight, materials.tramBed);
    pieces.addArea(areas.pavement, kerbHeight, materials.pavement);
    pieces.addArea(areas.kerb, kerbHeight, materials.kerb);
    pieces.addFaces(areas.pavement.with(areas.kerb), kerbHeight, footing, materials.kerb);
    for (const PaintedStrip& strip : laneLines(layout))
        pieces.addStrip(strip, markingHeight, materials.marking);
    for (const PaintedStrip& strip : stopLinesAndCrossings(layout)) {
        pieces.addStrip(strip, markingHeight, materials.marking);
    }
    for (const PaintedStrip& strip : railsOf(buildRoadNetwork(streets))) {
        pieces.addStrip(strip, railHeight, materials.rail);
    }
    return pieces.take();
}

}  // namespace city
