#include "app/render/Skyline.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <numeric>
#include <unordered_map>

namespace app {

namespace {

constexpr float none = -std::numeric_limits<float>::infinity();
/// A building's foot may stand this much above the ground: doorsteps, slopes within a cell.
constexpr float footTolerance = 0.3f;
/// z of the unit normal of a mirror that still counts as upright: beams are level, and over the longest of
/// them the glass then moves by less than the margin.
constexpr double uprightMirror = 1e-3;

/// Point samples of surfaces seen from above.
class SampleGrid {
  public:
    SampleGrid(glm::vec2 origin, int width, int height, float value)
        : origin_(origin),
          width_(width),
          height_(height),
          cells_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

    float& at(int i, int j) {
        return cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(i)];
    }

    /// Calls visit(cell, z) for each sample under or over the triangle, whichever way it faces.
    template <class Visit>
    void cover(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Visit visit) {
        const glm::vec2 lo =
            (glm::min(glm::min(glm::vec2(a), glm::vec2(b)), glm::vec2(c)) - origin_) / Skyline::spacing;
        const glm::vec2 hi =
            (glm::max(glm::max(glm::vec2(a), glm::vec2(b)), glm::vec2(c)) - origin_) / Skyline::spacing;
        const double area =
            (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
        if (std::abs(area) < 1e-9) return;
        for (int j = std::max(0, static_cast<int>(std::floor(lo.y)));
             j <= std::min(height_ - 1, static_cast<int>(std::floor(hi.y))); ++j) {
            for (int i = std::max(0, static_cast<int>(std::floor(lo.x)));
                 i <= std::min(width_ - 1, static_cast<int>(std::floor(hi.x))); ++i) {
                const glm::dvec2 p(origin_.x + (i + 0.5) * Skyline::spacing,
                                   origin_.y + (j + 0.5) * Skyline::spacing);
                const double v =
                    ((p.x - a.x) * (double(c.y) - a.y) - (p.y - a.y) * (double(c.x) - a.x)) / area;
                const double w =
                    ((double(b.x) - a.x) * (p.y - a.y) - (double(b.y) - a.y) * (p.x - a.x)) / area;
                if (v < -1e-6 || w < -1e-6 || v + w > 1 + 1e-6) continue;
                visit(at(i, j), static_cast<float>(a.z + v * (double(b.z) - a.z) + w * (double(c.z) - a.z)));
            }
        }
    }

    /// Each cell becomes the lowest within `reach` cells along both axes (van Herk's filter would be faster;
    /// this is done once).
    void erode(int reach) {
        std::vector<float> row;
        for (int j = 0; j < height_; ++j) {
            row.assign(&at(0, j), &at(0, j) + width_);
            for (int i = 0; i < width_; ++i) {
                float lowest = i < reach || i + reach >= width_ ? none : row[static_cast<std::size_t>(i)];
                for (int k = std::max(0, i - reach); k <= std::min(width_ - 1, i + reach); ++k)
                    lowest = std::min(lowest, row[static_cast<std::size_t>(k)]);
                at(i, j) = lowest;
            }
        }
        std::vector<float> before = cells_;
        for (int j = 0; j < height_; ++j) {
            for (int i = 0; i < width_; ++i) {
                float lowest = j < reach || j + reach >= height_ ? none : at(i, j);
                for (int k = std::max(0, j - reach); k <= std::min(height_ - 1, j + reach); ++k)
                    lowest = std::min(lowest,
                                      before[static_cast<std::size_t>(k) * static_cast<std::size_t>(width_) +
                                             static_cast<std::size_t>(i)]);
                at(i, j) = lowest;
            }
        }
    }

    std::vector<float>& cells() { return cells_; }

  private:
    glm::vec2 origin_;
    int width_;
    int height_;
    std::vector<float> cells_;
};

/// For each vertex the lowest z of the piece that it belongs to: vertices are joined by triangles and by
/// equal positions.
std::vector<float> footOfPieces(const city::Mesh& mesh) {
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    struct Hash {
        std::size_t operator()(const glm::ivec3& p) const {
            return static_cast<std::size_t>(p.x) * 73856093u ^ static_cast<std::size_t>(p.y) * 19349663u ^
                   static_cast<std::size_t>(p.z) * 83492791u;
        }
    };
    std::unordered_map<glm::ivec3, std::uint32_t, Hash> byPosition;
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::ivec3 millimetres(glm::round(mesh.vertices[i].position * 1000.f));
        const auto [it, isNew] = byPosition.try_emplace(millimetres, i);
        if (!isNew) parent[root(i)] = root(it->second);
    }
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (std::size_t k = 1; k < 3; ++k) parent[root(mesh.indices[i + k])] = root(mesh.indices[i]);
    std::vector<float> lowest(mesh.vertices.size(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        float& z = lowest[root(i)];
        z = std::min(z, mesh.vertices[i].position.z);
    }
    std::vector<float> feet(mesh.vertices.size());
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) feet[i] = lowest[root(i)];
    return feet;
}

}  // namespace

