#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>

#include "app/frame/Lighting.h"
#include "reflection/local_map/LocalMap.h"
#include "reflection/local_map/LocalMapBuilder.h"

namespace app {

/// The local maps of what stands, as they are without vehicles: traced once, so that what is left to do when
/// something passes is to draw it into a copy.
class StandingMaps {
  public:
    class Kept {
      public:
        /// Copies a face into a map of the same size; false: it is not known.
        bool give(int face, reflection::LocalMap& to) const;
        /// Remembers a face. Faces may be kept at the same time.
        void keep(int face, const reflection::LocalMap& from);

      private:
        friend class StandingMaps;
        reflection::LocalMap map_;
        Lighting lighting_;
        reflection::LocalMapMethod method_ = reflection::LocalMapMethod::mem;
        int lookups_ = 0;
        std::size_t candidates_ = 0;
        std::array<char, 6> known_{};
    };

    void forget() { kept_.clear(); }
    /// Of the one with this id, made as this request asks in this light: empty where it was made otherwise,
    /// or never. Good until `forget`. Its place must not change.
    Kept& of(std::uint32_t id, const Lighting& lighting, const reflection::LocalMapRequest& request);

  private:
    std::map<std::uint32_t, Kept> kept_;
};

}  // namespace app
