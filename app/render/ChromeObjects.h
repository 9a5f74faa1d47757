#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "app/frame/ChromeDrawing.h"
#include "app/frame/ChromePlan.h"
#include "app/frame/CloseImages.h"
#include "app/frame/CloseScene.h"
#include "app/render/CloseMeshes.h"
#include "app/render/PassTarget.h"
#include "reflection/chrome/VirtualMesh.h"
#include "reflection/gl/ChromeLayer.h"

namespace app {

/// A thing near a piece of chrome, as the piece shows it.
struct ChromeObject {
    static constexpr std::uint32_t noVehicle = 0xffffffffu;

    const CloseMesh* source = nullptr;
    std::unique_ptr<reflection::VirtualMesh> mesh;
    std::unique_ptr<reflection::gl::ChromeMesh> drawn;  ///< made by who draws
    glm::dmat4 worldFromMesh{1};
    std::uint32_t vehicle = noVehicle;  ///< index into the frame's; none: of the city
    std::uint64_t used = 0;
    bool changed = true;  ///< its image moved since the frame before
    bool stale = true;    ///< what is drawn is not its image yet
    float away =
        0;  ///< metres of the light's path to what is drawn, in the mean: near things are drawn first
    reflection::VirtualCounts counts;

    /// What its image was found for.
    glm::dmat4 lastMesh{0};
    glm::dvec3 lastEye{0};
    double lastTolerance = -1, lastShare = -1;
    bool whole = false;  ///< made without cells
};

/// What one piece of a job's part shows.
struct ChromeShown {
    const ChromeJob* job = nullptr;
    const reflection::ReflectorPiece* piece = nullptr;
    std::vector<ChromeObject*> objects;
};

/// Chooses what chrome parts show of close things, at which level of detail, and searches for its images.
/// What is hidden behind a part, too far from it or too small in it is left out; an image for which nothing
/// moved is kept. Source: Estalella et al. 2005.
class ChromeObjects {
  public:
    /// Keeps a reference.
    explicit ChromeObjects(const CloseScene& scene) : scene_(scene), vehicles_(scene.models) {}

    /// Of one of the plan's views, part by part. Searches on all cores. The result holds until the next call.
    std::span<const ChromeShown> update(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                                        std::span<const vehicles::VehiclePose> poses,
                                        const ChromeDrawing& options, ChromeCounts& counts);
    /// Its two parts: for several plans at once, first all are gathered, which lets go of what OpenGL holds
    /// and so belongs to the thread that draws; searches may then run on any.
    void gather(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                std::span<const vehicles::VehiclePose> poses, const ChromeDrawing& options,
                ChromeCounts& counts);
    std::span<const ChromeShown> search(const ChromeDrawing& options, ChromeCounts& counts);
    std::span<const ChromeShown> shown() const { return shown_; }

  private:
    /// How large things are in a piece.
    struct Look {
        glm::dvec3 eye{0};
        std::vector<CloseBox> boxes;
        std::vector<CloseImage> images;
    };
    struct Kept {
        std::uint64_t used = 0;
        std::vector<CloseMesh> city;  ///< around `place`
        glm::dvec3 place{0};
        double reach = 0;
        double metresPerPixel = 0;  ///< that the part's distance asked for
        std::map<std::tuple<std::size_t, std::uint64_t, std::uint32_t>, ChromeObject>
            objects;              ///< piece, thing, mesh
        std::vector<Look> looks;  ///< by pieces
    };
    /// All that one piece shows: one budget of searches.
    struct Task {
        const reflection::ReflectorMap* map = nullptr;
        glm::dvec3 eye{0};
        std::vector<ChromeObject*> objects;
        std::vector<reflection::VirtualMesh::Placed> meshes;
    };

    ChromeObject& object(Kept& kept, std::size_t piece, std::uint64_t thing, std::uint32_t index,
                         const CloseMesh& source, const reflection::VirtualMeshOptions& options);
    void gatherCity(const ChromeJob& job, const reflection::ReflectorMap& map, const glm::dvec3& eye,
                    double radiansOff, Kept& kept);

    const CloseScene& scene_;
    CloseVehicles vehicles_;
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, Kept> kept_;
    std::vector<ChromeShown> shown_;
    std::vector<Task> tasks_;
    std::uint64_t frame_ = 0;
};

}  // namespace app