Skyline::Skyline(const city::CityModel& city) {
    city::Aabb box;
    for (const city::Chunk& chunk : city.chunks)
        if (chunk.kind == city::ChunkKind::building) box.extend(chunk.mesh.bounds());
    if (box.empty()) return;
    const glm::vec2 size = glm::vec2(box.size()) + 2.f;
    // A city beyond 8 km is not worth the memory of its columns.
    if (!(size.x > 0 && size.y > 0 && size.x < 8000 && size.y < 8000)) return;
    origin_ = glm::vec2(box.min) - 1.f;
    width_ = static_cast<int>(size.x / spacing) + 1;
    height_ = static_cast<int>(size.y / spacing) + 1;

    SampleGrid ground(origin_, width_, height_, none);
    for (const city::Chunk& chunk : city.chunks) {
        if (chunk.kind != city::ChunkKind::ground) continue;
        const city::Mesh& mesh = chunk.mesh;
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
            ground.cover(mesh.vertices[mesh.indices[i]].position, mesh.vertices[mesh.indices[i + 1]].position,
                         mesh.vertices[mesh.indices[i + 2]].position,
                         [](float& cell, float z) { cell = std::max(cell, z); });
    }
    SampleGrid roofs(origin_, width_, height_, none);
    SampleGrid undersides(origin_, width_, height_, none);
    for (const city::Chunk& chunk : city.chunks) {
        if (chunk.kind != city::ChunkKind::building) continue;
        const city::Mesh& mesh = chunk.mesh;
        const std::vector<float> feet = footOfPieces(mesh);
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const city::Vertex* corner[3];
            for (std::size_t k = 0; k < 3; ++k) corner[k] = &mesh.vertices[mesh.indices[i + k]];
            const glm::vec3 a = corner[0]->position;
            const glm::vec3 b = corner[1]->position;
            const glm::vec3 c = corner[2]->position;
            const float up = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            const bool opaque = corner[0]->material >= city.materials.size() ||
                                (!city.materials[corner[0]->material].cutout &&
                                 !city.materials[corner[0]->material].twoSided);
            if (up > 0 && opaque) {
                const float foot = feet[mesh.indices[i]];
                const glm::vec3 middle = (a + b + c) / 3.f;
                const auto gi = static_cast<int>((middle.x - origin_.x) / spacing);
                const auto gj = static_cast<int>((middle.y - origin_.y) / spacing);
                const float floorLevel = std::max(ground.at(gi, gj), city.bounds.min.z);
                if (foot > std::max(floorLevel, box.min.z) + footTolerance) continue;  // hangs in the air
                roofs.cover(a, b, c, [](float& cell, float z) { cell = std::max(cell, z); });
            } else if (up < 0) {
                undersides.cover(a, b, c, [](float& cell, float z) { cell = std::max(cell, z); });
            }
        }
    }
    for (std::size_t i = 0; i < roofs.cells().size(); ++i)
        if (undersides.cells()[i] > std::max(ground.cells()[i], box.min.z) + footTolerance)
            roofs.cells()[i] = none;
    roofs.erode(static_cast<int>(margin / spacing));
    heights_ = std::move(roofs.cells());
    for (float h : heights_) highest_ = std::max(highest_, h);
}

