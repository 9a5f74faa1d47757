#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "reflection/chrome/SurfacePatches.h"

namespace reflection {

/// How a piece of a reflector curves, seen from its reflecting side.
enum class Bend : std::uint8_t {
    convex,  ///< its map's centre lies behind it; a vertex has at most one reflection point
    concave  ///< its map's centre lies in front of it (bowls, saddles seen from inside): any number of them
};

/// Where a map lies in its reflector's frame. Moving, turning and dividing by `scale` keeps angles: that is
/// the frame of searches ("the map's frame"). Before directions are looked up on the cube, each axis is
/// divided by its `stretch` on top, so that a long or flat part (a bumper, a handle) fills the cube as evenly
/// as a round one: what is star-shaped, convex or an ellipsoid stays so.
struct MapFrame {
    glm::dvec3 centre{0};   ///< in the reflector's frame, metres
    glm::dmat3 axes{1};     ///< columns: the map's axes in the reflector's frame, orthonormal
    double scale = 1;       ///< metres per unit
    glm::dvec3 stretch{1};  ///< along each axis, 1 the greatest

    glm::dvec3 toMap(const glm::dvec3& p) const { return (p - centre) * axes / scale; }
    glm::dvec3 fromMap(const glm::dvec3& p) const { return centre + axes * (scale * p); }
    glm::dvec3 toMapDirection(const glm::dvec3& d) const { return d * axes; }
    glm::dvec3 fromMapDirection(const glm::dvec3& d) const { return axes * d; }
};

/// A reflector's surface as a pair of cube maps, position and normal, around a centre from which every point
/// of the surface is seen (it is star-shaped). Source: Estalella et al. 2005, section 4.1.
///
/// Departures from the paper, each for accuracy. The cube is a lattice of corners, not of texel centres, so
/// faces share their borders and the interpolated surface is continuous. A corner holds the tangent plane
/// there in four floats: `n |g|` and `1 / (n |g| . p)`, with g the corner's point on the cube of half side 1,
/// n the unit normal and p the position (both after the stretch), from which position and normal both follow.
/// The reciprocal distance along g, q, is linear over a face for a plane; blending the corners' values of q
/// with those that their tangent planes predict is exact for planes and has an error of fourth order in the
/// cell size for smooth surfaces (the paper's linear interpolation: second order). Normals are blended as n
/// |g|, exact for planes and for ellipsoids about the centre whose axes are the stretch.
///
/// Frame: that of MapFrame below, so that a reflector of a millimetre and one of a kilometre have the same
/// numbers.
class ReflectorMap {
  public:
    /// Four floats of a corner: n |g| and 1 / (n |g| . p).
    using Corner = glm::vec4;

    /// The surface in one direction from the centre, in the map's frame.
    struct Sample {
        glm::dvec3 position{0};
        glm::dvec3 normal{0, 0, 1};
        double gauge = 0;      ///< |direction| / |position|: below 1 the direction's end is inside
        bool covered = false;  ///< false: closing surface, not the part's own
    };

    /// An empty map: no faces, resolution 0.
    ReflectorMap() = default;

    /// Takes 6 (n + 1)^2 corners, face by face (OpenGL's order), rows along t, and which of them the part
    /// covers.
    ReflectorMap(int cellsPerSide, Bend bend, const MapFrame& frame, std::vector<Corner> corners,
                 std::vector<std::uint8_t> covered);

    bool empty() const { return cells == 0; }
    int cellsPerSide() const { return cells; }
    Bend bend() const { return curvature; }
    const MapFrame& frame() const { return place; }

    /// The surface in a direction (any length but zero; zero and NaN give face 0's middle). Cost: four
    /// corners.
    Sample sample(const glm::dvec3& direction) const;
    /// Whether the part itself (not its closing surface) is seen in a direction.
    bool covered(const glm::dvec3& direction) const { return whole || coveredShare(direction) >= 0.5; }
    /// Share of a direction's four corners, as they are blended, that the part itself covers.
    double coveredShare(const glm::dvec3& direction) const;
    /// The part covers every direction: there is no closing surface.
    bool closed() const { return whole; }

    /// How far a point is from the part's rim, the stretch taken out; infinite where it has none. Cost: a
    /// nanosecond for every corner at the rim, some hundred.
    double fromRim(const glm::dvec3& point) const;

    /// A direction (before the stretch is taken out) in which the surface's normal is close to the given one,
    /// the nearest of a table: where a search for a far vertex starts.
    glm::dvec3 directionOfNormal(const glm::dvec3& normal) const;

    /// Distances from the centre between which the whole surface lies once the stretch is taken out.
    double innerRadius() const { return inner; }
    double outerRadius() const { return outer; }

    std::span<const Corner> corners() const { return values; }
    std::span<const std::uint8_t> coverage() const { return own; }
    /// For each of 6 normalTableSide^2 normals the point on the cube where it is found.
    std::span<const glm::vec3> normalTable() const { return byNormal; }
    /// The same table of points that the part itself covers; empty where it covers all or none.
    std::span<const glm::vec3> coveredNormalTable() const { return byCoveredNormal; }
    static constexpr int normalTableSide = 24;  ///< texels per side of a face of the table

    /// Where reflection points can be; for searches for all of them.
    const SurfacePatches& patches() const { return balls; }

    std::size_t bytes() const {
        return balls.bytes() + values.size() * sizeof(Corner) + own.size() +
               (byNormal.size() + byCoveredNormal.size() + rim.size()) * sizeof(glm::vec3);
    }

    /// Number of corners of a map of so many cells, and the index of one.
    static std::size_t cornerCount(int cells) {
        return 6 * static_cast<std::size_t>(cells + 1) * static_cast<std::size_t>(cells + 1);
    }
    static std::size_t cornerIndex(int cells, int face, int column, int row) {
        const auto side = static_cast<std::size_t>(cells + 1);
        return (static_cast<std::size_t>(face) * side + static_cast<std::size_t>(row)) * side +
               static_cast<std::size_t>(column);
    }
    /// A corner's point on the cube of half side 1.
    static glm::dvec3 cornerPoint(int cells, int face, int column, int row);

  private:
    std::vector<glm::vec3> indexNormals(bool coveredOnly) const;
    void findRadii();
    void findRim();

    int cells = 0;
    Bend curvature = Bend::convex;
    MapFrame place;
    double inner = 0, outer = 0;
    bool whole = false;  ///< no closing surface
    std::vector<Corner> values;
    std::vector<std::uint8_t> own;
    std::vector<glm::vec3> byNormal, byCoveredNormal;
    std::vector<glm::vec3> rim;  ///< places of the part's corners beside one that is not its own
    SurfacePatches balls;
};

}  // namespace reflection
