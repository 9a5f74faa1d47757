#include "reflection/chrome/CubeLattice.h"

#include <cmath>
#include <glm/gtc/type_precision.hpp>
#include <unordered_map>

#include "reflection/chrome/ReflectorMap.h"

namespace reflection {

CubeLattice::CubeLattice(int cells) {
    const auto key = [cells](const glm::ivec3& p) {
        return (static_cast<std::uint64_t>(p.x) * static_cast<std::uint64_t>(cells + 1) +
                static_cast<std::uint64_t>(p.y)) *
                   static_cast<std::uint64_t>(cells + 1) +
               static_cast<std::uint64_t>(p.z);
    };
    std::unordered_map<std::uint64_t, std::uint32_t> known;
    std::vector<glm::ivec3> places;
    ids.resize(ReflectorMap::cornerCount(cells));
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row <= cells; ++row)
            for (int column = 0; column <= cells; ++column) {
                const glm::dvec3 g = ReflectorMap::cornerPoint(cells, face, column, row);
                const glm::dvec3 scaled = (g + 1.0) * (0.5 * cells);
                const glm::ivec3 place(static_cast<int>(std::lround(scaled.x)),
                                       static_cast<int>(std::lround(scaled.y)),
                                       static_cast<int>(std::lround(scaled.z)));
                const auto [entry, added] =
                    known.try_emplace(key(place), static_cast<std::uint32_t>(places.size()));
                if (added) {
                    places.push_back(place);
                    points.push_back(g);
                }
                ids[ReflectorMap::cornerIndex(cells, face, column, row)] = entry->second;
            }
    steps.resize(places.size());
    for (std::size_t id = 0; id < places.size(); ++id)
        for (int direction = 0; direction < 6; ++direction) {
            glm::ivec3 to = places[id];
            to[direction / 2] += direction % 2 == 0 ? 1 : -1;
            std::uint32_t found = none;
            if (to[direction / 2] >= 0 && to[direction / 2] <= cells) {
                const auto entry = known.find(key(to));
                if (entry != known.end()) found = entry->second;
            }
            steps[id][static_cast<std::size_t>(direction)] = found;
        }
}

}  // namespace reflection
