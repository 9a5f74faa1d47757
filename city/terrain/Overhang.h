#pragma once

#include "city/terrain/Heightfield.h"

namespace city {

/// Columns that hang with air beneath them, as crowns of trees do: column (i, j) is solid from its
/// `underside` up to its `top` (metres, world z). NaN and -infinity in either, or a top that is not above
/// the underside: nothing hangs there. Both fields have the same cells.
struct Overhang {
    Heightfield underside, top;

    bool hangs(int i, int j) const { return top.at(i, j) > underside.at(i, j) && underside.at(i, j) > none; }

  private:
    static constexpr float none = -3.402823466e+38f;
};

}  // namespace city
