#include "app/frame/StandingMaps.h"

#include <algorithm>

namespace app {

namespace {

void copyFace(const reflection::LocalMap& from, int face, reflection::LocalMap& to) {
    const auto first = static_cast<std::ptrdiff_t>(from.faceOffset(face));
    const auto count = static_cast<std::ptrdiff_t>(from.faceSize) * from.faceSize;
    for (auto plane : {&reflection::LocalMap::red, &reflection::LocalMap::green, &reflection::LocalMap::blue,
                       &reflection::LocalMap::depth})
        std::copy_n((from.*plane).begin() + first, count, (to.*plane).begin() + first);
}

}  // namespace

bool StandingMaps::Kept::give(int face, reflection::LocalMap& to) const {
    if (known_[static_cast<std::size_t>(face)] == 0 || to.faceSize != map_.faceSize) return false;
    copyFace(map_, face, to);
    return true;
}

void StandingMaps::Kept::keep(int face, const reflection::LocalMap& from) {
    copyFace(from, face, map_);
    known_[static_cast<std::size_t>(face)] = 1;
}

StandingMaps::Kept& StandingMaps::of(std::uint32_t id, const Lighting& lighting,
                                     const reflection::LocalMapRequest& request) {
    Kept& kept = kept_[id];
    if (kept.lighting_ == lighting && kept.method_ == request.method &&
        kept.map_.faceSize == request.faceSize && kept.lookups_ == request.lookup.lookups &&
        kept.candidates_ == request.candidates.size())
        return kept;
    kept.lighting_ = lighting;
    kept.method_ = request.method;
    kept.lookups_ = request.lookup.lookups;
    kept.candidates_ = request.candidates.size();
    kept.known_ = {};
    kept.map_.resize(request.faceSize);
    return kept;
}

}  // namespace app
