#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/BounceEye.h"
#include "reflection/chrome/ReflectorPieces.h"
#include "reflection/planar/EyeView.h"

namespace reflection {

/// A chrome part as others see it.
struct ChromeBody {
    const Reflector* reflector = nullptr;
    /// For each of its pieces, as many as there are: spreadPoints of it, 48 are enough.
    std::span<const std::vector<SurfacePoint>> points;
    glm::dmat4 worldFromPart{1};  ///< rigid
    glm::dvec3 centre{0};         ///< world, of a ball that holds it
    double radius = 0;
    /// Metres from its centre beyond which its map shows everything, other chrome too.
    double reach = 0;
    /// Seen by the caller's view itself; others are met in parts alone.
    bool inView = true;
};

struct ChromeTreeOptions {
    /// Chrome parts in a row that show what is close to them where it is, 1 .. 8; 1: what one part shows of
    /// another has that one's map alone.
    int depth = 2;
    /// What is met in the last pictures is looked at, too, and listed as tooDeep; false saves its searches.
    bool pastDepth = true;
    /// Pixels that a part must cover in another to have a picture.
    double leastPixels = 6;
    /// Pixels by which what a part shows within another may be off because all of it is seen from one eye.
    double mostStray = 4;
    /// Pictures into which a part may be cut along its length where one eye is not enough.
    int mostSlices = 4;
    std::uint32_t mostPictures = 32;  ///< a frame; the least visible are left out
    double texelsPerPixel = 1;
    int mostTexels = 1024;  ///< of a picture's side
    /// Product of reflectances is the caller's; without it all branches are followed to the depth.
    SearchOptions search = {};
};

/// Why a part seen in another has no picture of its own.
enum class ChromeLook : std::uint8_t { picture, tooDeep, tooSmall, tooNear, tooBent, overCap, unmapped };

/// A piece of a chrome part seen in a piece of another.
struct ChromeNode {
    static constexpr std::uint32_t none = 0xffffffffu;

    std::uint32_t parent = none;  ///< in whose picture it is met; none: in the caller's view
    std::uint32_t level = 1;      ///< parts before it on the way to the eye
    std::uint32_t in = 0, piece = 0;
    std::uint32_t of = 0, ofPiece = 0;  ///< what is seen
    ChromeLook look = ChromeLook::tooDeep;

    glm::dvec3 eye{0};   ///< from where it is seen, world: see BounceEye
    EyeView view;        ///< of the picture, from `eye`
    glm::ivec2 size{0};  ///< texels; 0 without a picture
    double pixels = 0;   ///< that it covers in its parent's image, across
    double stray = 0;    ///< pixels by which the picture may be off
    double shift = 0;    ///< pixels by which it is off besides for each metre that its eye stands elsewhere
    /// Metres from the seen part at which what it mirrors is where it belongs, whatever eye is in between.
    double middle = 0;
    glm::dvec3 axis{0};  ///< world: the picture is for those points p of the part with low <= axis . p < high
    double low = -1e300, high = 1e300;
};

struct ChromeTreeCounters {
    std::uint32_t pairs = 0;     ///< pieces and parts close to them that were looked at
    std::uint32_t unseen = 0;    ///< no point of the part has a reflection point, or none in the image
    std::uint32_t pictures = 0;  ///< passes
    std::uint32_t tooDeep = 0, tooSmall = 0, tooNear = 0, tooBent = 0, overCap = 0,
                  unmapped = 0;  ///< seen without a picture
    std::uint64_t texels = 0;
    std::uint32_t searched = 0;
    std::uint32_t deepest = 0;
};

enum class ChromeTreeStatus : std::uint8_t { ok, badSettings };

/// What chrome parts show of each other in one view. Nodes are in the order in which they are met, a parent
/// before what is met in its picture: pictures are made from the last to the first.
struct ChromeTree {
    ChromeTreeStatus status = ChromeTreeStatus::ok;  ///< badSettings: an empty tree
    std::vector<ChromeNode> nodes;
    ChromeTreeCounters counters;

    std::uint32_t passes() const { return counters.pictures; }
};

/// Lists them: for every part seen and every other one close to it whether it shows it, from where, how large
/// and how well. A part that shows no other has no node, and what has no node costs nothing more.
///
/// The picture of a node is what its piece mirrors, seen from the node's eye as any piece is seen by any eye.
/// Where the piece is drawn in the other one, each of its points P takes the picture's light: not on the line
/// from P to that eye, but where from that eye the piece shows what lies on P's own reflected ray, `middle`
/// metres away. So what is at that distance is where it belongs, however the rays come in. An angle a between
/// the ray that reaches P and that from the eye displaces what is at a distance t by no more than
/// a |1 / (1/D + 2c/R + 1/t) - 1 / (1/D + 2c/R + 1/middle)| on a surface of bending radius R at a distance D
/// from the eye, seen at a cosine c (a mirror's image moves by a / (1/D + 2c/R + 1/t) as its normal must turn
/// with it). In pixels that is the node's `stray`, for all t from R or D on, whichever is less, and c from
/// 0.5 on: a ball's seven eighths. Where it is above what is allowed, the piece is cut into slices with an
/// eye each, whose strays fall with their length; where that does not help it keeps its map's look (tooBent).
///
/// Deterministic; no graphics API. Source: Nielsen & Christensen 2002 for the recursion; Estalella et al.
/// 2005, section 8, name it as future work. Cost: for each node a search for every point of every part close
/// to it.
ChromeTree chromeTree(const EyeView& view, const glm::ivec2& size, std::span<const ChromeBody> bodies,
                      const ChromeTreeOptions& options);

}  // namespace reflection
