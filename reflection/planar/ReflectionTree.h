#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "reflection/planar/Portal.h"
#include "reflection/planar/ReflectionScene.h"

namespace reflection {

/// How curved reflectors mirror.
enum class CurvedMaps : std::uint8_t {
    none,
    /// One view from the centre towards the eye for each time it is seen, made in the recursion (Nielsen &
    /// Christensen 2002, figure 5).
    viewDependent,
    /// A cube map each, before the frame, with the others' maps of this frame or the last one (figure 6).
    cube,
    /// The same with two paraboloids in place of six faces: their future work.
    dualParaboloid
};

/// What may be left out, each by itself. As they are: the least work. `paper()`: what the authors' program
/// did.
struct Economies {
    bool backFacing = true;  ///< mirrors seen from behind
    bool offScreen = true;   ///< mirrors, curved reflectors and objects outside what a view sees
    bool narrow = true;      ///< a mirror view sees through its mirror's polygon, not through the whole image
    bool scissor = true;     ///< pixels outside the mirror's bounds in the image are not drawn
    bool resolution =
        true;            ///< a map has as many texels as its mirror covers pixels, times `levelScale` ^ level
    bool detail = true;  ///< coarser levels of detail at depth
    bool occlusion = true;  ///< mirrors behind solid boxes
    bool share = true;      ///< coplanar mirrors share a view
    bool cutOff = true;     ///< branches whose product of reflectances falls below `cutOff`
    bool cap = true;        ///< at most `mostMaps`, the least visible left out

    static Economies paper() { return {true, false, false, false, false, false, false, false, false, false}; }
};

struct TreeSettings {
    int depth = 2;  ///< levels of recursion, 0 .. 32; 0: nothing reflects
    CurvedMaps curved = CurvedMaps::none;
    Economies economies;
    /// Texels of an image in which a whole view's reflections are drawn; 0: as many as the view has pixels.
    glm::ivec2 mapSize{0};
    /// At most, for a pixel of an image's side in which mirrors are met, where `mapSize` gives more (with
    /// Economies::resolution). A face's pixel is then the mean of so many squared: with 1, edges in curved
    /// mirrors have steps (45 dB where the paper's scene (c) has its chequered floor, over 50 in the others).
    double texelsPerPixel = 2;
    int faceSize = 128;           ///< of environment maps
    double levelScale = 1;        ///< texels a pixel, for each level of recursion; 0 < levelScale <= 1
    double cutOff = 1.0 / 256;    ///< share of the light, at normal incidence in the strongest channel
    /// Pixels times the share of their light below which a reflection is left out, too: what is dim may be
    /// large, what is small bright. With `Economies::cutOff`.
    double leastLight = 0;
    std::uint32_t mostMaps = 64;  ///< planar and view-dependent ones a frame
    double leastPixels = 1;       ///< mirrors that cover less are off screen
    /// View-independent maps are made anew this frame; false: momentarily static, all have theirs.
    bool refreshCurved = true;
    double curvedHalfAngle = 1.22;  ///< radians, half the field of view of a view-dependent map
};

/// A view of the caller: an eye before all mirrors.
struct TreeView {
    EyeView view;
    glm::ivec2 size{1280, 720};  ///< pixels
};

/// An image in which reflections are met: a caller's view, or a face of an environment map.
struct ReflectionRoot {
    static constexpr std::uint32_t none = 0xffffffffu;
    EyeView view;
    glm::ivec2 size{0};           ///< pixels
    HalfSpaces frustum;           ///< relative to the eye
    std::uint32_t curved = none;  ///< environment faces: whose; it is hidden from its own map
    std::uint32_t face = 0;       ///< 0 .. 5, or 0 .. 1
    std::uint32_t firstObject = 0, objectCount = 0;
    bool isEnvironment() const { return curved != none; }
};

/// One reflection to render: an image of level `level`'s map, shown by its mirrors in the parent's image.
struct ReflectionNode {
    static constexpr std::uint32_t none = 0xffffffffu;

    std::uint32_t root = 0;
    std::uint32_t parent = none;  ///< node in whose image this is met; none: in the root's
    std::uint32_t level = 0;      ///< whose map is used; 0 for what is met in a caller's view
    std::uint32_t firstMirror = 0, mirrorCount = 0;  ///< see ReflectionTree::mirrorsOf; 0: curved
    std::uint32_t curved = none;                     ///< view-dependent maps: of which reflector
    std::uint32_t hiddenCurved = none;  ///< not to be drawn here: the one in whose centre the eye is

    /// The eye behind the glass with the whole image's projection and its plain near plane.
    EyeView view;
    /// The same projection cut to `crop`: what to draw with, where the drawer clips by `glass`.
    glm::dmat4 clipFromView{1};
    /// The same with the mirror as near plane: where it does not. Equal for curved reflectors.
    glm::dmat4 obliqueClipFromView{1};
    HalfSpace glass{0, 0, 0,
                    1};  ///< draw only what is inside; (0, 0, 0, 1), everything, for curved reflectors
    HalfSpaces frustum;  ///< nothing outside is seen: for the drawer's culling

