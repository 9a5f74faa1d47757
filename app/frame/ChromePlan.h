#pragma once

#include <compare>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <span>
#include <vector>

#include "app/frame/ChromeDrawing.h"
#include "app/frame/ChromeParts.h"
#include "app/frame/Detail.h"
#include "app/frame/FrameScene.h"
#include "reflection/planar/EyeView.h"

namespace app {

/// A part of a vehicle in a view, by what stays the same from frame to frame.
struct ChromeName {
    std::uint32_t view = 0;     ///< index into FrameScene::views
    std::uint32_t vehicle = 0;  ///< VehiclePose::id
    std::uint32_t part = 0, wheel = 0;
    auto operator<=>(const ChromeName&) const = default;
};

/// A piece of chrome that shows what is close to it where it truly appears, in one view.
struct ChromeJob {
    static constexpr std::uint32_t noWheel = 0xffffffffu;

    ChromeName name;
    std::uint32_t view = 0;     ///< index into FrameScene::views
    std::uint32_t vehicle = 0;  ///< index into FrameScene::vehicles
    std::uint32_t part = 0;     ///< of ChromeParts::of its model
    std::uint32_t wheel = noWheel;
    glm::dmat4 worldFromPart{1};  ///< rigid: the reflector's frame
    double radius = 0;            ///< of the ball around the part's origin
    double reach = 0;             ///< metres from its origin beyond which the local map shows everything
    double pixels = 0;            ///< its width on screen
    float share =
        1;  ///< of the close picture over the local map's: 0 where a job begins, 1 from twice its size
    std::vector<std::uint32_t> close;  ///< other vehicles within reach
};

/// The close chrome of one frame: plain data, made without a GPU. Without chrome that is large on screen it
/// is empty, and nothing is made for it.
struct ChromePlan {
    std::vector<ChromeJob> jobs;   ///< the most visible first
    std::uint32_t parts = 0;       ///< chrome parts of the vehicles seen, in all views
    std::uint32_t outOfSight = 0;  ///< of these: outside the view, or on the far side of their vehicle
    /// No whole convex bodies, left to the local map: past a rim or in a hollow their images would run out
    /// onto the surface that closes their maps, where searches are slow and triangles tear.
    std::uint32_t open = 0;
    std::uint32_t tooSmall = 0;       ///< the local map is right to a pixel
    std::uint32_t nothingClose = 0;   ///< nothing within reach
    std::uint32_t leftOut = 0;        ///< for want of room
    std::uint32_t making = 0;         ///< their reflectors are being made
    std::vector<ChromeName> without;  ///< in sight and without a job: the local map alone is seen there

    bool empty() const { return jobs.empty(); }
};

struct ChromePlanOptions {
    bool on = true;
    bool vehicles = true;  ///< their parts too, not only what stands
    /// For reflectors that are not there yet. Otherwise they are made in the background, from half the size
    /// on at which a part needs one, and until then its job waits.
    bool wait = true;
    std::uint32_t mostJobs = 8;  ///< a frame; the least visible are left out
    /// Things farther away than so many radii of a part are left to the map: seen from all over the part
    /// their direction differs by less than one part in so many.
    double closeRadii = app::closeRadii;
    /// Width on screen, pixels, from which on a part shows what its surroundings are and not only their
    /// light.
    double leastPixels = ChromeDetail{}.leastPixels;
    /// Pixels by which the local map may show close things off their places. It is made around the middle of
    /// its vehicle: a feature at distance d seen from a part that lies s off that middle turns by about s /
    /// d, and a part that shows the half space over D pixels shifts it by D s / (pi d).
    double shift = 1;
};

/// The shares of the frame before, so that none changes by more than a step, whatever the plan wants:
/// vehicles jump past each other, reflectors get ready, places change hands.
class ChromeFades {
  public:
    static constexpr float step = 1.f / 12;

    /// 0 for parts that were not in sight, or had no job.
    float shareOf(const ChromeName& name) const;
    /// Of parts that were in sight before, brings the shares to within a step of what they were; those that
    /// come into sight have what the plan says at once. Jobs without a share go.
    void follow(ChromePlan& plan);

  private:
    std::map<ChromeName, float> shares_;  ///< of all parts in sight
};

/// Decides which chrome parts show close things themselves. Keeps nothing from frame to frame: a job's share
/// grows from 0 with the part's size and nearness, and with its lead over the largest one that was left out,
/// so that nothing jumps when a job begins or ends. `before`: jobs that end while they still have a share
/// there stay in the plan, with a share of 0, for ChromeFades::follow.
///
/// `seen`: indices into FrameScene::vehicles. `models`: those of the vehicles, in the order of the parts.
/// Deterministic. Cost: the parts of the vehicles seen, and all vehicles for each job.
ChromePlan planChrome(const FrameScene& scene, std::span<const std::uint32_t> seen,
                      std::span<const vehicles::VehicleModel> models, const ChromeParts& parts,
                      const ChromePlanOptions& options, const ChromeFades* before = nullptr);

/// A part where it is, with its reach: a job of view 0 without what depends on an eye. `number`: of the part,
/// in its model. `radii`: ChromePlanOptions::closeRadii.
ChromeJob chromePartAt(std::span<const vehicles::VehiclePose> poses,
                       std::span<const vehicles::VehicleModel> models, const ChromePart& part,
                       std::uint32_t vehicle, std::uint32_t number, std::uint32_t wheel, double radii);
/// Lists the other vehicles within the job's reach. Metres to the nearest, no less than its radius; infinite
/// where there is none.
double closeTo(ChromeJob& job, std::span<const vehicles::VehiclePose> poses,
               std::span<const vehicles::VehicleModel> models);

/// The pixels of an image of this size in which a ball may be seen, relative to the eye; all where the eye is
/// close to it, none where it is behind or outside.
reflection::PixelRect pixelsOfBall(const glm::mat4& clipFromRelative, const glm::ivec2& size,
                                   const glm::vec3& centre, float radius);
/// The same of a box somewhere. `clipFromBox`: from the box's own frame.
reflection::PixelRect pixelsOfBox(const glm::mat4& clipFromBox, const glm::ivec2& size,
                                  const city::Aabb& box);

}  // namespace app
