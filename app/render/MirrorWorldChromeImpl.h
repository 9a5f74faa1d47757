#pragma once

#include <chrono>
#include <optional>

#include "app/render/MirrorWorldChrome.h"
#include "reflection/chrome/ChromeTree.h"
#include "reflection/gl/ChromeLayer.h"
#include "reflection/gl/ChromeSearchMesh.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

/// A mesh's corners, each place and value once: triangles that meet without a crease share searches.
struct WeldedMesh {
    std::vector<glm::vec3> positions;
    std::vector<float> values;
    std::vector<std::uint32_t> indices;
};

inline double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The pixels in which a ball may be seen; all where the eye is close to it.
reflection::PixelRect pixelsOf(const reflection::EyeView& view, const glm::ivec2& size,
                               const glm::dvec3& centre, double radius);

struct MirrorWorldChrome::Impl {
    explicit Impl(const MirrorWorld& w) : world(w) {}

    struct Object {
        std::size_t index;
        reflection::VirtualMesh mesh;
    };
    /// A piece of another reflector, close to this one.
    struct Body {
        std::size_t index, piece;
        reflection::VirtualMesh mesh;
        std::optional<gl::ChromeMesh> drawn;
    };
    struct Piece {
        const reflection::ReflectorPiece* piece = nullptr;
        std::vector<Object> objects;
        std::optional<gl::ChromeMesh> drawn;  ///< all objects
        std::vector<Body> bodies;
        gl::Buffer vertices, indices;
        gl::VertexArray array;
        std::optional<reflection::ChromeSearchMesh> onGpu;  ///< all objects, where the GPU searches
    };
    struct Chrome {
        std::vector<bool> close, closeCurved;
        std::unique_ptr<reflection::Reflector> reflector;
        std::vector<Piece> pieces;                                  ///< of the reflector's, the same ones
        std::vector<std::vector<reflection::SurfacePoint>> points;  ///< of each piece
        double reach = 0;                                           ///< metres from its centre
    };
    /// What chrome is drawn into: the picture on screen, or that of a node.
    struct Image {
        reflection::EyeView view;
        glm::ivec2 size{0};
        std::uint32_t framebuffer = 0;
        std::uint32_t node = reflection::ChromeNode::none;
    };

    const MirrorWorld& world;
    reflection::VirtualMeshOptions options;
    std::vector<Chrome> chrome;
    std::vector<WeldedMesh> objects;  ///< the world's
    reflection::ChromeTreeOptions bounces;
    reflection::ChromeTree tree;
    std::vector<gl::ChromeLayer> pictures;  ///< of the tree's nodes, in their order
    std::optional<gl::ChromeLayer> layer;
    gl::Program virtualObjects, virtualBodies, apply;
    bool searchOnGpu = false;
    std::optional<reflection::ChromeSearch> search;
    gl::Program searched;  ///< draws what the GPU has searched for

    bool hollow(std::size_t curved) const {
        for (const Piece& p : chrome[curved].pieces)
            if (p.piece->bend == reflection::Bend::concave && !p.piece->built.map.empty()) return true;
        return false;
    }
    void makeGlObjects();
    void plan(const reflection::EyeView& view, const glm::ivec2& size);
    void makePicture(std::uint32_t node, const ChromeEnvironments& environments, ChromeFrame& frame);
    reflection::VirtualMeshOptions optionsFor(const Image& image, std::size_t curved) const;
    void drawPieces(const Image& image, std::size_t curved, const reflection::PixelRect& pixels,
                    const ChromeEnvironments& environments, ChromeFrame& frame);
    void drawBodies(const Image& image, std::size_t curved, std::size_t piece,
                    const reflection::VirtualMeshOptions& how, const glm::mat4& clip,
                    const ChromeEnvironments& environments, ChromeFrame& frame);
    void drawBody(const reflection::ChromeNode& node, Body& body, const reflection::EyeView& view,
                  const ChromeEnvironments& environments, ChromeFrame& frame);
    void drawPiece(const Image& image, std::size_t curved, std::size_t piece,
                   const reflection::PixelRect& pixels, gl::ChromeLayer& into,
                   const ChromeEnvironments& environments, ChromeFrame& frame);
    static void add(const reflection::VirtualCounts& counts, const reflection::VirtualMesh& mesh,
                    ChromeFrame& frame) {
        ++frame.meshes;
        frame.vertices += mesh.vertices().size();
        frame.searched += counts.searched;
        frame.lookups += counts.lookups;
        frame.triangles += mesh.indices().size() / 3;
    }

    gl::Sampler linear;
    std::vector<glm::dvec3> places;
    std::vector<reflection::ReflectionPoint> lookups;
    std::vector<float> bodyValues;
};

}  // namespace app
