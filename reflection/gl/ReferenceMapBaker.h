#pragma once

#include <memory>

#include "reflection/gl/SceneDrawer.h"
#include "reflection/reference_maps/ReferenceMap.h"

namespace reflection {

/// Renders reference maps of the static scene. Needs a current GL 4.5 context in every call and at
/// destruction.
class ReferenceMapBaker {
  public:
    /// `supersampling`: side of the square of samples averaged into one texel, 1 .. 4.
    ReferenceMapBaker(int faceSize, int supersampling = 2);
    ~ReferenceMapBaker();

    /// What the drawer's scene looks like from a centre. Colour is the mean of a texel's samples; distance
    /// the harmonic mean (exact on planes) where the samples belong to one surface, else the one of the
    /// surface that has most of the texel.
    ReferenceMap bake(SceneDrawer& drawer, const glm::dvec3& centre, const CubeContent& content = {});

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace reflection
