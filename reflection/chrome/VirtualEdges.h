#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <utility>
#include <vector>

#include "reflection/chrome/EdgeTable.h"
#include "reflection/chrome/VirtualMeshOptions.h"
#include "reflection/chrome/VirtualObject.h"
#include "reflection/chrome/VirtualTriangles.h"

namespace reflection {

/// A place on an edge whose image is asked for.
struct EdgeProbe {
    glm::dvec3 place{0};
    float urgency = 0;      ///< how long its edge is on screen
    bool answered = false;  ///< else what is there stays unknown
    bool inCell = false;    ///< answered by the cell that it lies in, without a search
    VirtualVertex seen = {};
    glm::dvec3 normal{0};  ///< of the piece where it is reflected
    double facing = 0;     ///< of that normal to the eye, a cosine
};

/// Halves and cuts a mesh's edges where its image bends, tears or runs past the outline; see
/// VirtualMesh::update. Vertices of one position (with other colours, other normals) share their images and
/// the middles of their edges. What happens in turns, so that several meshes' probes are answered together:
/// begin; while open: askMiddles, takeMiddles, as long as askCuts asks anything takeCuts, cutTriangles.
class VirtualEdges {
  public:
    struct Mesh {
        const VirtualObject* object = nullptr;  ///< of places, updated
        std::span<const glm::vec3> places = {};
        std::span<const std::uint32_t> placeOf = {};  ///< vertices
        std::span<const std::uint32_t> triangles = {};
    };
    /// Map, mesh and options must live until it is over.
    void begin(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh,
               const VirtualMeshOptions& options, const Mesh& mesh);
    bool open() const { return !triangles.empty(); }

    void askMiddles();
    void takeMiddles();
    /// False: nothing is open any more.
    bool askCuts();
    void takeCuts();
    void cutTriangles();

    /// What was asked for and is not answered yet is to be searched for, or left.
    std::span<EdgeProbe> probes() { return asked; }
    /// Places that were put on edges so far.
    std::size_t middles() const { return onEdges.size(); }

    std::vector<VirtualVertex> image;  ///< the mesh's vertices, then those on edges
    std::vector<MiddleVertex> added;
    std::vector<std::uint32_t> drawn;

  private:
    /// What a place is to the outline of a convex piece. What it hides, and itself, is a convex set: between
    /// two hidden places everything is hidden.
    enum class Side : std::uint8_t { seen, outline, hidden };
    struct Triangle {
        VirtualTriangle places, vertices;
        bool looked = false;  ///< one of its edges was looked at
    };
    /// An edge that the piece's outline cuts.
    struct Cut {
        std::uint32_t seen, hidden;
        double low = 0, high = 1;  ///< shares of the way from the seen end: seen there, hidden there
        double lowFacing = -1, highFacing = -1;  ///< go to zero at the cut; below 0: not known
        VirtualVertex at = {};                   ///< at `low`
        glm::dvec3 normal{0};
        bool open = true;
        double next() const;
    };

    Side sideOf(ReflectionStatus status) const {
        return convex && status == ReflectionStatus::hidden ? Side::hidden : Side::seen;
    }
    bool lost(std::uint32_t place) const {
        return creased && seen[place].status == ReflectionStatus::unreflected;
    }
    /// Chord between the directions to two places, which is their angle where that is small, squared.
    float chordOf(std::uint32_t a, std::uint32_t b) const {
        const glm::vec3 d = towards[a] - towards[b];
        return d.x * d.x + d.y * d.y + d.z * d.z;
    }
    bool outside(std::uint32_t a, std::uint32_t b, double length) const;
    void ask(const glm::dvec3& place, double urgency);
    glm::vec3 pastOutline(const VirtualVertex& at, const glm::dvec3& normal) const;
    void add(std::uint32_t a, std::uint32_t b, double share, const VirtualVertex& vertex, Side side);
    /// The vertex drawn for a place on the edge between two vertices.
    std::uint32_t vertexOn(std::uint32_t a, std::uint32_t b, std::uint32_t place);
    bool isSeen(const VirtualTriangle& t) const;

    const ReflectorMap* map = nullptr;
    const VirtualMeshOptions* options = nullptr;
    Mesh mesh;
    glm::dvec3 eye{0};
    glm::dmat4 meshFromReflector{1};
    bool convex = true, creased = false, last = false;
    int depth = 0;
    double cone = -1, unbent = 0, ofOutline = 0, grazing = 0;

    std::vector<glm::dvec3> places;
    std::vector<VirtualVertex> seen;
    std::vector<glm::vec3> towards;  ///< places, unit length from the eye
    std::vector<Side> sides;
    std::vector<MiddleVertex> onEdges;        ///< of places, those after the mesh's
    std::vector<std::uint32_t> middlePlaces;  ///< of vertices, those after the mesh's
    std::vector<Triangle> triangles, next;
    EdgeTable halved, vertices;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<Cut> cuts;
    std::vector<EdgeProbe> asked;
    std::vector<VirtualTriangle> cutPlaces, cutVertices;
    int cutRounds = 0;
};

}  // namespace reflection
