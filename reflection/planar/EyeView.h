#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace reflection {

/// A rectangle of normalised device coordinates.
struct NdcRect {
    glm::dvec2 low{-1}, high{1};
    bool empty() const { return !(low.x < high.x && low.y < high.y); }
    glm::dvec2 size() const { return high - low; }
};

/// A rectangle of pixels, low inclusive, high exclusive, from the lower left corner as OpenGL counts.
struct PixelRect {
    glm::ivec2 low{0}, high{0};
    bool empty() const { return low.x >= high.x || low.y >= high.y; }
    glm::ivec2 size() const { return high - low; }
    std::int64_t area() const { return empty() ? 0 : std::int64_t{size().x} * size().y; }
    bool operator==(const PixelRect&) const = default;
};

/// How directions of view space become places in the image.
enum class Projection : std::uint8_t {
    perspective,
    /// The half space before the eye, and a little more, on a disc: Heidrich & Seidel 1998. Drawn by warping
    /// vertices: (x, y) / (1 - z) of the unit direction, view space looking along -z. `clipFromView` is then
    /// unused but for its near distance, [3][2].
    paraboloid
};

/// An eye in the world, or behind mirrors: in a view seen through an odd number of mirrors the rotation has
/// determinant -1, what it draws is wound the other way, and world space, normals and lights stay as they
/// are. View space: x right, y up, z towards the viewer. Depth is reversed, clip z runs from w at the near
/// plane to 0 at infinity (clip control zero-to-one).
struct EyeView {
    glm::dvec3 eye{0};            ///< world metres
    glm::dmat3 viewFromWorld{1};  ///< orthonormal
    glm::dmat4 clipFromView{1};
    Projection projection = Projection::perspective;

    /// Whether triangles are seen wound the other way round.
    bool mirrored() const { return glm::determinant(viewFromWorld) < 0; }
    /// clipFromView without the translation to the eye: for points relative to it, world axes.
    glm::dmat4 clipFromRelative() const { return clipFromView * glm::dmat4(viewFromWorld); }
    glm::dvec4 clip(const glm::dvec3& world) const {
        return clipFromView * glm::dvec4(viewFromWorld * (world - eye), 1);
    }
};

/// A symmetric perspective view with the far plane at infinity. The identity rotation where target and eye
/// coincide or are not finite; straight up or down, north takes the place of up.
/// Preconditions: 0 < fovY < pi, aspect > 0, nearPlane > 0.
EyeView perspectiveView(const glm::dvec3& eye, const glm::dvec3& target, double fovYRadians, double aspect,
                        double nearPlane = 0.1);

/// Face 0 .. 5 (+X -X +Y -Y +Z -Z) of a cube map around an eye, such that the image lies as OpenGL samples it
/// (table 8.19 of its specification). Its rotation has determinant -1: cube faces are left-handed.
EyeView cubeFaceView(const glm::dvec3& eye, int face, double nearPlane);

/// Half of a dual paraboloid around an eye: 0 looks along +z, 1 along -z.
EyeView paraboloidView(const glm::dvec3& eye, int half, double nearPlane);

/// The part of a perspective view's image that lies in `rect`, stretched to the whole.
glm::dmat4 cropped(const glm::dmat4& clipFromView, const NdcRect& rect);

}  // namespace reflection
