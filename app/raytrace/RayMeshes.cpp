#include "app/raytrace/RayMeshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "app/render/VertexFormats.h"

namespace app {

namespace {

/// Triangles up to which the city with its placements is one mesh: some 100 bytes each in Embree.
constexpr std::size_t mostTriangles = 6'000'000;

enum Coverage : std::size_t { solid, twoSided, cutout, coverages };

/// What the vertex buffer keeps of a normal.
glm::vec3 drawnNormal(const glm::vec3& n) {
    const std::uint32_t packed = packNormal(n);
    const auto part = [&](int shift) {
        const auto bits = static_cast<std::int32_t>((packed >> shift) & 0x3ffu);
        return std::max(static_cast<float>(bits >= 512 ? bits - 1024 : bits) / 511.0f, -1.0f);
    };
    return {part(0), part(10), part(20)};
}

/// The lamp's disc out of a square.
class Disc final : public reflection::Holes {
  public:
    bool openAt(std::uint32_t triangle, float u, float v, float) const override {
        // Corners of the square: (-1,-1) (1,-1) (1,1) and (-1,-1) (1,1) (-1,1).
        const float x = triangle == 0 ? -1 + 2 * u + 2 * v : -1 + 2 * u;
        const float y = triangle == 0 ? -1 + 2 * v : -1 + 2 * u + 2 * v;
        return x * x + y * y > 1;
    }
};

}  // namespace

/// Leaves and the like: open where the pattern's opacity is below one half.
class RayMeshes::Cutout final : public reflection::Holes {
  public:
    Cutout(const RayMeshes& owner, const city::Mesh& mesh) : owner_(owner), mesh_(mesh) {
        // Repeats of the pattern for each metre, by area.
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const city::Vertex& a = mesh.vertices[mesh.indices[i]];
            const city::Vertex& b = mesh.vertices[mesh.indices[i + 1]];
            const city::Vertex& c = mesh.vertices[mesh.indices[i + 2]];
            const float area = glm::length(glm::cross(b.position - a.position, c.position - a.position));
            const glm::vec2 s = b.texcoord - a.texcoord, t = c.texcoord - a.texcoord;
            const float repeats = std::abs(s.x * t.y - s.y * t.x);
            density_.push_back(area > 0 ? std::sqrt(repeats / area) : 0);
        }
    }
    bool openAt(std::uint32_t triangle, float u, float v, float footprint) const override {
        const std::uint32_t* corner = &mesh_.indices[3 * std::size_t{triangle}];
        const city::Vertex& a = mesh_.vertices[corner[0]];
        const city::Vertex& b = mesh_.vertices[corner[1]];
        const city::Vertex& c = mesh_.vertices[corner[2]];
        const glm::vec2 at = a.texcoord * (1 - u - v) + b.texcoord * u + c.texcoord * v;
        if (c.material >= owner_.city_.materials.size()) return false;
        const auto pattern = static_cast<std::uint32_t>(owner_.city_.materials[c.material].pattern);
        const PatternSampler::Level level =
            owner_.patterns_.levelOf(footprint * density_[triangle], TextureFilter::standard);
        return owner_.patterns_.opacityAt(pattern, at, level) < 0.5f;
    }

  private:
    const RayMeshes& owner_;
    const city::Mesh& mesh_;
    std::vector<float> density_;
};

struct RayMeshes::Parts {
    std::array<city::Mesh, coverages> meshes;
    std::unique_ptr<reflection::Holes> holes;
};

RayMeshes::~RayMeshes() = default;

const city::Mesh& RayMeshes::part(std::uint32_t mesh, std::uint32_t part) const {
    return parts_[mesh]->meshes[part];
}

std::uint32_t RayMeshes::add(std::unique_ptr<Parts> parts) {
    if (!parts->meshes[cutout].empty() && !parts->holes)
        parts->holes = std::make_unique<Cutout>(*this, parts->meshes[cutout]);
    const std::array<reflection::TracedMeshes::Part, coverages> traced{
        {{&parts->meshes[solid], false, nullptr},
         {&parts->meshes[twoSided], true, nullptr},
         {&parts->meshes[cutout], true, parts->holes.get()}}};
    parts_.push_back(std::move(parts));
    return traced_.add(traced);
}