    NdcRect crop;              ///< part of the whole image that the map's `resolution` texels show
    glm::ivec2 resolution{0};  ///< texels of the level's map in use, from its lower left corner
    PixelRect scissor;         ///< of them, those worth drawing
    NdcRect bounds;            ///< of the mirrors in the parent's image; whole for curved
    double pixels = 0;    ///< that its mirrors cover in the caller's view, before occlusion: an upper bound
    float roughness = 0;  ///< its mirrors' largest, or its curved reflector's
    glm::vec3 throughput{1};    ///< product of reflectances on the way to the eye, its own included
    std::uint32_t coarser = 0;  ///< levels of detail below the view's
    std::uint32_t firstObject = 0, objectCount = 0;  ///< see ReflectionTree::objectsOf

    bool planar() const { return mirrorCount > 0; }
};

/// Where an environment map finds the others.
enum class MapAge : std::uint8_t { none, lastFrame, thisFrame };

/// A curved reflector's view-independent map to be made before the frame. It replaces the old one only when
/// it is complete.
struct EnvironmentJob {
    std::uint32_t curved = 0;
    std::uint32_t firstRoot = 0, rootCount = 0;  ///< its faces
    std::vector<MapAge> others;  ///< for each curved reflector, itself (behind mirrors) included
};

/// What was listed and what was left out, and why: each candidate is counted once.
struct TreeCounters {
    std::uint32_t planar = 0;  ///< maps of mirrors, those in environment maps included
    std::uint32_t planarInEnvironments = 0;
    std::uint32_t viewDependent = 0;  ///< maps of curved reflectors
    std::uint32_t faces = 0;          ///< of view-independent ones
    std::uint32_t backFacing = 0, offScreen = 0, occluded = 0, belowCutOff = 0, overCap = 0;
    std::uint32_t shared = 0;  ///< mirrors that use a companion's view
    std::uint32_t environmentsUnseen = 0;
    std::uint64_t texels = 0;  ///< drawn, of all maps and faces
    std::uint64_t objects = 0, objectsCulled = 0;
    std::uint32_t deepest = 0;  ///< levels in use
    std::uint32_t generated() const { return planar + viewDependent; }
};

enum class TreeStatus : std::uint8_t {
    ok,
    badSettings,  ///< depth, levelScale or sizes out of range: an empty tree
    tooMany       ///< 2^20 reflections without a cap: cut short there
};

/// Where the executor stands: the tree as a list of steps in which each level's map is made when met, used,
/// and free for the next.
struct ReflectionStep {
    enum class What : std::uint8_t {
        draw,    ///< the node's image, all but its children's mirrors, into its level's map
        apply,   ///< the node's map onto its mirrors, in its parent's image
        face,    ///< an environment face's image: `node` is a root
        publish  ///< an environment map is complete: `node` is a job
    };
    What what = What::draw;
    std::uint32_t node = 0;
    bool operator==(const ReflectionStep&) const = default;
};

/// Every reflection of a frame, in the order in which they are rendered.
struct ReflectionTree {
    TreeStatus status = TreeStatus::ok;
    std::vector<ReflectionRoot> roots;  ///< the callers' views first, in their order
    std::vector<ReflectionNode> nodes;  ///< depth first; a parent before its children
    std::vector<EnvironmentJob> environments;
    std::vector<std::uint32_t> mirrors, objects;
    std::vector<glm::ivec2> levelSize;  ///< texels each level's map needs: as many maps as levels in use
    TreeCounters counters;

    std::span<const std::uint32_t> mirrorsOf(const ReflectionNode& n) const {
        return std::span(mirrors).subspan(n.firstMirror, n.mirrorCount);
    }
    template <class Image>  // ReflectionNode or ReflectionRoot
    std::span<const std::uint32_t> objectsOf(const Image& image) const {
        return std::span(objects).subspan(image.firstObject, image.objectCount);
    }
    bool empty() const { return nodes.empty() && environments.empty(); }

    /// The steps before the caller's views: environment maps.
    std::vector<ReflectionStep> environmentSteps() const;
    /// The steps of one caller's view, to be taken after its own scene is drawn.
    std::vector<ReflectionStep> stepsOf(std::uint32_t root) const;
};

/// For each image, the nodes met in it, in order.
struct ReflectionChildren {
    explicit ReflectionChildren(const ReflectionTree& tree);
    std::vector<std::vector<std::uint32_t>> ofRoot, ofNode;
};

/// Lists the reflections of a frame. Deterministic; no graphics API. Mirrors are met in the order given,
/// planar ones before curved ones, as in the paper's figures 4 to 6; where `cap` is on, the most visible ones
/// are chosen first. Status instead of exceptions. Cost: for each listed image, mirrors times (their corners
/// times half spaces) and objects times half spaces.
ReflectionTree reflectionTree(std::span<const TreeView> views, const ReflectionScene& scene,
                              const TreeSettings& settings);

/// Texture bytes as the paper's Table 1 counts them: one map a level in use, and one map a curved reflector
/// where view-independent; `traditional`: one map for each planar reflector, and for each curved one.
struct MapMemory {
    std::uint64_t used = 0, traditional = 0;
};
MapMemory paperMemory(const TreeSettings& settings, std::size_t mirrors, std::size_t curved,
                      std::uint32_t bytesPerTexel = 4);

}  // namespace reflection
