#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/ShownTriangles.h"
#include "reflection/chrome/VirtualMesh.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"
#include "reflection/planar/ReflectionTree.h"

namespace reflection::gl {

/// An image as large as a view into which the virtual objects of one piece of a reflector are drawn, with a
/// depth of their own: paths' lengths order them, not what stands in the scene. The piece's pixels then take
/// what it holds. One layer serves all pieces in turn. Colour: RGBA16F, linear radiance and 1 where something
/// is mirrored.
class ChromeLayer {
  public:
    /// Binds the layer, its viewport the whole view and its scissor the rectangle, both cleared there: colour
    /// to nothing, depth (reversed) to infinitely far. Grows to the view's size when needed. Sets depth test
    /// and scissor; the caller restores what it needs.
    void begin(const glm::ivec2& viewSize, const PixelRect& rectangle);
    /// After `begin`: from here on, what is drawn opens the layer where it covers it, and all the rest of the
    /// rectangle stays closed to what comes after `endMask`, which then costs nothing there.
    void beginMask();
    void endMask();
    GLuint colour() const { return colour_.name(); }
    GLuint depth() const { return depth_.name(); }
    const glm::ivec2& size() const { return size_; }  ///< texels, of which the view has the first
    std::size_t bytes() const {
        return static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * 12;
    }

  private:
    glm::ivec2 size_{0};
    Texture colour_, depth_;
    Framebuffer framebuffer_;
};

/// A VirtualMesh's buffers: where its vertices are drawn (location 0: vec3 from the eye), its triangles, and
/// the host's own attributes of each vertex, from location 1 on.
class ChromeMesh {
  public:
    /// Floats of the host's attributes: how many each of them has.
    explicit ChromeMesh(std::vector<int> attributes);

    /// Takes an updated mesh over. `ofVertices`: the host's floats for the mesh's own vertices; those of
    /// middles are mixed from their ends'.
    void upload(const VirtualMesh& mesh, std::span<const float> ofVertices);
    /// The same without triangles that draw nothing in this window.
    void upload(const VirtualMesh& mesh, std::span<const float> ofVertices, const VirtualWindow& window);
    struct Part {
        const VirtualMesh* mesh = nullptr;
        std::span<const float> ofVertices = {};
    };
    /// Several, drawn at once, the nearest first: without what no triangle of theirs names. A draw of its own
    /// for each costs a software rasteriser more than their triangles do.
    void upload(std::span<const Part> parts, const VirtualWindow& window);
    /// Draws with the program in use.
    void draw() const;

  private:
    /// The values of all of a mesh's vertices.
    void mix(const VirtualMesh& mesh, std::span<const float> ofVertices);

    std::size_t stride_ = 0;
    Buffer places_ = Buffer::create(), values_ = Buffer::create(), indices_ = Buffer::create();
    VertexArray array_ = VertexArray::create();
    std::vector<float> all_, joined_;
    std::vector<VirtualVertex> vertices_;
    std::vector<std::uint32_t> numbers_, corners_, shown_;
    GLsizei count_ = 0;
};

}  // namespace reflection::gl