SkylineView::SkylineView(const Skyline& skyline, const glm::dvec3& eye, int beams, const Sector& sector,
                         const glm::dvec4& glass)
    : eye_(eye), beams_(beams), beamWidth_(2 * std::numbers::pi_v<float> / static_cast<float>(beams)) {
    const bool mirrored = glm::dvec3(glass) != glm::dvec3(0);
    if (skyline.empty() || (mirrored && std::abs(glass.z) > uprightMirror)) return;
    if (!mirrored && skyline.heightAt(glm::vec2(eye_)) >= eye_.z) return;
    nothingHidden_ = false;
    // Half of the margin is for eaves, half for the width of the beam; beams that grow wider prove nothing.
    const float farthest = Skyline::margin / beamWidth_;
    constexpr float stride = 1;
    const auto wrap = [&](int i) { return ((i % beams_) + beams_) % beams_; };
    const int begin = static_cast<int>(std::floor(sector.from / beamWidth_)) - 1;
    const int count = std::min(beams_, static_cast<int>(std::ceil(sector.width / beamWidth_)) + 3);
    wanted_.assign(static_cast<std::size_t>(beams_), false);
    for (int i = 0; i < count; ++i) wanted_[static_cast<std::size_t>(wrap(begin + i))] = true;

    first_.reserve(static_cast<std::size_t>(beams_) + 1);
    for (int beam = 0; beam < beams_; ++beam) {
        first_.push_back(static_cast<std::uint32_t>(steps_.size()));
        if (!wanted_[static_cast<std::size_t>(beam)]) continue;
        const float azimuth = (static_cast<float>(beam) + 0.5f) * beamWidth_;
        const glm::vec2 direction(std::cos(azimuth), std::sin(azimuth));
        float steepest = none;
        float first = stride;
        if (mirrored) {
            // All of the beam must have passed the glass, and what is solid there must be clear of it.
            const float edge = 0.5f * beamWidth_;
            for (const float side : {-edge, edge}) {
                const double approach =
                    glass.x * std::cos(double(azimuth + side)) + glass.y * std::sin(double(azimuth + side));
                first = approach > 1e-3
                            ? std::max(first, static_cast<float>(-glass.w / approach) + Skyline::margin)
                            : farthest;
            }
        }
        for (float distance = first; distance < farthest; distance += stride) {
            const float height = skyline.heightAt(glm::vec2(eye_) + distance * direction);
            if (height == none) continue;
            const float slope = (height - eye_.z) / distance;
            if (slope <= steepest) continue;
            steepest = slope;
            steps_.push_back({distance + stride, slope});
            if (slope * distance >= skyline.highest() - eye_.z) break;
        }
    }
    first_.push_back(static_cast<std::uint32_t>(steps_.size()));
}

SkylineView::Sector SkylineView::sectorOf(const glm::mat4& clipFromRelative) {
    for (float z : {1.f, -1.f}) {
        const glm::vec4 pole = clipFromRelative * glm::vec4(0, 0, z, 0);
        if (pole.w > 0 && std::abs(pole.x) <= 1.05f * pole.w && std::abs(pole.y) <= 1.05f * pole.w) return {};
    }
    // Half planes through the vertical touch a cone that does not hold it at its edges: the corners tell.
    const glm::mat4 relativeFromClip = glm::inverse(clipFromRelative);
    const auto towards = [&](float x, float y) {
        const glm::vec4 p = relativeFromClip * glm::vec4(x, y, 1, 1);
        return std::atan2(p.y / p.w, p.x / p.w);
    };
    const float middle = towards(0, 0);
    float low = 0;
    float high = 0;
    for (float x : {-1.f, 1.f}) {
        for (float y : {-1.f, 1.f}) {
            const float difference = std::remainder(towards(x, y) - middle, 2 * std::numbers::pi_v<float>);
            low = std::min(low, difference);
            high = std::max(high, difference);
        }
    }
    if (!(high - low < 3)) return {};
    return {middle + low, high - low};
}

bool SkylineView::hides(const city::Aabb& box) const {
    if (nothingHidden_ || box.empty()) return false;
    const glm::vec2 centre = glm::vec2(box.centre()) - glm::vec2(eye_);
    const glm::vec2 half = 0.5f * glm::vec2(box.size());
    const float nearest = glm::length(glm::max(glm::abs(centre) - half, glm::vec2(0)));
    if (nearest < 2) return false;
    const float farthest = glm::length(glm::abs(centre) + half);
    const float rise = box.max.z - eye_.z;
    const float slope = rise > 0 ? rise / nearest : rise / farthest;

    // The box's corners span its azimuths: the eye is outside, so they lie within half a turn around the
    // centre's.
    const float middle = std::atan2(centre.y, centre.x);
    float low = 0;
    float high = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const glm::vec2 p = centre + half * glm::vec2((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1);
        float difference = std::atan2(p.y, p.x) - middle;
        if (difference > std::numbers::pi_v<float>) difference -= 2 * std::numbers::pi_v<float>;
        if (difference < -std::numbers::pi_v<float>) difference += 2 * std::numbers::pi_v<float>;
        low = std::min(low, difference);
        high = std::max(high, difference);
    }
    const int begin = static_cast<int>(std::floor((middle + low) / beamWidth_ - 0.01f));
    const int end = static_cast<int>(std::floor((middle + high) / beamWidth_ + 0.01f));
    for (int i = begin; i <= end; ++i) {
        const auto beam = static_cast<std::size_t>(((i % beams_) + beams_) % beams_);
        if (!wanted_[beam]) continue;
        // Slopes grow with distance: the last step that is nearer than the box counts.
        bool hidden = false;
        for (std::uint32_t s = first_[beam]; s < first_[beam + 1] && steps_[s].distance <= nearest; ++s)
            hidden = steps_[s].slope > slope;
        if (!hidden) return false;
    }
    return true;
}

}  // namespace app
