#include "vehicles/models/Levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

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

/// One material for vertices of one position would be needed to move surfaces' borders; instead, each
/// simplification may give up borders by painting triangles of small surfaces like their largest neighbour.
/// Here: all trim lines become paint.
city::Mesh simplified(const city::Mesh& mesh, std::size_t triangles, bool sloppy) {
    city::Mesh out;
    out.vertices = mesh.vertices;
    out.indices.resize(mesh.indices.size());
    const float* positions = &mesh.vertices[0].position.x;
    std::size_t count = 0;
    if (sloppy)
        count =
            meshopt_simplifySloppy(out.indices.data(), mesh.indices.data(), mesh.indices.size(), positions,
                                   vertexCount(mesh), sizeof(city::Vertex), triangles * 3, 1.0f, nullptr);
    else
        count = meshopt_simplify(out.indices.data(), mesh.indices.data(), mesh.indices.size(), positions,
                                 vertexCount(mesh), sizeof(city::Vertex), triangles * 3, 1.0f, 0, nullptr);
    out.indices.resize(count);
    return out;
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
    struct Ball {
        glm::vec3 centre;
        float radius;
    };
    std::vector<Ball> balls;
    const auto at = [&](const city::Mesh& m, std::size_t i) { return m.vertices[m.indices[i]].position; };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::vec3 a = at(mesh, i), b = at(mesh, i + 1), c = at(mesh, i + 2),
                        centre = (a + b + c) / 3.0f;
        balls.push_back(
            {centre, std::max({glm::length(a - centre), glm::length(b - centre), glm::length(c - centre)})});
    }
    const std::size_t stride =
        std::max<std::size_t>(1, 2 * reference.triangleCount() / std::max<std::size_t>(samples, 1));
    float worst = 0;
    for (std::size_t t = 0; t < reference.triangleCount(); t += stride) {
        if (reference.vertices[reference.indices[3 * t]].material ==
            static_cast<std::uint32_t>(Surface::interior))
            continue;
        const glm::vec3 a = at(reference, 3 * t),
                        middle = (a + at(reference, 3 * t + 1) + at(reference, 3 * t + 2)) / 3.0f;
        for (const glm::vec3& p : {a, middle}) {
            float best = std::numeric_limits<float>::max();  // squared
            for (std::size_t i = 0; i < balls.size(); ++i) {
                const glm::vec3 d = p - balls[i].centre;
                const float reach = std::sqrt(best) + balls[i].radius;
                if (glm::dot(d, d) > reach * reach) continue;
                best = std::min(
                    best, squaredDistance(p, at(mesh, 3 * i), at(mesh, 3 * i + 1), at(mesh, 3 * i + 2)));
            }
            worst = std::max(worst, best);
        }
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

void makeLevels(VehicleModel& model, const city::Mesh& plainWheel, const LevelPlan& plan) {
    optimise(model.wheel);
    model.levels.resize(1);
    optimise(model.levels[0].body);
    const city::Mesh finest = model.levels[0].body;
    const city::Mesh whole = withWheels(finest, model, model.wheel);
    // Parts smaller than this share of the length are left out of the far levels.
    const float small[3] = {0, 0.03f * model.length, 0.12f * model.length};
    float error = 0;
    for (int k = 0; k < 3; ++k) {
        const bool far = k > 0;
        const std::size_t wheels = far ? plainWheel.triangleCount() * model.wheels.size() : 0;
        const std::size_t target =
            std::max<std::size_t>(plan.triangles[k] > wheels ? plan.triangles[k] - wheels : 0, 60);
        if (finest.triangleCount() <= target) continue;
        city::Mesh body = withoutSmallPieces(finest, small[k], !far);
        city::Mesh coarse = simplified(body, target, false);
        if (coarse.triangleCount() > target + target / 3) coarse = simplified(body, target, true);
        if (far) coarse = withWheels(coarse, model, plainWheel);
        optimise(coarse);
        if (coarse.empty() || coarse.triangleCount() >= model.levels.back().body.triangleCount()) continue;
        // A farther level is never said to be nearer the truth than a finer one.
        error = std::max(distanceBetween(far ? whole : finest, coarse), error);
        model.levels.push_back({std::move(coarse), far, error});
    }
}

}  // namespace vehicles
