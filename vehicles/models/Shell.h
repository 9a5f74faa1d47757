#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "vehicles/models/VehicleModel.h"

namespace vehicles {

/// A function of position and normal on a shell, negative inside a region; near zero it should be a distance
/// in metres.
using Field = std::function<float(const glm::vec3& position, const glm::vec3& normal)>;

/// A triangulated surface that is divided along the zero lines of fields: windows, gaps, lamps and wheel
/// arches are cut precisely, whatever the triangles were. Both sides of a cut share its vertices, so no cut
/// opens a crack.
class Shell {
  public:
    struct Triangle {
        std::array<std::uint32_t, 3> corner{};
        Surface surface = Surface::paint;
    };
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< one a position, unit length
    std::vector<Triangle> triangles;

    /// Halves edges near the field's zero line until none there is longer than `longest` metres, so that the
    /// line's corners and narrow parts are met. New vertices lie on the old triangles, with interpolated
    /// normals.
    void refine(const Field& field, float longest);

    /// Divides all triangles along the zero line. Cost: linear in the triangles.
    void divide(const Field& field);

    /// Divides, then gives the inside its surface, but only where it is still one of `over` (empty:
    /// everywhere).
    void assign(const Field& field, Surface surface, const std::vector<Surface>& over = {});

    /// The same for a line of the given half width along the field's zero line.
    void assignLine(const Field& field, float halfWidth, Surface surface,
                    const std::vector<Surface>& over = {});

    /// Divides and takes the inside away.
    void remove(const Field& field);

    /// Moves the vertices with a negative field by `depth` metres against their normals.
    void recess(const Field& field, float depth);

    /// Fewer triangles: about `target`, sooner if the next step would move the surface by more than `error`
    /// metres. Borders of surfaces and of the shell stay, and every vertex that stays keeps its exact normal
    /// (meshoptimizer).
    void simplify(std::size_t target, float error);

    /// Adds the mirror image across y = 0; vertices nearer than `seam` metres to that plane are put on it and
    /// shared.
    void mirror(float seam = 1e-4f);

    /// Vertices shared within each surface, texture coordinates zero. Unused vertices are left out.
    city::Mesh mesh() const;
};

}  // namespace vehicles
