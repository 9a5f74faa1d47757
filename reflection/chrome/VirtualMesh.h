#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/VirtualEdges.h"

namespace reflection {

/// A mesh's image in one piece of a reflector, ready to be drawn: its triangles with as many vertices in the
/// middles of edges as the image's bends ask for. Reflections of straight edges are curves: without these a
/// kerb or a wall of two triangles would be drawn straight (the limit that Estalella et al. 2005 state in
/// section 8).
class VirtualMesh {
  public:
    /// The mesh's positions and triangles, in its own frame.
    VirtualMesh(std::vector<glm::vec3> positions, std::vector<std::uint32_t> indices,
                const VirtualMeshOptions& options);

    /// Moves the image; see VirtualObject::update. Edges are halved until their middles lie within the
    /// tolerance of where they are drawn, both triangles at an edge alike, so that no cracks open. On convex
    /// pieces edges with one hidden end are cut where the piece's outline hides them, and what lies behind is
    /// left out: a hidden vertex's own image may be anywhere, behind the eye too, and a triangle drawn
    /// straight to it would cover what it never reaches. Places of such cuts are drawn the tolerance past the
    /// outline, with the status `hidden`.
    ///
    /// On concave pieces every image of a vertex is a vertex of its own (those after the first are middles of
    /// an edge from it to itself). Images of neighbouring vertices that are each other's nearest belong
    /// together; a triangle is drawn once for each image that goes round its corners. Where one ends (two
    /// meet and vanish, the piece itself stands before it) edges are halved, and what is left after the last
    /// halving is left out: a strip as wide as a sixty-fourth of an edge. `share` is then that of vertices
    /// that are searched for everywhere; all others' images are followed from theirs.
    /// Cost: the vertices', a search for each edge that is long on screen and about six for each that is cut.
    VirtualCounts update(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh,
                         const VirtualMeshOptions& options);

    /// One of several meshes near a reflector, and how its update went.
    struct Placed {
        VirtualMesh* mesh = nullptr;
        glm::dmat4 reflectorFromMesh{1};
        VirtualMeshOptions options = {};
        VirtualCounts counts = {};
    };
    /// The same for all that is drawn in a piece: one budget of searches (VirtualOptions::share) for the
    /// vertices of all meshes and for those on their edges, which take what lies in a cell from there and are
    /// searched for, the longest on screen first, where they do not. An edge for which nothing is left stays
    /// as it is.
    static void update(const ReflectorMap& map, const glm::dvec3& eye, std::span<Placed> meshes);

    std::size_t meshVertices() const { return positions.size(); }
    /// Of the mesh, then of middles.
    std::span<const VirtualVertex> vertices() const { return edges.image; }
    /// Vertices on edges, in the order in which they follow the mesh's vertices: what else belongs to a
    /// vertex (normal, colour) is mixed from its ends'.
    std::span<const MiddleVertex> middles() const { return edges.added; }
    std::span<const std::uint32_t> indices() const { return edges.drawn; }
    /// Mean distance from the eye of what is drawn, by a sample of its corners: what hides others is best
    /// drawn first. 0 where nothing is.
    float away() const;

  private:
    bool asOne(const ReflectorMap& map, const VirtualMeshOptions& options) const {
        return map.bend() != Bend::concave || options.vertices.published.has_value();
    }
    VirtualCounts updateConcave(const ReflectorMap& map, const glm::dvec3& eye,
                                const glm::dmat4& reflectorFromMesh, const VirtualMeshOptions& options);

    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> triangles;
    std::vector<std::uint32_t> placeOf;  ///< vertices
    std::vector<glm::vec3> welded;       ///< positions, each once
    VirtualObject object;                ///< of those
    VirtualEdges edges;
};

}  // namespace reflection
