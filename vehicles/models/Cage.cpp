#include "vehicles/models/Cage.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#pragma GCC diagnostic pop

#include <cstdlib>
#include <glm/geometric.hpp>
#include <map>
#include <memory>

namespace vehicles {
namespace {

namespace Far = OpenSubdiv::Far;

/// What the refiner adds up.
struct Point {
    glm::vec3 value{0};
    void Clear(void* = nullptr) { value = glm::vec3(0); }
    void AddWithWeight(const Point& other, float weight) { value += weight * other.value; }
};

using Lattice = std::array<int, 3>;

/// Columns' distance from the middle as a share of the rail's: closer towards the rail, where the surface
/// turns.
constexpr float columnShare[Cage::columns + 1] = {0, 0.42f, 0.78f, 1};

glm::vec3 sidePoint(const Station& s, int level) {
    const glm::vec3* points[] = {&s.rail, &s.belt, &s.shoulder, &s.waist, &s.rocker, &s.sill};
    return *points[level];
}

glm::vec3 cagePoint(const Cage& cage, const Lattice& at) {
    const int last = static_cast<int>(cage.stations.size()) - 1;
    const Station& s = cage.stations[at[0]];
    const float side = at[1] < 0 ? -1.0f : 1.0f;
    const float share = columnShare[std::abs(at[1])];
    const glm::vec3 edge = sidePoint(s, at[2]);
    // Across the vehicle, height and length follow a parabola from the middle to the edge.
    glm::vec3 middle{edge.x, 0, edge.z};
    if (at[2] == 0)
        middle = {s.centre.x, 0, s.centre.y};
    else if (at[0] == 0)
        middle.x = cage.frontX[at[2]];
    else if (at[0] == last)
        middle.x = cage.rearX[at[2]];
    const float bow = share * share;
    return {middle.x + bow * (edge.x - middle.x), side * share * edge.y,
            middle.z + bow * (edge.z - middle.z)};
}

/// The quads of the box's six faces, counter-clockwise from outside.
class Topology {
  public:
    explicit Topology(const Cage& cage) : cage_(cage) {
        const int last = static_cast<int>(cage.stations.size()) - 1;
        const int c = Cage::columns, l = Cage::levels;
        for (int i = 0; i < last; ++i) {
            for (int y = -c; y < c; ++y) {
                face({i, y, 0}, {i + 1, y, 0}, {i + 1, y + 1, 0}, {i, y + 1, 0});
                face({i, y, l}, {i, y + 1, l}, {i + 1, y + 1, l}, {i + 1, y, l});
            }
            for (int z = 0; z < l; ++z) {
                face({i, c, z}, {i + 1, c, z}, {i + 1, c, z + 1}, {i, c, z + 1});
                face({i, -c, z}, {i, -c, z + 1}, {i + 1, -c, z + 1}, {i + 1, -c, z});
            }
        }
        for (int y = -c; y < c; ++y)
            for (int z = 0; z < l; ++z) {
                face({0, y, z}, {0, y + 1, z}, {0, y + 1, z + 1}, {0, y, z + 1});
                face({last, y, z}, {last, y, z + 1}, {last, y + 1, z + 1}, {last, y + 1, z});
            }
        for (const Crease& crease : cage.creases) {
            addCrease(crease, 1);
            addCrease(crease, -1);
        }
    }

