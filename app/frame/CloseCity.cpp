#include "app/frame/CloseCity.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <unordered_map>

namespace app {

namespace {

bool touches(const city::Aabb& a, const glm::vec3& low, const glm::vec3& high) {
    return !a.empty() && glm::all(glm::lessThanEqual(a.min, high)) &&
           glm::all(glm::greaterThanEqual(a.max, low));
}

city::Vertex between(const city::Vertex& a, const city::Vertex& b, float t) {
    city::Vertex v = a;
    v.position = glm::mix(a.position, b.position, t);
    v.normal = glm::mix(a.normal, b.normal, t);
    v.texcoord = glm::mix(a.texcoord, b.texcoord, t);
    return v;
}

/// Triangles around a place, cut off at its box, in meshes of a few hundred.
class Patch {
  public:
    Patch(const std::vector<city::Material>& materials, CloseCityPatch& patch)
        : materials_(materials), patch_(patch), half_(static_cast<float>(patch.reach)) {}

    /// `toWorld` null: the mesh is in the world already.
    void add(const city::Mesh& mesh, const glm::mat4* toWorld) {
        known_[0].clear();
        known_[1].clear();
        const glm::mat3 turn = toWorld != nullptr ? glm::mat3(*toWorld) : glm::mat3(1);
        const auto placed = [&](std::uint32_t i) {
            city::Vertex v = mesh.vertices[i];
            if (toWorld != nullptr) {
                v.position = glm::vec3(*toWorld * glm::vec4(v.position, 1));
                const glm::vec3 n = turn * v.normal;
                const float length = glm::length(n);
                if (length > 0) v.normal = n / length;
            }
            v.position = glm::vec3(glm::dvec3(v.position) - patch_.place);
            return v;
        };
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            const std::array<std::uint32_t, 3> t{mesh.indices[k], mesh.indices[k + 1], mesh.indices[k + 2]};
            const std::array<city::Vertex, 3> v{placed(t[0]), placed(t[1]), placed(t[2])};
            const glm::vec3 low = glm::min(v[0].position, glm::min(v[1].position, v[2].position));
            const glm::vec3 high = glm::max(v[0].position, glm::max(v[1].position, v[2].position));
            const glm::vec3 nearest = glm::clamp(glm::vec3(0), low, high);
            if (glm::dot(nearest, nearest) > half_ * half_) continue;
            const bool whole = glm::all(glm::greaterThanEqual(low, glm::vec3(-half_))) &&
                               glm::all(glm::lessThanEqual(high, glm::vec3(half_)));
            const bool holes = v[0].material < materials_.size() && materials_[v[0].material].cutout;
            city::Mesh& into = meshFor(holes);
            if (whole) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto [at, isNew] = known_[holes ? 1 : 0].try_emplace(
                        t[c], static_cast<std::uint32_t>(into.vertices.size()));
                    if (isNew) into.vertices.push_back(v[c]);
                    into.indices.push_back(at->second);
                }
                continue;
            }
            cut(v);
            for (std::size_t c = 2; c < polygon_.size(); ++c)
                into.addTriangle(polygon_[0], polygon_[c - 1], polygon_[c]);
        }
    }

    /// What comes next has meshes of its own.
    void part() { parted_ = {true, true}; }

  private:
    city::Mesh& meshFor(bool holes) {
        std::vector<city::Mesh>& meshes = holes ? patch_.cutout : patch_.solid;
        bool& parted = parted_[holes ? 1 : 0];
        if (meshes.empty() || parted || meshes.back().triangleCount() >= CloseCity::mostTriangles) {
            meshes.emplace_back();
            known_[holes ? 1 : 0].clear();
            parted = false;
        }
        return meshes.back();
    }
    void cut(const std::array<city::Vertex, 3>& triangle) {
        polygon_.assign(triangle.begin(), triangle.end());
        for (int axis = 0; axis < 3; ++axis)
            for (const float sign : {1.f, -1.f}) {
                next_.clear();
                for (std::size_t i = 0; i < polygon_.size(); ++i) {
                    const city::Vertex& a = polygon_[i];
                    const city::Vertex& b = polygon_[(i + 1) % polygon_.size()];
                    const float da = half_ - sign * a.position[axis], db = half_ - sign * b.position[axis];
                    if (da >= 0) next_.push_back(a);
                    if ((da >= 0) != (db >= 0)) next_.push_back(between(a, b, da / (da - db)));
                }
                polygon_.swap(next_);
            }
    }

    const std::vector<city::Material>& materials_;
    CloseCityPatch& patch_;
    float half_;
    std::vector<city::Vertex> polygon_, next_;
    std::array<std::unordered_map<std::uint32_t, std::uint32_t>, 2> known_;  ///< of the last mesh of a kind
    std::array<bool, 2> parted_{};
};

}  // namespace

std::size_t CloseCityPatch::triangles() const {
    std::size_t count = 0;
    for (const auto* meshes : {&solid, &cutout})
        for (const city::Mesh& mesh : *meshes) count += mesh.triangleCount();
    return count;
}

CloseCity::CloseCity(const city::CityModel& city) : city_(city) {
    std::vector<city::Aabb> boxes;
    for (const city::Prototype& prototype : city.prototypes) {
        city::Aabb& box = boxes.emplace_back();
        for (const city::Prototype::Level& level : prototype.levels) box.extend(level.mesh.bounds());
    }
    for (const city::Placement& placement : city.placements) {
        city::Aabb& box = placements_.emplace_back();
        if (placement.prototype >= boxes.size() || boxes[placement.prototype].empty()) continue;
        const city::Aabb& own = boxes[placement.prototype];
        for (int corner = 0; corner < 8; ++corner)
            box.extend(glm::vec3(placement.worldFromPrototype *
                                 glm::vec4((corner & 1) != 0 ? own.max.x : own.min.x,
                                           (corner & 2) != 0 ? own.max.y : own.min.y,
                                           (corner & 4) != 0 ? own.max.z : own.min.z, 1)));
    }
}

CloseCityPatch CloseCity::gather(const glm::dvec3& place, double reach, const Allowed& allowed) const {
    CloseCityPatch patch;
    patch.place = place;
    patch.reach = reach;
    const glm::vec3 low(place - reach), high(place + reach);
    Patch cutter(city_.materials, patch);
    for (const city::Chunk& chunk : city_.chunks)
        if (touches(chunk.bounds, low, high)) cutter.add(chunk.mesh, nullptr);
    const auto half = static_cast<float>(reach);
    for (std::size_t i = 0; i < city_.placements.size(); ++i) {
        const city::Aabb& box = placements_[i];
        if (!touches(box, low, high)) continue;
        const city::Placement& placed = city_.placements[i];
        const std::vector<city::Prototype::Level>& levels = city_.prototypes[placed.prototype].levels;
        city::Aabb around;
        around.extend(glm::max(glm::vec3(glm::dvec3(box.min) - place), glm::vec3(-half)));
        around.extend(glm::min(glm::vec3(glm::dvec3(box.max) - place), glm::vec3(half)));
        std::size_t level = 0;
        if (levels.size() > 1) {
            const double off = allowed(around);
            while (level + 1 < levels.size() && static_cast<double>(levels[level + 1].error) <= off) ++level;
        }
        cutter.part();
        cutter.add(levels[level].mesh, &placed.worldFromPrototype);
    }
    return patch;
}

}  // namespace app
