#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "reflection/chrome/CellInterpolation.h"
#include "reflection/chrome/CellTree.h"
#include "reflection/chrome/VirtualOptions.h"

namespace reflection {

/// A cell whose vertices may lie off, until it is refined: cut, searched for vertex by vertex, or checked.
struct PendingCell {
    float error = 0;  ///< how far off on screen, radians
    SmoothCell cell = {};
    bool check = false;  ///< by its corners it is smooth
};

/// A place's image as the cell around it has it.
struct SeenInCell {
    VirtualVertex vertex;
    float facing = 0;  ///< cosine between normal and line of sight where it is reflected; below 0: hidden
};

/// Searches that several meshes ask for at a time, so that packets are full.
struct SearchBatch {
    std::vector<glm::dvec3> places, guesses;  ///< guesses: not a number where there is none
    std::vector<ReflectionPoint> answers;
    std::vector<glm::dvec3> pathPlaces, pathFrom;
    std::vector<PathImage> paths;

    void ask(const glm::dvec3& place, const glm::dvec3& guess) {
        places.push_back(place);
        guesses.push_back(guess);
    }
};

/// A mesh's image by searches at the corners of cells, chosen by what the reflection covers on screen: cells
/// are cut where slopes at their corners show that the image bends by more than the tolerance between them,
/// where a vertex searched for to check lies off by more, and where corners see different things; cells with
/// fewer vertices than corners to be added are searched for vertex by vertex. Cells that the reflector's
/// outline crosses are as smooth as others: hidden corners have images too (perturbPaths).
///
/// From one update to the next it is remembered which cells were cut (each sixteenth of them is judged anew),
/// which were checked (each eighth is again), and where corners were found, as first guesses. Searches are
/// answered in rounds: ask, take, takePaths, refine what is pending, again and again until ask adds nothing.
/// Who refines has the budget (VirtualObject); what is given up instead is interpolated in its cell.
class CellImage {
  public:
    CellImage(std::span<const glm::vec3> positions, const VirtualOptions& options);

    /// From the next update on.
    void tell(const VirtualOptions& options);
    /// Begins an update; gives the searches that its first round asks for. The map must live until it is
    /// over.
    std::size_t begin(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh);
    /// Begins it again without what is remembered of cells; gives at most 8.
    std::size_t forget();
    /// Adds searches, of places at the outline at most `left`, which is made less; false: there are none, and
    /// the image is whole.
    bool ask(SearchBatch& batch, std::span<VirtualVertex> image, VirtualCounts& counts, std::size_t& left);
    /// Takes their answers and adds paths.
    void take(SearchBatch& batch, std::span<VirtualVertex> image, VirtualCounts& counts);
    void takePaths(const SearchBatch& batch);

    /// After an update: the image of any place (of the mesh's frame) in a cell that is interpolated, as near
    /// to the truth as its vertices' are. Cost: a tenth of a microsecond.
    std::optional<SeenInCell> at(const glm::vec3& place) const;

    std::span<const PendingCell> pending() const { return waiting; }
    /// Whether a pending cell was refined in the last update, too.
    bool wasIn(const PendingCell& cell) const;
    /// Has a pending cell searched for if that takes at most `left` searches; how many, or nothing: too many.
    std::optional<std::size_t> refine(const PendingCell& cell, std::size_t left);
    /// Interpolates in a pending cell as it is.
    void giveUp(const PendingCell& cell);
    /// Leaves those pending that are marked.
    void keepPending(std::span<const std::uint8_t> kept);

  private:
    struct Node {
        std::uint32_t known = 0;      ///< the update in which it was searched for
        std::uint32_t charged = 0;    ///< the update in which its search was charged
        std::uint32_t continued = 0;  ///< the update in which its image was, where it is hidden
        ReflectionStatus status = ReflectionStatus::invalid;
        glm::dvec3 point{NAN};  ///< where it is reflected
    };
    struct Scene {
        const ReflectorMap* map = nullptr;
        glm::dvec3 eye{0};
        glm::dmat4 reflectorFromMesh{1};
        bool convex = true;
        float unbent =
            0;  ///< squared chord on screen below which a cell cannot bend by more than the tolerance
        float outline = 0;  ///< the reflector's radius on screen, radians
        float widest = 0;   ///< squared chord of cells that corners alone may judge
        glm::dvec3 place(const glm::vec3& p) const {
            return glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1));
        }
    };
    /// What the corners of a cell say.
    struct Judgement {
        enum class Kind : std::uint8_t { smooth, check, torn, bent } kind = Kind::torn;
        SmoothCell cell = {};
        float error = 0;  ///< on screen, radians
    };

    glm::vec3 position(std::uint32_t at) const {
        return {tree.along(0)[at], tree.along(1)[at], tree.along(2)[at]};
    }
    Judgement judge(std::uint32_t cell) const;
    /// Whether the vertex searched for to check a cell lies where its corners say.
    /// Gives by how much it does not (radians), or 0.
    float offBy(const SmoothCell& cell, const ReflectionPoint& r) const;
    /// Of a cell none of whose corners is seen: all of it is reflected past the rim, far from the part.
    bool clearOfPart(const CellTree::Cell& cell) const;
    /// How far apart a cell's corners are seen, radians; no more than the reflector is wide.
    float extentOf(const CellTree::Cell& cell) const;
    /// Opens cells from the k-th that is to be opened as they were cut in the last update.
    void openRemembered(std::size_t k, bool judgeAnew);
    /// Charges searches for a cell's corners, unless they are more than `left`.
    std::optional<std::size_t> charge(std::span<const std::uint32_t> cells, std::size_t left);
    std::size_t newNodes(const CellTree::Cell& cell) const;
    /// Where a vertex of a cell may be reflected, by its corners; not a number where they do not tell.
    glm::dvec3 guessIn(const CellTree::Cell& cell, std::uint32_t place) const;
    void continueHidden(SearchBatch& batch);

    VirtualOptions settings;
    CellTree tree;
    Scene scene;
    std::uint32_t update = 0;
    bool interpolated = false;
    std::vector<Node> nodes;
    std::vector<PathImage> images;          ///< at nodes
    std::vector<std::uint8_t> wasCut;       ///< cells
    std::vector<std::uint32_t> wasGood;     ///< cells: the update in which they were smooth
    std::vector<std::uint32_t> wasRefined;  ///< cells: the update in which they were cut or searched for
    struct Leaf {
        std::uint32_t update = 0, at = 0;  ///< when it was interpolated, and its place in `smooth`
    };
    std::vector<Leaf> leaves;  ///< cells
    std::vector<PendingCell> waiting;
    std::vector<std::uint32_t> justCharged;
    std::vector<std::uint32_t> open;   ///< cells whose corners have been asked for
    std::vector<std::uint32_t> next;   ///< cells whose corners are to be
    std::vector<std::uint32_t> exact;  ///< vertices to be searched for, as places in the tree's order
    std::vector<glm::dvec3> exactGuesses;
    std::vector<SmoothCell> smooth, checked;
    std::vector<std::uint32_t> doubtful;
    std::vector<std::uint32_t> askedNodes, askedExact, askedPaths;
    std::vector<SmoothCell> askedChecks;
    std::size_t firstAnswer = 0, firstPath = 0;
};

}  // namespace reflection
