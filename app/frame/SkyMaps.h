#pragma once

#include <map>

#include "app/frame/Lighting.h"
#include "reflection/local_map/LocalMap.h"

namespace app {

/// The sky alone as the local maps of each size show it: what a vehicle sees where no building stands, the
/// same from every place. Kept until the light changes.
class SkyMaps {
  public:
    /// Depth is +infinity throughout. The reference holds until the light changes. Cost: four evaluations of
    /// `skyRadiance` a texel, on all cores, for a size or light that is new; else a look at the light.
    const reflection::LocalMap& of(const Lighting& lighting, int faceSize);

  private:
    Lighting lighting_;
    std::map<int, reflection::LocalMap> maps_;
};

}  // namespace app