void RayMeshes::append(Parts& parts, const city::Mesh& mesh, const glm::mat4* worldFromMesh) const {
    std::array<city::Mesh*, coverages> into{};
    std::array<std::vector<std::uint32_t>, coverages> places;
    for (std::size_t c = 0; c < coverages; ++c) into[c] = &parts.meshes[c];
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t material = mesh.vertices[mesh.indices[i]].material;
        Coverage c = solid;
        if (material < city_.materials.size()) {
            const city::Material& m = city_.materials[material];
            c = m.cutout ? cutout : m.twoSided ? twoSided : solid;
        }
        std::vector<std::uint32_t>& place = places[c];
        if (place.empty()) place.assign(mesh.vertices.size(), none);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t index = mesh.indices[i + k];
            if (place[index] == none) {
                place[index] = static_cast<std::uint32_t>(into[c]->vertices.size());
                city::Vertex v = mesh.vertices[index];
                v.normal = drawnNormal(v.normal);
                if (worldFromMesh != nullptr) {
                    v.position = glm::vec3(*worldFromMesh * glm::vec4(v.position, 1));
                    v.normal = glm::normalize(glm::mat3(*worldFromMesh) * v.normal);
                }
                into[c]->vertices.push_back(v);
            }
            into[c]->indices.push_back(place[index]);
        }
    }
}

RayMeshes::RayMeshes(const city::CityModel& city, std::span<const vehicles::VehicleModel> models)
    : city_(city) {
    auto chunks = std::make_unique<Parts>();
    std::size_t triangles = 0;
    for (const bool ground : {true, false}) {
        for (const city::Chunk& chunk : city.chunks) {
            if ((chunk.kind == city::ChunkKind::ground) != ground) continue;
            append(*chunks, chunk.mesh, nullptr);
            triangles += chunk.mesh.triangleCount();
        }
        if (ground) groundTriangles_ = static_cast<std::uint32_t>(chunks->meshes[solid].triangleCount());
    }
    for (const city::Placement& placement : city.placements)
        if (placement.prototype < city.prototypes.size() &&
            !city.prototypes[placement.prototype].levels.empty())
            triangles += city.prototypes[placement.prototype].levels.front().mesh.triangleCount();
    if (triangles <= mostTriangles) {
        auto whole = std::make_unique<Parts>();
        whole->meshes = chunks->meshes;
        for (const city::Placement& placement : city.placements)
            if (placement.prototype < city.prototypes.size() &&
                !city.prototypes[placement.prototype].levels.empty())
                append(*whole, city.prototypes[placement.prototype].levels.front().mesh,
                       &placement.worldFromPrototype);
        whole_ = add(std::move(whole));
    }
    chunks_ = add(std::move(chunks));

    for (const city::Prototype& prototype : city.prototypes) {
        Prototype& p = prototypes_.emplace_back();
        city::Aabb box;
        for (const auto& level : prototype.levels) {
            box.extend(level.mesh.bounds());
            auto parts = std::make_unique<Parts>();
            append(*parts, level.mesh, nullptr);
            p.levels.push_back({add(std::move(parts)), level.error});
        }
        if (box.empty()) continue;
        p.centre = box.centre();
        for (const auto& level : prototype.levels)
            for (const city::Vertex& v : level.mesh.vertices)
                p.radius = std::max(p.radius, glm::length(v.position - p.centre));
    }

    for (const vehicles::VehicleModel& model : models) {
        Vehicle& vehicle = vehicles_.emplace_back();
        vehicle.levels = vehicleLevels(model);
        const auto addLevel = [&](const VehicleLevels::Level& level) {
            auto parts = std::make_unique<Parts>();
            city::Mesh& mesh = parts->meshes[solid];
            mesh.vertices = level.vertices->vertices;
            mesh.indices = level.indices;
            constexpr auto last = static_cast<std::uint32_t>(vehicles::Surface::count) - 1;
            for (city::Vertex& v : mesh.vertices) {
                v.normal = drawnNormal(v.normal);
                v.material = std::min(v.material, last);
            }
            return add(std::move(parts));
        };
        for (const auto& level : vehicle.levels.bodies) vehicle.bodies.push_back(addLevel(level));
        for (const auto& level : vehicle.levels.wheels) vehicle.wheels.push_back(addLevel(level));
    }

    auto lamp = std::make_unique<Parts>();
    const auto corner = [](float y, float z) { return city::Vertex{{0, y, z}, {1, 0, 0}, {y, z}, 0}; };
    // One-sided with holes: the part of leaves is two-sided, but lamps sit before their housings.
    lamp->meshes[cutout].addQuad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
    lamp->holes = std::make_unique<Disc>();
    lamp_ = add(std::move(lamp));
}

}  // namespace app
