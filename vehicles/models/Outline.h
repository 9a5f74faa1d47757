#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "vehicles/models/Shell.h"

namespace vehicles {

/// A closed plane curve: a polygon whose corners are rounded.
class Outline {
  public:
    struct Corner {
        glm::vec2 at{0};
        float radius =
            0.03f;  ///< metres cut back from the corner along both sides; shortened where they are short
    };
    explicit Outline(const std::vector<Corner>& corners);
    /// All corners with the same radius.
    Outline(const std::vector<glm::vec2>& corners, float radius);

    /// Distance to the curve in metres, negative inside. Linear in the number of points (Quilez: distance to
    /// polygon).
    float distance(const glm::vec2& p) const;

  private:
    void build(const std::vector<Corner>& corners);
    std::vector<glm::vec2> points_;
    glm::vec2 low_{0}, high_{0};
};

/// An outline in side view (x, z), on the flanks where |y| > inner and z > above.
Field inSideView(Outline outline, float inner, float above);
/// In front view (|y|, z), where x > behind; and in rear view, where x < before.
Field inFrontView(Outline outline, float behind);
Field inRearView(Outline outline, float before);
/// In front or rear view with the flank unrolled round the corner: the first coordinate is |y| + |x - face|.
Field roundTheFront(Outline outline, float face);
Field roundTheRear(Outline outline, float face);
/// In top view (x, |y|), where z > above.
Field inTopView(Outline outline, float above);
/// Below a height that changes linearly with x.
Field below(float z, float slope = 0);

Field grown(Field field, float by);  ///< the region grown by a distance
Field both(Field a, Field b);        ///< inside both
Field either(Field a, Field b);      ///< inside one of them

}  // namespace vehicles
