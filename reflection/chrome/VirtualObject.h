#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "reflection/chrome/BoundingGrid.h"
#include "reflection/chrome/CellImage.h"
#include "reflection/chrome/VirtualOptions.h"
#include "reflection/chrome/VirtualVertex.h"

namespace reflection {

/// A mesh near a reflector whose image in one of the reflector's pieces is kept up to date. Source: Estalella
/// et al. 2005, sections 3 and 5; departures: CellImage.h, in place of a regular grid.
class VirtualObject {
  public:
    /// Positions in the mesh's frame, metres; those that are not finite become invalid virtual vertices.
    VirtualObject(std::vector<glm::vec3> positions, const VirtualOptions& options);

    /// From the next update on; whether the share is 1 stays as it was made.
    void tell(const VirtualOptions& options);

    /// Moves the image. `reflectorFromMesh`: rigid; eye in the reflector's frame. Cost: searches for at
    /// most the share (VirtualOptions), 3 ns for every other vertex.
    VirtualCounts update(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh);

    /// One of several objects near a reflector, and how its update went.
    struct Placed {
        VirtualObject* object = nullptr;
        glm::dmat4 reflectorFromMesh{1};
        VirtualCounts counts = {};
    };
    /// The same for several at a time: searches are answered together, in full packets, and their shares are
    /// one budget, spent where the image is farthest off. `part`: of that budget; the rest is the caller's.
    static void update(const ReflectorMap& map, const glm::dvec3& eye, std::span<Placed> objects,
                       double part = 1);

    std::span<const VirtualVertex> vertices() const { return image; }
    /// After an update: see CellImage::at. Nothing, where there are no cells.
    std::optional<SeenInCell> at(const glm::vec3& point) const {
        return cells ? cells->at(point) : std::nullopt;
    }

  private:
    /// Adds searches to the batch; false: there are none (any more).
    bool ask(SearchBatch& batch, bool first, VirtualCounts& counts, std::size_t& left);
    /// Spends what is left of the budget on pending cells, or gives them up. `reserve`: left for those that
    /// were refined in the last update.
    static void spend(std::span<Placed> objects, std::size_t reserve, std::size_t& left);
    void take(SearchBatch& batch, VirtualCounts& counts);
    void onGrid(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh,
                VirtualCounts& counts);

    VirtualOptions settings;
    std::vector<glm::vec3> points;
    std::vector<std::uint32_t> broken;  ///< vertices that are not finite
    std::optional<BoundingGrid> grid;
    std::optional<CellImage> cells;
    std::vector<glm::dvec3> asked;
    std::vector<ReflectionPoint> answers;
    std::vector<glm::dvec3> last;  ///< where vertices were reflected in the last update
    glm::dmat4 place{1};
    glm::dvec3 eyeAt{0};
    std::size_t firstAnswer = 0;
    bool waits = false;
    std::vector<glm::vec4> atNodes, atVertices;
    std::vector<VirtualVertex> image;
};

}  // namespace reflection
