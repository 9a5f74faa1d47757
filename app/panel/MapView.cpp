#include "app/panel/MapView.h"

#include <epoxy/gl.h>

#include <array>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "reflection/gl/Framebuffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"
#include "reflection/gl/VertexArray.h"

namespace app {

namespace {

namespace gl = reflection::gl;

constexpr int shownFaceSize = 128;  // pixels; the finest local maps are as large

/// Place of a face in the picture, and what is to the right and up in it. The shader local_map_view.frag has
/// the same table.
struct FaceCell {
    glm::ivec2 cell;
    glm::dvec3 forward, right, up;
};
const std::array<FaceCell, 6> cells{{
    {{2, 1}, {1, 0, 0}, {0, -1, 0}, {0, 0, 1}},   // +X: east
    {{0, 1}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   // -X: west
    {{1, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}},    // +Y: north
    {{3, 1}, {0, -1, 0}, {-1, 0, 0}, {0, 0, 1}},  // -Y: south
    {{1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}},   // +Z: up, above north
    {{1, 2}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}},   // -Z: down, below north
}};

/// Direction of a face point, by OpenGL's table of cube faces.
glm::dvec3 faceDirection(int face, double s, double t) {
    const double sc = 2 * s - 1;
    const double tc = 2 * t - 1;
    switch (face) {
        case 0:
            return {1, -tc, -sc};
        case 1:
            return {-1, -tc, sc};
        case 2:
            return {sc, 1, tc};
        case 3:
            return {sc, -1, -tc};
        case 4:
            return {sc, -tc, 1};
        default:
            return {-sc, -tc, -1};
    }
}

}  // namespace

glm::vec2 unfolded(int face, double s, double t) {
    const FaceCell& cell = cells.at(static_cast<std::size_t>(face));
    const glm::dvec3 direction = faceDirection(face, s, t);
    const double along = glm::dot(direction, cell.forward);
    const glm::dvec2 inCell(0.5 + 0.5 * glm::dot(direction, cell.right) / along,
                            0.5 - 0.5 * glm::dot(direction, cell.up) / along);
    return glm::vec2((glm::dvec2(cell.cell) + inCell) / glm::dvec2(mapViewFaces));
}

std::vector<MapLine> unfoldedMesh(int face, std::span<const reflection::LocalMapMesh::Quad> quads,
                                  int latticeSize) {
    std::vector<MapLine> lines;
    if (latticeSize < 1) return lines;
    const double scale = 1.0 / latticeSize;
    for (const auto& quad : quads) {
        const double s0 = quad.x * scale, t0 = quad.y * scale, s1 = (quad.x + quad.size) * scale,
                     t1 = (quad.y + quad.size) * scale;
        // Two sides of each quad: its neighbours draw the others.
        lines.push_back({unfolded(face, s0, t0), unfolded(face, s1, t0)});
        lines.push_back({unfolded(face, s0, t0), unfolded(face, s0, t1)});
    }
    lines.push_back({unfolded(face, 1, 0), unfolded(face, 1, 1)});
    lines.push_back({unfolded(face, 0, 1), unfolded(face, 1, 1)});
    return lines;
}

struct MapView::Impl {
    gl::Texture picture =
        gl::Texture::image2D(GL_RGBA8, mapViewFaces.x* shownFaceSize, mapViewFaces.y* shownFaceSize);
    gl::Framebuffer framebuffer = gl::Framebuffer::create();
    gl::Program program = gl::Program::fromFiles({"fullscreen.vert", "local_map_view.frag"});
    gl::VertexArray nothing = gl::VertexArray::create();
};

MapView::MapView() : impl_(std::make_unique<Impl>()) {
    impl_->framebuffer.attach(GL_COLOR_ATTACHMENT0, impl_->picture.name());
    impl_->framebuffer.requireComplete("the view of a local map");
}

MapView::~MapView() = default;

std::uint32_t MapView::draw(const reflection::LocalMapTextures& textures,
                            const reflection::LocalMapSlot& slot, float exposure) {
    if (!slot.valid() || textures.cubeArrays.at(static_cast<std::size_t>(slot.sizeClass)) == 0) return 0;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, impl_->framebuffer.name());
    glViewport(0, 0, mapViewFaces.x * shownFaceSize, mapViewFaces.y * shownFaceSize);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    impl_->program.use();
    impl_->program.set("layer", static_cast<int>(slot.layer));
    impl_->program.set("exposure", exposure);
    impl_->program.set("faces", glm::vec2(mapViewFaces));
    impl_->program.set("pictureSize", glm::vec2(mapViewFaces * shownFaceSize));
    glBindTextureUnit(0, textures.cubeArrays[static_cast<std::size_t>(slot.sizeClass)]);
    impl_->program.set("maps", 0);
    glBindVertexArray(impl_->nothing.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return impl_->picture.name();
}

}  // namespace app
