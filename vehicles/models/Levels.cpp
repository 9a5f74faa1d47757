#include "vehicles/models/Levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "vehicles/models/Wheel.h"

namespace vehicles {
namespace {

/// The point of a triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5), as the squared
/// distance.
float squaredDistance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto square = [](const glm::vec3& v) { return glm::dot(v, v); };
    const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return square(ap);
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return square(bp);
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return square(ap - d1 / (d1 - d3) * ab);
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return square(cp);
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return square(ap - d2 / (d2 - d6) * ac);
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return square(bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
    const float sum = va + vb + vc;
    if (!(sum > 0)) return square(ap);
    return square(ap - vb / sum * ab - vc / sum * ac);
}

/// A mesh's triangles with balls around them, which tell most of them apart without their points.
class TriangleBalls {
  public:
    explicit TriangleBalls(const city::Mesh& mesh) : mesh_(mesh) {
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const glm::vec3 a = at(i), b = at(i + 1), c = at(i + 2), centre = (a + b + c) / 3.0f;
            balls_.push_back({centre, std::max({glm::length(a - centre), glm::length(b - centre),
                                                glm::length(c - centre)})});
        }
    }
    struct Nearest {
        float squared = std::numeric_limits<float>::max();
        std::size_t triangle = 0;
    };
    Nearest nearest(const glm::vec3& p) const {
        Nearest best;
        for (std::size_t t = 0; t < balls_.size(); ++t) {
            const glm::vec3 d = p - balls_[t].centre;
            const float reach = std::sqrt(best.squared) + balls_[t].radius;
            if (glm::dot(d, d) > reach * reach) continue;
            const float squared = squaredDistance(p, at(3 * t), at(3 * t + 1), at(3 * t + 2));
            if (squared < best.squared) best = {squared, t};
        }
        return best;
    }

  private:
    struct Ball {
        glm::vec3 centre;
        float radius;
    };
    const glm::vec3& at(std::size_t i) const { return mesh_.vertices[mesh_.indices[i]].position; }

    const city::Mesh& mesh_;
    std::vector<Ball> balls_;
};

std::size_t vertexCount(const city::Mesh& mesh) {
    return mesh.vertices.size();
}

/// Connected pieces by shared position, as piece numbers of the vertices.
std::vector<std::uint32_t> pieces(const city::Mesh& mesh) {
    std::vector<glm::vec3> positions;
    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
    std::vector<std::uint32_t> same(positions.size());
    meshopt_generateVertexRemap(same.data(), nullptr, positions.size(), positions.data(), positions.size(),
                                sizeof(glm::vec3));
    std::vector<std::uint32_t> root(positions.size());
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](std::uint32_t i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (int k = 1; k < 3; ++k) root[find(same[mesh.indices[i]])] = find(same[mesh.indices[i + k]]);
    std::vector<std::uint32_t> piece(positions.size());
    for (std::uint32_t i = 0; i < piece.size(); ++i) piece[i] = find(same[i]);
    return piece;
}

/// Without connected pieces smaller than a size (the diagonal of their box), and without the interior if
/// asked.
city::Mesh withoutSmallPieces(const city::Mesh& mesh, float size, bool withInterior) {
    const auto piece = pieces(mesh);
    std::vector<city::Aabb> boxes(vertexCount(mesh));
    for (std::size_t i = 0; i < vertexCount(mesh); ++i) boxes[piece[i]].extend(mesh.vertices[i].position);
    city::Mesh out;
    out.vertices = mesh.vertices;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto v = mesh.indices[i];
        if (glm::length(boxes[piece[v]].size()) < size) continue;
        if (!withInterior && mesh.vertices[v].material == static_cast<std::uint32_t>(Surface::interior))
            continue;
        out.indices.insert(out.indices.end(), {v, mesh.indices[i + 1], mesh.indices[i + 2]});
    }
    return out;
}

