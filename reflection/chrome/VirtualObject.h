#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "reflection/chrome/BoundingGrid.h"
#include "reflection/chrome/ReflectionSearch.h"

namespace reflection {

/// What a virtual vertex is drawn with.
struct VirtualVertex {
    /// In the reflector's frame relative to the eye, metres: lies on the line of sight through the reflection
    /// point, as far away as the light's whole path is long. Its direction places it on screen, its length
    /// orders it in depth among everything reflected in the same piece.
    glm::vec3 fromEye{0};
    ReflectionStatus status = ReflectionStatus::invalid;
};

/// Where on the piece a virtual vertex is seen, from what it is drawn with: on its line of sight, where the
/// rest of its path reaches the vertex. Frame: the reflector's. The eye, where there is no such place.
glm::dvec3 reflectionPointOf(const VirtualVertex& seen, const glm::dvec3& eye, const glm::dvec3& vertex);

struct VirtualOptions {
    /// Share of the mesh's vertices that may be searched for; 1: all, without a grid.
    double share = 0.096;
    /// Vertices in cells whose nodes do not all have the same status are searched for themselves (beyond the
    /// share): across an outline the virtual image moves too fast for a cell.
    bool exactAtOutlines = true;
    /// Angle, seen from the eye, by which a cell's vertices may lie off: in each cell that covers enough on
    /// screen to bend by as much, the vertex farthest from the nodes is searched for, and all others if it is
    /// off by more (beyond the share): a quarter of a pixel of a 720-row view of 60 degrees, as others may
    /// lie farther off. Infinity: cells are taken as they are, as published.
    double cellTolerance = 0.25 * 1.155 / 720;
    SearchOptions search = {};
    /// Set: vertices are searched for as published instead, for comparison; see
    /// findReflectionPointsAsPublished.
    std::optional<PublishedOptions> published = {};
};

/// One of both searches, as the options say.
void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const VirtualOptions& options);

/// How an update went.
struct VirtualCounts {
    std::size_t vertices = 0, searched = 0, nodes = 0, atOutlines = 0, inBentCells = 0;
    std::size_t found = 0, hidden = 0, unreflected = 0;  ///< of the searched ones
    std::size_t lookups = 0;
};

/// A mesh near a reflector whose image in one of the reflector's pieces is kept up to date. Source: Estalella
/// et al. 2005, sections 3 and 5; departures: outlines and cells
/// in which the image bends are searched exactly.
class VirtualObject {
  public:
    /// Positions in the mesh's frame, metres; those that are not finite become invalid virtual vertices.
    VirtualObject(std::vector<glm::vec3> positions, const VirtualOptions& options);

    /// Moves the image. `reflectorFromMesh`: rigid; eye in the reflector's frame. Cost: searches for the
    /// share, 3 ns for every other vertex.
    VirtualCounts update(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh);

    std::span<const VirtualVertex> vertices() const { return image; }

  private:
    VirtualOptions settings;
    std::vector<glm::vec3> points;
    void searchExactly(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh,
                       VirtualCounts& counts);

    std::vector<std::uint32_t> broken;  ///< vertices that are not finite
    std::vector<std::uint32_t> probes;  ///< for each cell its vertex that is farthest from the nodes
    std::vector<char> searchCell;       ///< for each cell
    std::optional<BoundingGrid> grid;
    std::vector<glm::dvec3> asked;
    std::vector<ReflectionPoint> answers;
    std::vector<glm::vec4> atNodes, atVertices;
    std::vector<ReflectionStatus> cellStatus;
    std::vector<std::uint32_t> exact;
    std::vector<VirtualVertex> image;
};

}  // namespace reflection