    std::unique_ptr<Far::TopologyRefiner> refiner() const {
        Far::TopologyDescriptor descriptor;
        descriptor.numVertices = static_cast<int>(points_.size());
        descriptor.numFaces = static_cast<int>(corners_.size() / 4);
        const std::vector<int> perFace(corners_.size() / 4, 4);
        descriptor.numVertsPerFace = perFace.data();
        descriptor.vertIndicesPerFace = corners_.data();
        descriptor.numCreases = static_cast<int>(sharpness_.size());
        descriptor.creaseVertexIndexPairs = creases_.data();
        descriptor.creaseWeights = sharpness_.data();
        using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
        OpenSubdiv::Sdc::Options options;
        options.SetVtxBoundaryInterpolation(OpenSubdiv::Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
        return std::unique_ptr<Far::TopologyRefiner>(
            Factory::Create(descriptor, Factory::Options(OpenSubdiv::Sdc::SCHEME_CATMARK, options)));
    }

    const std::vector<Point>& points() const { return points_; }

  private:
    int vertex(const Lattice& at) {
        const auto [place, fresh] = made_.try_emplace(at, static_cast<int>(points_.size()));
        if (fresh) points_.push_back({cagePoint(cage_, at)});
        return place->second;
    }
    void face(const Lattice& a, const Lattice& b, const Lattice& c, const Lattice& d) {
        for (const Lattice* at : {&d, &c, &b, &a}) corners_.push_back(vertex(*at));
    }
    void addCrease(const Crease& crease, int side) {
        Lattice at = crease.from;
        while (at != crease.to) {
            Lattice next = at;
            for (int k = 0; k < 3; ++k) next[k] += (crease.to[k] > at[k]) - (crease.to[k] < at[k]);
            for (const Lattice& end : {at, next}) creases_.push_back(vertex({end[0], side * end[1], end[2]}));
            sharpness_.push_back(crease.sharpness);
            at = next;
        }
    }

    const Cage& cage_;
    std::map<Lattice, int> made_;
    std::vector<Point> points_;
    std::vector<int> corners_, creases_;
    std::vector<float> sharpness_;
};

void stretch(Shell& shell, const Extent& extent) {
    city::Aabb box;
    for (const glm::vec3& p : shell.positions) box.extend(p);
    const glm::vec3 low{extent.rear, -extent.width / 2, extent.floor},
        high{extent.front, extent.width / 2, extent.top};
    const glm::vec3 scale = (high - low) / box.size();
    for (glm::vec3& p : shell.positions) p = low + scale * (p - box.min);
    for (glm::vec3& n : shell.normals) n = glm::normalize(n / scale);
}

}  // namespace

Shell subdivide(const Cage& cage, const Extent& extent, int depth) {
    const Topology topology(cage);
    const auto refiner = topology.refiner();
    Far::TopologyRefiner::UniformOptions uniform(static_cast<unsigned>(depth));
    uniform.fullTopologyInLastLevel = true;  // limit points need it
    refiner->RefineUniform(uniform);
    const Far::PrimvarRefiner primvars(*refiner);
    std::vector<Point> points = topology.points();
    for (int level = 1; level <= depth; ++level) {
        std::vector<Point> finer(refiner->GetLevel(level).GetNumVertices());
        primvars.Interpolate(level, points, finer);
        points = std::move(finer);
    }
    std::vector<Point> limit(points.size()), along(points.size()), across(points.size());
    primvars.Limit(points, limit, along, across);

    Shell shell;
    for (std::size_t i = 0; i < limit.size(); ++i) {
        shell.positions.push_back(limit[i].value);
        shell.normals.push_back(glm::normalize(glm::cross(along[i].value, across[i].value)));
    }
    stretch(shell, extent);
    const Far::TopologyLevel& last = refiner->GetLevel(depth);
    for (int f = 0; f < last.GetNumFaces(); ++f) {
        const auto corner = last.GetFaceVertices(f);
        float y = 0;
        for (int k = 0; k < 4; ++k) y += shell.positions[corner[k]].y;
        if (y < 0) continue;
        const auto index = [&](int k) { return static_cast<std::uint32_t>(corner[k & 3]); };
        // The diagonal whose ends' normals differ less follows the surface better.
        const float d02 = glm::dot(shell.normals[index(0)], shell.normals[index(2)]);
        const float d13 = glm::dot(shell.normals[index(1)], shell.normals[index(3)]);
        const int k = d02 >= d13 ? 0 : 1;
        shell.triangles.push_back({{index(k), index(k + 1), index(k + 2)}, Surface::paint});
        shell.triangles.push_back({{index(k), index(k + 2), index(k + 3)}, Surface::paint});
    }
    return shell;
}

}  // namespace vehicles
