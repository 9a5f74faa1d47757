#include "reflection/local_map/LocalMapBuilder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

/// Where the paper's method puts the sky: far enough that the offset of a map does not matter.
constexpr float skyDistance = 1e5f;

/// Weight of map A at a point I (section 4.1): the projection of I onto the axis between the two centres.
float axisWeight(const glm::vec3& point, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 axis = b - a;
    const float squared = glm::dot(axis, axis);
    if (!(squared > 0)) return 0.5f;  // coincident maps: any mixture is right
    return 1 - std::clamp(glm::dot(point - a, axis) / squared, 0.0f, 1.0f);
}

}  // namespace

StreetBox streetBoxOf(const PackedReferenceMap& map, const glm::vec3& forward) {
    StreetBox box;
    box.forward = forward;
    const glm::vec3 left(-forward.y, forward.x, 0);
    std::array<std::vector<float>, 5> seen;
    const PackedReferenceMap::Level& level = map.levelFor(32);
    const int n = level.faceSize();
    const std::array<glm::vec3, 5> axes{forward, -forward, left, -left, glm::vec3(0, 0, -1)};
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                const glm::vec3 d = glm::normalize(cubeDirection(face, glm::vec2(x, y) + 0.5f, n));
                for (std::size_t a = 0; a < axes.size(); ++a) {
                    const float along = glm::dot(d, axes[a]);
                    // Within 20 degrees of the axis, and above the horizon for the horizontal ones.
                    if (along < 0.94f || (a < 4 && d.z < 0)) continue;
                    seen[a].push_back(std::min(level.distanceAt(face, x, y), 200.0f) * along);
                }
            }
        }
    }
    const auto median = [](std::vector<float>& v, float fallback) {
        if (v.empty()) return fallback;
        const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
        std::nth_element(v.begin(), middle, v.end());
        return std::max(0.5f, *middle);
    };
    box.ahead = median(seen[0], box.ahead);
    box.behind = median(seen[1], box.behind);
    box.left = median(seen[2], box.left);
    box.right = median(seen[3], box.right);
    box.below = median(seen[4], box.below);
    return box;
}

void LocalMapBuilder::resizePlanes(int faceSize) {
    const std::size_t texels = static_cast<std::size_t>(faceSize) * static_cast<std::size_t>(faceSize);
    for (std::vector<float>* plane : {&px_, &py_, &pz_, &weight_}) plane->resize(texels);
}

namespace {

/// A quad of Size x Size texels: bilinear at the texels' centres.
template <int Size>
void fillQuad(const LocalMapMesh::Quad& q, float* texels, std::size_t row) {
    constexpr float step = 1.0f / static_cast<float>(Size);
    for (int y = 0; y < Size; ++y, texels += row) {
        const float v = (static_cast<float>(y) + 0.5f) * step;
        const float left = q.corner[0] + v * (q.corner[2] - q.corner[0]);
        const float right = q.corner[1] + v * (q.corner[3] - q.corner[1]);
        for (int x = 0; x < Size; ++x)
            texels[x] = q.smooth ? left + (static_cast<float>(x) + 0.5f) * step * (right - left) : q.centre;
    }
}

}  // namespace

void LocalMapBuilder::fillAligned(int faceSize, int texelsPerUnit) {
    const auto row = static_cast<std::size_t>(faceSize);
    const auto scale = static_cast<std::size_t>(texelsPerUnit);
    for (const LocalMapMesh::Quad& q : mesh_.quads()) {
        float* texels = reciprocal_.data() + q.y * scale * row + q.x * scale;
        switch (q.size * texelsPerUnit) {
            case 1:
                fillQuad<1>(q, texels, row);
                break;
            case 2:
                fillQuad<2>(q, texels, row);
                break;
            case 4:
                fillQuad<4>(q, texels, row);
                break;
            case 8:
                fillQuad<8>(q, texels, row);
                break;
            default:
                fillQuad<16>(q, texels, row);
                break;
        }
    }
}

