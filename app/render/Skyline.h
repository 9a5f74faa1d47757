#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "city/geometry/Aabb.h"
#include "city/model/CityModel.h"

namespace app {

/// The masses of a city's buildings as a grid of columns, each solid from the ground up to its height, made
/// so that nothing is claimed to be solid that is not: a column counts only where roofs cover all of its
/// surroundings within `margin`, with the lowest height there; where something has an underside above the
/// ground (a balcony, a passage) or does not reach the ground, there is no column. Gaps between roofs
/// narrower than the spacing of the columns are not seen. What hides behind it is found by SkylineView.
class Skyline {
  public:
    static constexpr float spacing = 0.5f;  ///< metres between columns
    static constexpr float margin = 2;      ///< metres: overhanging eaves, and half the width of a beam

    explicit Skyline(const city::CityModel& city);

    /// Height of the column at a place, -infinity where there is none.
    float heightAt(const glm::vec2& p) const {
        const auto i = static_cast<int>((p.x - origin_.x) * (1 / spacing));
        const auto j = static_cast<int>((p.y - origin_.y) * (1 / spacing));
        if (p.x < origin_.x || p.y < origin_.y || i >= width_ || j >= height_) return -infinity;
        return heights_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(i)];
    }
    float highest() const { return highest_; }
    bool empty() const { return heights_.empty(); }

  private:
    static constexpr float infinity = std::numeric_limits<float>::infinity();
    glm::vec2 origin_{0};
    int width_ = 0;
    int height_ = 0;
    float highest_ = -infinity;
    std::vector<float> heights_;
};

/// What an eye sees over the skyline: for beams all around, how steeply one must look up to pass over
/// everything nearer than a distance. Cost to make: one walk along each beam, ended as soon as nothing in the
/// city could stick out behind.
class SkylineView {
  public:
    struct Sector {
        float from = 0;             ///< azimuth, radians from +x towards +y
        float width = 6.28318531f;  ///< radians
    };
    /// `beams` in the full circle; only those that cross the sector are walked, and what lies outside it
    /// counts as hidden.
    SkylineView(const Skyline& skyline, const glm::dvec3& eye, int beams, const Sector& sector)
        : SkylineView(skyline, eye, beams, sector, glm::dvec4(0)) {}
    /// The same for an eye behind an upright mirror that sees through it (dot(xyz, p - eye) + w >= 0 in
    /// front): what stands behind the mirror hides nothing. A mirror that leans hides nothing at all.
    SkylineView(const Skyline& skyline, const glm::dvec3& eye, int beams, const Sector& sector,
                const glm::dvec4& glass);

    /// The azimuths that a view sees; the full circle when it sees straight up or down.
    static Sector sectorOf(const glm::mat4& clipFromRelative);

    /// Whether all of a box (world) lies behind buildings. Never true for anything that can be seen.
    bool hides(const city::Aabb& box) const;

  private:
    struct Step {
        float distance;
        float slope;  ///< rise over run, above which one sees past all that is nearer
    };
    bool nothingHidden_ = true;
    glm::vec3 eye_{0};
    int beams_ = 0;
    float beamWidth_ = 0;
    std::vector<bool> wanted_;
    std::vector<std::uint32_t> first_;  ///< of each beam's steps; one more at the end
    std::vector<Step> steps_;
};

}  // namespace app
