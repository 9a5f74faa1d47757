#pragma once

#include <queue>

#include "reflection/planar/ReflectionTree.h"

namespace reflection {

/// Grows a ReflectionTree: images whose reflections are still to be found wait in a queue, the most visible
/// first where the number of maps is capped. A child is never more visible than its parent, so what is taken
/// is the most visible set of all.
class TreeBuilder {
  public:
    TreeBuilder(const ReflectionScene& scene, const TreeSettings& settings, ReflectionTree& tree);

    void addView(const TreeView& view);
    /// View-independent maps of those that some image shows.
    void addEnvironments();
    /// Takes candidates until none is left, or the cap is reached.
    void grow();
    /// Puts the nodes in order of rendering; counts.
    void finish();

  private:
    struct Candidate {
        ReflectionNode node;
        std::vector<std::uint32_t> mirrors;
        /// As an Image. A mirror view has the pixels of the image in which the mirror is met.
        struct Inner {
            glm::ivec2 grid{0};
            double pixelsPerNdc = 0;
            bool inCurved = false;
        } inner;
        double priority = 0;
        std::uint64_t sequence = 0;
        bool operator<(const Candidate& b) const {
            return priority != b.priority ? priority < b.priority : sequence > b.sequence;
        }
    };
    /// An image in which reflectors are met.
    struct Image {
        std::uint32_t root = 0, node = ReflectionNode::none;
        const EyeView* view = nullptr;
        const HalfSpaces* frustum = nullptr;
        const HalfSpace* glass = nullptr;  ///< null before all mirrors
        std::uint32_t level = 0;           ///< of the maps of what is met
        glm::vec3 throughput{1};
        double pixels = 0;        ///< of the caller's view that this image covers at most
        double pixelsPerNdc = 0;  ///< pixels in the caller's view of one unit of this image's area
        std::uint32_t hiddenCurved = ReflectionNode::none;
        glm::ivec2 grid{0};  ///< texels of a mirror view's whole image
        std::uint32_t coarser = 0;
        bool inCurved = false;  ///< a curved reflector's map, or seen through one
    };

    /// A mirror as an image shows it; several, where they share a view.
    struct Seen {
        std::vector<std::uint32_t> mirrors;
        Portal portal;
        EyeView mirrored;
        std::uint32_t group = Mirror::alone;
    };

    void meet(const Image& image);
    void meetMirrors(const Image& image);
    void meetCurved(const Image& image);
    bool see(const Image& image, std::uint32_t index, Seen& seen);
    bool occluded(const Image& image, const Portal& portal, const Mirror& mirror) const;
    void addMirror(const Image& image, Seen& seen);
    void push(Candidate&& candidate);
    void take(Candidate&& candidate);
    void listObjects(const EyeView& view, const HalfSpaces& frustum, std::uint32_t& first,
                     std::uint32_t& count);
    glm::ivec2 gridOf(const ReflectionRoot& root) const;
    bool dark(const glm::vec3& throughput) const;
    bool shows(const CurvedReflector& c, const EyeView& view, const HalfSpaces& frustum) const;

    const ReflectionScene& scene_;
    const TreeSettings& settings_;
    ReflectionTree& tree_;
    std::priority_queue<Candidate> waiting_;
    std::uint64_t sequence_ = 0;
    bool allObjectsListed_ = false;
};

}  // namespace reflection
