#include "reflection/local_map/MovingObjects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Nearest depth that is drawn, metres: inside it a vehicle would intersect the one that mirrors it.
constexpr float nearest = 0.05f;

/// A corner in face coordinates: s and t times depth, and the depth itself.
struct Corner {
    glm::vec3 at;
    glm::vec3 radiance;
};

/// A corner on the face: texel coordinates, reciprocal depth and radiance over depth (all linear over the
/// face). Corners cut at the near limit lie hundreds of texels outside, where the areas of a float are too
/// coarse for a thin triangle.
struct Projected {
    double x, y;
    float reciprocal;
    glm::vec3 radiance;
};

Corner between(const Corner& a, const Corner& b, float depth) {
    const float f = (depth - a.at.z) / (b.at.z - a.at.z);
    return {glm::mix(a.at, b.at, f), glm::mix(a.radiance, b.radiance, f)};
}

/// Twice the signed area of (a, b, p).
double edge(const Projected& a, const Projected& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// With y down and the inside positive, top edges run towards +x and left ones towards -y.
bool topLeft(const Projected& a, const Projected& b) {
    return (a.y == b.y && b.x > a.x) || b.y < a.y;
}

class FaceRaster {
  public:
    FaceRaster(int face, LocalMap& map) : map_(map), offset_(map.faceOffset(face)), size_(map.faceSize) {}

    std::uint32_t written() const { return written_; }

    void triangle(const Corner& a, const Corner& b, const Corner& c) {
        std::array<Corner, 4> polygon;
        std::size_t count = 0;
        const std::array<const Corner*, 3> in{&a, &b, &c};
        for (std::size_t i = 0; i < 3; ++i) {
            const Corner& p = *in[i];
            const Corner& q = *in[(i + 1) % 3];
            const bool pIn = p.at.z >= nearest, qIn = q.at.z >= nearest;
            if (pIn) polygon[count++] = p;
            if (pIn != qIn) polygon[count++] = between(p, q, nearest);
        }
        if (count < 3) return;
        std::array<Projected, 4> corners;
        for (std::size_t i = 0; i < count; ++i) corners[i] = project(polygon[i]);
        fill(corners[0], corners[1], corners[2]);
        if (count == 4) fill(corners[0], corners[2], corners[3]);
    }

  private:
    Projected project(const Corner& c) const {
        const float reciprocal = 1 / c.at.z;
        const double half = 0.5 * size_, z = static_cast<double>(c.at.z);
        return {(c.at.x / z + 1) * half, (c.at.y / z + 1) * half, reciprocal, c.radiance * reciprocal};
    }

    void fill(const Projected& a, const Projected& b, const Projected& c) {
        // On all six faces s x t = -major, towards the centre: what is counter-clockwise seen from there has
        // a positive area in (s, t).
        const double area = edge(a, b, c.x, c.y);
        if (!(area > 0)) return;  // seen from behind, or no area, or not finite
        const double inverse = 1 / area;
        const auto limit = static_cast<double>(size_);
        const auto first = [&](double least) {
            return static_cast<int>(std::ceil(std::clamp(least - 0.5, 0.0, limit)));
        };
        const auto last = [&](double most) {
            return static_cast<int>(std::floor(std::clamp(most - 0.5, -1.0, limit - 1)));
        };
        const int x0 = first(std::min({a.x, b.x, c.x})), x1 = last(std::max({a.x, b.x, c.x}));
        const int y0 = first(std::min({a.y, b.y, c.y})), y1 = last(std::max({a.y, b.y, c.y}));
        const bool ownsA = topLeft(b, c), ownsB = topLeft(c, a), ownsC = topLeft(a, b);
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                const double ea = edge(b, c, px, py), eb = edge(c, a, px, py), ec = edge(a, b, px, py);
                if (ea < 0 || eb < 0 || ec < 0 || (ea == 0 && !ownsA) || (eb == 0 && !ownsB) ||
                    (ec == 0 && !ownsC))
                    continue;
                const auto wa = static_cast<float>(ea * inverse), wb = static_cast<float>(eb * inverse),
                           wc = static_cast<float>(ec * inverse);
                const float depth = 1 / (wa * a.reciprocal + wb * b.reciprocal + wc * c.reciprocal);
                const std::size_t i = offset_ +
                                      static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                                      static_cast<std::size_t>(x);
                if (!(depth < map_.depth[i])) continue;
                const glm::vec3 radiance = (wa * a.radiance + wb * b.radiance + wc * c.radiance) * depth;
                map_.red[i] = radiance.r;
                map_.green[i] = radiance.g;
                map_.blue[i] = radiance.b;
                map_.depth[i] = depth;
                ++written_;
            }
        }
    }

    LocalMap& map_;
    std::size_t offset_;
    int size_;
    std::uint32_t written_ = 0;
};

}  // namespace

std::uint32_t drawMovingObjects(std::span<const MovingObject> objects, int face, LocalMap& map) {
    const CubeFace& f = cubeFaces[static_cast<std::size_t>(face)];
    FaceRaster raster(face, map);
    std::vector<Corner> corners;
    for (const MovingObject& object : objects) {
        corners.resize(object.positions.size());
        bool ahead = false;
        std::array<bool, 4> allOutside{true, true, true, true};
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::vec3& p = object.positions[i];
            const glm::vec3 at(glm::dot(f.sAxis, p), glm::dot(f.tAxis, p), glm::dot(f.major, p));
            corners[i] = {at, object.radiance[i]};
            ahead = ahead || at.z >= nearest;
            allOutside[0] = allOutside[0] && at.x > at.z;
            allOutside[1] = allOutside[1] && at.x < -at.z;
            allOutside[2] = allOutside[2] && at.y > at.z;
            allOutside[3] = allOutside[3] && at.y < -at.z;
        }
        if (!ahead || allOutside[0] || allOutside[1] || allOutside[2] || allOutside[3]) continue;
        for (std::size_t k = 0; k + 2 < object.indices.size(); k += 3)
            raster.triangle(corners[object.indices[k]], corners[object.indices[k + 1]],
                            corners[object.indices[k + 2]]);
    }
    return raster.written();
}

}  // namespace reflection
