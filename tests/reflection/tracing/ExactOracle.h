#pragma once

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <boost/multiprecision/cpp_int.hpp>
#pragma GCC diagnostic pop

#include <glm/vec2.hpp>
#include <vector>

#include "city/geometry/Ray.h"
#include "city/terrain/Heightfield.h"
#include "reflection/tracing/GridTracer.h"

namespace reflection {

/// GridTracer's rules, transcribed literally into big integers: every border that the ray crosses is listed
/// with its parameter as a fraction, the list is sorted, and the chain of cells is read off. Slow; shares
/// nothing with the tracer.
class ExactOracle {
  public:
    using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
        1536, 1536, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

    struct Answer {
        TraceStatus status = TraceStatus::miss;
        glm::ivec2 cell{-1};
        Integer numerator = 0;    ///< exact parameter = numerator / denominator
        Integer denominator = 1;  ///< > 0
    };

    explicit ExactOracle(const city::Heightfield& field);
    Answer trace(const city::Ray& ray) const;

    /// Is t within the bound that ExactWalk.h derives: |t - t*| <= (2^-24 + 2^-51) |t*| + 2^-150?
    static bool withinBound(float t, const Answer& answer);
    /// Does the exact parameter round to a float that is not finite?
    static bool beyondFloats(const Answer& answer);

  private:
    const city::Heightfield& field_;
};

}  // namespace reflection