city::Mesh simplified(const city::Mesh& mesh, std::size_t triangles) {
    // meshoptimizer ends the program when asked for more triangles than there are.
    if (mesh.triangleCount() <= triangles) return mesh;
    city::Mesh out;
    out.vertices = mesh.vertices;
    out.indices.resize(mesh.indices.size());
    out.indices.resize(meshopt_simplify(out.indices.data(), mesh.indices.data(), mesh.indices.size(),
                                        &mesh.vertices[0].position.x, vertexCount(mesh), sizeof(city::Vertex),
                                        triangles * 3, 1.0f, 0, nullptr));
    return out;
}

/// Triangles given corner by corner, equal corners shared.
city::Mesh indexed(const std::vector<city::Vertex>& corners) {
    city::Mesh out;
    if (corners.empty()) return out;
    out.indices.resize(corners.size());
    out.vertices.resize(meshopt_generateVertexRemap(out.indices.data(), nullptr, corners.size(),
                                                    corners.data(), corners.size(), sizeof(city::Vertex)));
    meshopt_remapVertexBuffer(out.vertices.data(), corners.data(), corners.size(), sizeof(city::Vertex),
                              out.indices.data());
    return out;
}

/// Simplified without regard to surfaces; each triangle then takes the surface nearest to its middle.
city::Mesh simplifiedAcross(const city::Mesh& mesh, std::size_t triangles) {
    if (mesh.empty()) return mesh;
    std::vector<glm::vec3> positions;
    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
    std::vector<std::uint32_t> same(positions.size());
    const std::size_t count = meshopt_generateVertexRemap(
        same.data(), nullptr, positions.size(), positions.data(), positions.size(), sizeof(glm::vec3));
    city::Mesh shared;
    shared.vertices.resize(count);
    for (std::size_t i = 0; i < positions.size(); ++i) shared.vertices[same[i]] = mesh.vertices[i];
    for (const auto i : mesh.indices) shared.indices.push_back(same[i]);
    const city::Mesh coarse = simplified(shared, triangles);
    const TriangleBalls balls(mesh);
    std::vector<city::Vertex> corners;
    for (std::size_t i = 0; i + 2 < coarse.indices.size(); i += 3) {
        glm::vec3 middle{0};
        for (int k = 0; k < 3; ++k) middle += coarse.vertices[coarse.indices[i + k]].position / 3.0f;
        const std::size_t nearest = balls.nearest(middle).triangle;
        const std::uint32_t material = mesh.vertices[mesh.indices[3 * nearest]].material;
        for (int k = 0; k < 3; ++k) {
            corners.push_back(coarse.vertices[coarse.indices[i + k]]);
            corners.back().material = material;
        }
    }
    return indexed(corners);
}

/// As many triangles as asked, or up to twice that where the shape then is as near (to a centimetre) and
/// keeps its surfaces' borders: a lamp cut in half shows at a distance at which a centimetre does not.
city::Mesh simplifiedForFar(const city::Mesh& body, std::size_t triangles) {
    city::Mesh across = simplifiedAcross(body, triangles);
    const float reached = distanceBetween(body, across) + 0.01f;
    for (const std::size_t more : {triangles, triangles * 3 / 2, triangles * 2}) {
        city::Mesh bordered = simplified(body, more);
        if (bordered.triangleCount() <= more && distanceBetween(body, bordered) <= reached) return bordered;
    }
    return across;
}

WheelShape shapeOf(const VehicleModel& model) {
    WheelShape shape{
        .radius = model.wheelRadius, .width = 0.2f, .rimRadius = 0.66f * model.wheelRadius, .tyre = false};
    if (model.wheel.empty()) return shape;
    shape.width = model.wheel.bounds().size().y;
    for (const city::Vertex& v : model.wheel.vertices)
        shape.tyre = shape.tyre || v.material == static_cast<std::uint32_t>(Surface::tyre);
    return shape;
}

}  // namespace

void optimise(city::Mesh& mesh) {
    if (mesh.indices.empty()) {
        mesh.vertices.clear();
        return;
    }
    auto& indices = mesh.indices;
    meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), vertexCount(mesh));
    std::vector<city::Vertex> ordered(vertexCount(mesh));
    const std::size_t used =
        meshopt_optimizeVertexFetch(ordered.data(), indices.data(), indices.size(), mesh.vertices.data(),
                                    vertexCount(mesh), sizeof(city::Vertex));
    ordered.resize(used);
    mesh.vertices = std::move(ordered);
}

