#include "reflection/gl/BakeReferenceMaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "reflection/gl/ReferenceMapBaker.h"

namespace reflection {

namespace {

/// Greatest R+G+B of the map: the packed range ends there.
float radianceScaleOf(const ReferenceMap& map) {
    float most = 1e-6f;
    for (const glm::vec3& c : map.colour) most = std::max(most, c.r + c.g + c.b);
    return most;
}

PackedReferenceMap pack(const ReferenceMap& map) { return PackedReferenceMap(map, radianceScaleOf(map)); }

}  // namespace

BakeResult bakeReferenceMaps(SceneDrawer& drawer, std::span<const glm::dvec3> positions, const ReferenceMapStore* store,
                             const BakeOptions& options, const std::function<bool(std::size_t, std::size_t)>& carryOn) {
    BakeResult result;
    std::vector<std::optional<PackedReferenceMap>> maps(positions.size());
    if (store) {
        std::vector<std::string> damage(positions.size());
        tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
            ReferenceMapStore::Loaded loaded = store->load(i);
            damage[i] = loaded.damage;
            if (!loaded.map) return;
            // The same content hash with another detail or place: left from a bake with other options.
            if (loaded.map->faceSize != options.faceSize || loaded.map->position != positions[i]) return;
            maps[i] = pack(*loaded.map);
        });
        for (std::size_t i = 0; i < damage.size(); ++i)
            if (!damage[i].empty()) result.damaged.push_back(store->file(i).string() + ": " + damage[i]);
        result.loaded = static_cast<std::size_t>(std::count_if(maps.begin(), maps.end(), [](const auto& m) { return m.has_value(); }));
    }

    std::size_t done = result.loaded;
    std::optional<ReferenceMapBaker> baker;
    for (std::size_t i = 0; i < positions.size() && result.complete; ++i) {
        if (maps[i]) continue;
        if (!baker) baker.emplace(options.faceSize, options.supersampling);
        const ReferenceMap map = baker->bake(drawer, positions[i]);
        if (store) store->save(i, map);
        // Packed from what a later run will load (half floats), so that both runs show the same pictures bit for bit.
        std::optional<ReferenceMap> stored = store ? store->load(i).map : std::nullopt;
        maps[i] = pack(stored ? *stored : map);
        ++result.baked;
        if (carryOn) result.complete = carryOn(++done, positions.size()) || done == positions.size();
    }
    for (auto& map : maps)
        if (map) result.maps.push_back(std::move(*map));
    return result;
}

}  // namespace reflection