void LocalMapBuilder::fillReciprocal(int faceSize) {
    reciprocal_.resize(static_cast<std::size_t>(faceSize) * static_cast<std::size_t>(faceSize));
    const int perUnit = faceSize / mesh_.latticeSize();
    if (perUnit * mesh_.latticeSize() == faceSize && mesh_.greatestQuad() * perUnit <= 16 &&
        std::has_single_bit(static_cast<unsigned>(perUnit))) {
        fillAligned(faceSize, perUnit);
        return;
    }
    // Texels whose centre lies in a quad, in the quad's own coordinates.
    const float latticeFromTexel = static_cast<float>(mesh_.latticeSize()) / static_cast<float>(faceSize);
    const float texelFromLattice = 1 / latticeFromTexel;
    for (const LocalMapMesh::Quad& q : mesh_.quads()) {
        const auto firstTexel = [&](int lattice) {
            return static_cast<int>(std::ceil(static_cast<float>(lattice) * texelFromLattice - 0.5f));
        };
        const int x0 = firstTexel(q.x), x1 = std::min(faceSize, firstTexel(q.x + q.size));
        const int y0 = firstTexel(q.y), y1 = std::min(faceSize, firstTexel(q.y + q.size));
        const float scale = latticeFromTexel / static_cast<float>(q.size);
        const float offsetX = static_cast<float>(q.x) / static_cast<float>(q.size);
        const float offsetY = static_cast<float>(q.y) / static_cast<float>(q.size);
        for (int y = y0; y < y1; ++y) {
            float* row =
                reciprocal_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(faceSize);
            if (!q.smooth) {
                std::fill(row + x0, row + x1, q.centre);
                continue;
            }
            const float v = (static_cast<float>(y) + 0.5f) * scale - offsetY;
            const float left = q.corner[0] + v * (q.corner[2] - q.corner[0]);
            const float right = q.corner[1] + v * (q.corner[3] - q.corner[1]);
            for (int x = x0; x < x1; ++x) {
                const float u = (static_cast<float>(x) + 0.5f) * scale - offsetX;
                row[x] = left + u * (right - left);
            }
        }
    }
}

void LocalMapBuilder::fillPaper(const LocalMapRequest& request, int face) {
    const int n = request.faceSize;
    const Candidate& a = request.candidates[0];
    const Candidate& b = request.candidates[request.candidates.size() > 1 ? 1 : 0];
    const auto lattice = static_cast<float>(mesh_.latticeSize());
    const float latticeFromTexel = lattice / static_cast<float>(n);

    for (const LocalMapMesh::Quad& q : mesh_.quads()) {
        std::array<glm::vec3, 4> point;
        std::array<float, 4> weight;
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::vec2 at(q.x + (k & 1) * q.size, q.y + (k >> 1) * q.size);
            const glm::vec3 d = cubeDirection(face, at, mesh_.latticeSize());
            const bool sky = !(q.corner[k] > 1 / skyDistance);
            point[k] = sky ? d * skyDistance : d / q.corner[k];
            const float before = axisWeight(point[k], a.offset, b.offset);
            const auto valid = [&](const Candidate& c) {
                return storedDistance(c, point[k]) + request.depthTolerance >=
                       (sky ? skyDistance : glm::distance(point[k], c.offset));
            };
            const float wa = valid(a) ? before : 0, wb = valid(b) ? 1 - before : 0;
            // Both hidden: the closest one, the one of greater weight before the test (section 4.3).
            weight[k] = wa + wb > 0 ? wa / (wa + wb) : (before >= 0.5f ? 1.0f : 0.0f);
        }
        const auto firstTexel = [&](int l) {
            return static_cast<int>(std::ceil(static_cast<float>(l) / latticeFromTexel - 0.5f));
        };
        const int x0 = firstTexel(q.x), x1 = std::min(n, firstTexel(q.x + q.size));
        const int y0 = firstTexel(q.y), y1 = std::min(n, firstTexel(q.y + q.size));
        for (int y = y0; y < y1; ++y) {
            const float v = ((static_cast<float>(y) + 0.5f) * latticeFromTexel - static_cast<float>(q.y)) /
                            static_cast<float>(q.size);
            for (int x = x0; x < x1; ++x) {
                const float u =
                    ((static_cast<float>(x) + 0.5f) * latticeFromTexel - static_cast<float>(q.x)) /
                    static_cast<float>(q.size);
                const glm::vec3 p =
                    glm::mix(glm::mix(point[0], point[1], u), glm::mix(point[2], point[3], u), v);
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x);
                px_[i] = p.x;
                py_[i] = p.y;
                pz_[i] = p.z;
                weight_[i] =
                    std::lerp(std::lerp(weight[0], weight[1], u), std::lerp(weight[2], weight[3], u), v);
            }
        }
    }
}

