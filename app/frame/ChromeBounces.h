#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "app/frame/ChromePlan.h"
#include "app/frame/CloseScene.h"
#include "reflection/chrome/ChromeTree.h"

namespace app {

/// A piece of chrome that is seen in the chrome of another vehicle, and mirrors what is close to it.
struct ChromeBounce {
    std::uint32_t in = 0, piece = 0;  ///< index into ChromePlan::jobs, and its piece
    /// What is seen: a job from the eye of `view`, alone in a plan of one view. Its share grows from 0 with
    /// what the part covers in the other.
    ChromeJob of;
    std::uint32_t ofPiece = 0;
    std::uint32_t slice = 0;  ///< of those into which the part is cut, each with an eye of its own
    reflection::EyeView view;
    glm::ivec2 size{0};   ///< texels of its picture
    double pixels = 0;    ///< across, in the caller's view
    double middle = 0;    ///< see reflection::ChromeNode
    double shift = 0;     ///< see reflection::ChromeNode
    bool fading = false;  ///< on its way in or out
    glm::dvec3 axis{0};   ///< in the part's frame: the picture is for its points p with
    double low = -1e300;  ///< low <= dot(axis, p)
    double high = 1e300;  ///< < high
};

/// A picture, by what stays the same from frame to frame: vehicle, part, wheel and piece that show it; the
/// same of what is shown; slice.
using BounceName = std::array<std::uint32_t, 9>;
BounceName nameOf(const ChromePlan& plan, const ChromeBounce& bounce);

struct ChromeBounces {
    std::vector<ChromeBounce> pictures;  ///< the largest first
    std::uint32_t parts = 0;             ///< close to parts with jobs, of other vehicles
    std::uint32_t tooSmall = 0;          ///< the vehicle's map is enough
    std::uint32_t unseen = 0;            ///< nothing of it is seen there
    std::uint32_t tooBent = 0;           ///< no few eyes see what the other shows of it
    std::uint32_t tooNear = 0;           ///< they would stand in it
    std::uint32_t overCap = 0;
    std::uint32_t making = 0;  ///< their reflectors are being made
};

/// Which bounces a frame before had, and with what shares, so that none changes by more than
/// ChromeFades::step from one frame to the next, whatever the plan wants: what is new in a part that was
/// there before comes in by steps, and what is planned no more goes out by steps, with the picture that it
/// had. In a part that comes into sight itself all is there at once. Of one view.
class ChromeBounceFades {
  public:
    /// Adds what still goes out to the plan's own pictures.
    void follow(ChromeBounces& bounces, const ChromePlan& plan, std::uint32_t view,
                std::span<const vehicles::VehiclePose> poses, const CloseScene& scene);

  private:
    std::map<BounceName, ChromeBounce> before_;
    std::set<ChromeName> shown_;  ///< parts with jobs
};

struct ChromeBounceOptions {
    bool wait = true;  ///< for reflectors
    /// Pixels that a part must cover in another; its share is whole from twice as many on.
    double leastPixels = 24;
    std::uint32_t mostPictures = 6;
    int mostTexels = 512;  ///< of a picture's side
    double texelsPerPixel = 1;
};

/// Decides for which chrome parts that are seen in others what they mirror is drawn: those of other vehicles
/// close to a job's part, whole and convex, large enough in it. Where none is, nothing is made and no
/// reflector asked for. One for one scene; keeps parts' points. Source: reflection/chrome/ChromeTree.h.
class ChromeBouncePlanner {
  public:
    /// Keeps a reference.
    explicit ChromeBouncePlanner(const CloseScene& scene) : scene_(scene) {}

    /// Of one of the plan's views; `view`, `size`: its eye and image. Deterministic. Cost: all chrome parts
    /// of the vehicles close to jobs; searches for 48 points of those that are large enough.
    ChromeBounces plan(const ChromePlan& plan, std::uint32_t viewIndex, const reflection::EyeView& view,
                       const glm::ivec2& size, std::span<const vehicles::VehiclePose> poses,
                       const ChromeBounceOptions& options);

  private:
    using Points = std::vector<std::vector<reflection::SurfacePoint>>;
    const Points& pointsOf(const ChromePart& part);

    const CloseScene& scene_;
    std::map<std::uint32_t, Points> points_;  ///< by shape, for each piece
};

}  // namespace app