float distanceBetween(const city::Mesh& reference, const city::Mesh& mesh, std::size_t samples) {
    if (reference.empty()) return 0;
    if (mesh.empty()) return std::numeric_limits<float>::infinity();
    const TriangleBalls balls(mesh);
    const auto at = [&](std::size_t i) { return reference.vertices[reference.indices[i]].position; };
    const std::size_t stride =
        std::max<std::size_t>(1, 2 * reference.triangleCount() / std::max<std::size_t>(samples, 1));
    float worst = 0;
    for (std::size_t t = 0; t < reference.triangleCount(); t += stride) {
        if (reference.vertices[reference.indices[3 * t]].material ==
            static_cast<std::uint32_t>(Surface::interior))
            continue;
        const glm::vec3 a = at(3 * t), middle = (a + at(3 * t + 1) + at(3 * t + 2)) / 3.0f;
        for (const glm::vec3& p : {a, middle}) worst = std::max(worst, balls.nearest(p).squared);
    }
    return std::sqrt(worst);
}

city::Mesh withWheels(const city::Mesh& body, const VehicleModel& model, const city::Mesh& wheel) {
    city::Mesh out = body;
    for (const VehicleModel::Wheel& w : model.wheels) {
        city::Mesh placed = wheel;
        const float turn = w.mirrored ? -1.0f : 1.0f;
        for (city::Vertex& v : placed.vertices) {
            v.position = w.centre + glm::vec3(turn * v.position.x, turn * v.position.y, v.position.z);
            v.normal = {turn * v.normal.x, turn * v.normal.y, v.normal.z};
        }
        out.append(placed);
    }
    return out;
}

city::Mesh withoutThinPieces(const city::Mesh& mesh, float thickness) {
    const std::size_t faces = mesh.triangleCount();
    std::vector<glm::vec3> positions;
    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
    std::vector<std::uint32_t> same(positions.size());
    if (mesh.empty()) return mesh;
    meshopt_generateVertexRemap(same.data(), nullptr, positions.size(), positions.data(), positions.size(),
                                sizeof(glm::vec3));
    struct Edge {
        std::uint32_t a, b, face;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * faces);
    for (std::uint32_t f = 0; f < faces; ++f)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const auto a = same[mesh.indices[3 * f + k]], b = same[mesh.indices[3 * f + (k + 1) % 3]];
            edges.push_back({std::min(a, b), std::max(a, b), f});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
        return std::tie(x.a, x.b, x.face) < std::tie(y.a, y.b, y.face);
    });
    std::vector<glm::vec3> byGroup(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) byGroup[same[i]] = positions[i];
    std::vector<std::uint32_t> surface(faces);
    for (std::size_t f = 0; f < faces; ++f) surface[f] = mesh.vertices[mesh.indices[3 * f]].material;
    // Connected pieces of one surface.
    std::vector<std::uint32_t> root(faces);
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](std::uint32_t i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    const auto joins = [&](std::size_t i) {
        return i > 0 && edges[i].a == edges[i - 1].a && edges[i].b == edges[i - 1].b;
    };
    for (std::size_t i = 1; i < edges.size(); ++i)
        if (joins(i) && surface[edges[i].face] == surface[edges[i - 1].face])
            root[find(edges[i].face)] = find(edges[i - 1].face);
    std::vector<float> area(faces, 0), outline(faces, 0);
    std::map<std::pair<std::uint32_t, std::uint32_t>, float>
        shared;  // piece and the neighbour's surface: border in metres
    for (std::uint32_t f = 0; f < faces; ++f) {
        const std::uint32_t* corner = mesh.indices.data() + std::size_t{3} * f;
        const glm::vec3 a = positions[corner[0]], b = positions[corner[1]], c = positions[corner[2]];
        area[find(f)] += 0.5f * glm::length(glm::cross(b - a, c - a));
    }
    for (std::size_t i = 1; i < edges.size(); ++i) {
        if (!joins(i)) continue;
        const auto f = edges[i].face, g = edges[i - 1].face;
        if (surface[f] == surface[g]) continue;
        const float length = glm::length(byGroup[edges[i].a] - byGroup[edges[i].b]);
        for (const auto& [own, other] : {std::pair{f, g}, std::pair{g, f}}) {
            outline[find(own)] += length;
            shared[{find(own), surface[other]}] += length;
        }
    }
    std::map<std::uint32_t, std::pair<float, std::uint32_t>> replacement;
    for (const auto& [who, length] : shared) {
        const auto [piece, other] = who;
        // Lamps tell from afar where a vehicle is going: they are given up later than all else.
        const bool lamp = surface[piece] == static_cast<std::uint32_t>(Surface::headLamp) ||
                          surface[piece] == static_cast<std::uint32_t>(Surface::tailLamp);
        if (2 * area[piece] >= (lamp ? 0.5f : 1.0f) * thickness * outline[piece]) continue;
        auto& best = replacement[piece];
        if (length > best.first) best = {length, other};
    }
    std::vector<city::Vertex> corners;
    corners.reserve(mesh.indices.size());
    for (std::uint32_t f = 0; f < faces; ++f) {
        const auto found = replacement.find(find(f));
        for (int k = 0; k < 3; ++k) {
            corners.push_back(mesh.vertices[mesh.indices[3 * f + k]]);
            corners.back().material = found == replacement.end() ? surface[f] : found->second.second;
        }
    }
    return indexed(corners);
}