void LocalMapBuilder::fillBlend(const LocalMapRequest& request, int face) {
    const int n = request.faceSize;
    const Candidate& a = request.candidates[0];
    const Candidate& b = request.candidates[request.candidates.size() > 1 ? 1 : 0];
    const float weight = axisWeight(glm::vec3(0), a.offset, b.offset);
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const glm::vec3 p = skyDistance * cubeDirection(face, glm::vec2(x, y) + 0.5f, n);
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x);
            px_[i] = p.x;
            py_[i] = p.y;
            pz_[i] = p.z;
            weight_[i] = weight;
        }
    }
}

void LocalMapBuilder::fillBox(const LocalMapRequest& request, int face) {
    const int n = request.faceSize;
    const Candidate& a = request.candidates[0];
    const StreetBox box = streetBoxOf(*a.map, request.streetDirection);
    const glm::vec3 left(-box.forward.y, box.forward.x, 0);
    // The eye in the box's frame; pulled inside, since a ray from outside has no exit to correct for.
    const auto inside = [](float x, float least, float most) {
        const float margin = 0.01f * (most - least);
        return std::clamp(x, least + margin, most - margin);
    };
    const float ex = inside(-glm::dot(a.offset, box.forward), -box.behind, box.ahead);
    const float ey = inside(-glm::dot(a.offset, left), -box.right, box.left);
    const float ez = std::max(-a.offset.z, -box.below + 0.01f);
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const glm::vec3 d = cubeDirection(face, glm::vec2(x, y) + 0.5f, n);
            const float f = glm::dot(d, box.forward), l = glm::dot(d, left);
            float t = skyDistance;
            if (f != 0) t = std::min(t, ((f > 0 ? box.ahead : -box.behind) - ex) / f);
            if (l != 0) t = std::min(t, ((l > 0 ? box.left : -box.right) - ey) / l);
            if (d.z < 0) t = std::min(t, (-box.below - ez) / d.z);
            const glm::vec3 p = t * d;
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x);
            px_[i] = p.x;
            py_[i] = p.y;
            pz_[i] = p.z;
            weight_[i] = 1;
        }
    }
}

std::uint32_t LocalMapBuilder::buildStarts(const GridTracer& tracer, const LocalMapRequest& request, int face,
                                           std::span<float> reciprocal) {
    mesh_.build(tracer, glm::vec3(request.centre), face, request.mesh);
    fillReciprocal(request.faceSize);
    std::copy(reciprocal_.begin(), reciprocal_.end(), reciprocal.begin());
    return mesh_.raysTraced();
}

std::uint32_t LocalMapBuilder::buildFace(const GridTracer& tracer, const LocalMapRequest& request, int face,
                                         LocalMap& map) {
    const int n = request.faceSize;
    const std::size_t offset = map.faceOffset(face);
    const std::size_t texels = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    if (request.candidates.empty()) {
        for (std::vector<float>* plane : {&map.red, &map.green, &map.blue})
            std::fill_n(plane->begin() + static_cast<std::ptrdiff_t>(offset), texels, 0.0f);
        std::fill_n(map.depth.begin() + static_cast<std::ptrdiff_t>(offset), texels,
                    std::numeric_limits<float>::infinity());
        return 0;
    }
    if (request.method == LocalMapMethod::mem) {
        mesh_.build(tracer, glm::vec3(request.centre), face, request.mesh);
        fillReciprocal(n);
        lookUpRefined(face, reciprocal_, request.candidates, request.lookup, map);
        return mesh_.raysTraced();
    }

    resizePlanes(n);
    std::uint32_t rays = 0;
    switch (request.method) {
        case LocalMapMethod::memPaper:
            mesh_.build(tracer, glm::vec3(request.centre), face, request.mesh);
            rays = mesh_.raysTraced();
            fillPaper(request, face);
            break;
        case LocalMapMethod::box:
            fillBox(request, face);
            break;
        default:
            fillBlend(request, face);
            break;
    }
    lookUpBlended(face, px_, py_, pz_, weight_, request.candidates[0],
                  request.candidates[request.candidates.size() > 1 ? 1 : 0], map);
    for (std::size_t i = 0; i < texels; ++i) {
        const float depth = std::max({std::abs(px_[i]), std::abs(py_[i]), std::abs(pz_[i])});
        map.depth[offset + i] = depth >= skyDistance ? std::numeric_limits<float>::infinity() : depth;
    }
    return rays;
}

}  // namespace reflection