void makeLevels(VehicleModel& model, const LevelPlan& plan) {
    model.levels.resize(1);
    optimise(model.levels[0].body);
    optimise(model.wheel);
    const city::Mesh finest = model.levels[0].body;
    if (finest.empty()) return;
    // Wheels as they are seen from outside: their inner sides would count as lost.
    const city::Mesh whole = withWheels(
        finest, model, model.wheel.empty() ? model.wheel : plainWheelMesh(shapeOf(model), 32, true));
    struct Step {
        float thin;    // metres: pieces of surface thinner than this are painted over
        float small;   // metres: separate parts smaller than this are dropped
        int segments;  // of a plain wheel
        bool rim;
    };
    static constexpr Step steps[3] = {
        {0.012f, 0.0f, 0, false}, {0.10f, 0.22f, 8, true}, {0.12f, 0.36f, 6, false}};
    float error = 0;
    for (int k = 0; k < 3; ++k) {
        const Step& step = steps[k];
        const bool far = k > 0;
        city::Mesh wheel;
        if (far && !model.wheel.empty()) wheel = plainWheelMesh(shapeOf(model), step.segments, step.rim);
        const std::size_t wheels = wheel.triangleCount() * model.wheels.size();
        const std::size_t target =
            std::max<std::size_t>(plan.triangles[k] > wheels ? plan.triangles[k] - wheels : 0, 100);
        if (finest.triangleCount() <= target) continue;
        city::Mesh body = withoutSmallPieces(finest, step.small, k < 2);
        // Seals first, so that what they surround is then joined to what lies beyond them.
        if (far) body = withoutThinPieces(body, steps[0].thin * 2);
        body = withoutThinPieces(body, step.thin);
        // Farthest off, borders of surfaces follow the shape's triangles: kept as borders, they would use up
        // the few there are.
        city::Mesh coarse = k == 0   ? simplified(body, target)
                            : k == 1 ? simplifiedForFar(body, target)
                                     : simplifiedAcross(body, target);
        if (far) coarse = withWheels(coarse, model, wheel);
        optimise(coarse);
        if (coarse.empty() || coarse.triangleCount() >= model.levels.back().body.triangleCount()) continue;
        // A farther level is never said to be nearer the truth than a finer one.
        error = std::max(distanceBetween(far ? whole : finest, coarse), error);
        model.levels.push_back({std::move(coarse), far, error});
    }
}

}  // namespace vehicles
