#include "reflection/gl/BakeReferenceMaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "reflection/gl/ReferenceMapBaker.h"
#include "reflection/reference_maps/PackedFile.h"

namespace reflection {

namespace {

/// Greatest R+G+B of the map: the packed range ends there.
float radianceScaleOf(const ReferenceMap& map) {
    float most = 1e-6f;
    for (const glm::vec3& c : map.colour) most = std::max(most, c.r + c.g + c.b);
    return most;
}

PackedReferenceMap pack(const ReferenceMap& map) {
    return PackedReferenceMap(map, radianceScaleOf(map));
}

}  // namespace

BakeResult bakeReferenceMaps(SceneDrawer& drawer, std::span<const glm::dvec3> positions,
                             const ReferenceMapStore* store, const BakeOptions& options,
                             const std::function<bool(std::size_t, std::size_t)>& carryOn) {
    BakeResult result;
    std::vector<std::optional<PackedReferenceMap>> maps(positions.size());
    if (store) {
        std::vector<std::string> damage(positions.size());
        tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
            const std::optional<PackedFileKey> key = packedFileKey(store->file(i), store->contentHash());
            if (!key) return;
            // The same content hash with another detail or place: left from a bake with other options.
            const auto wanted = [&](int faceSize, const glm::dvec3& position) {
                return faceSize == options.faceSize && position == positions[i];
            };
            maps[i] = loadPacked(store->packedFile(i), *key);
            if (maps[i] && wanted(maps[i]->faceSize(), maps[i]->position())) return;
            maps[i].reset();
            ReferenceMapStore::Loaded loaded = store->load(i);
            damage[i] = loaded.damage;
            if (!loaded.map || !wanted(loaded.map->faceSize, loaded.map->position)) return;
            maps[i] = pack(*loaded.map);
            savePacked(store->packedFile(i), *key, *maps[i]);
        });
        for (std::size_t i = 0; i < damage.size(); ++i)
            if (!damage[i].empty()) result.damaged.push_back(store->file(i).string() + ": " + damage[i]);
        result.loaded = static_cast<std::size_t>(
            std::count_if(maps.begin(), maps.end(), [](const auto& m) { return m.has_value(); }));
    }

    std::size_t done = result.loaded;
    std::optional<ReferenceMapBaker> baker;
    for (std::size_t i = 0; i < positions.size() && result.complete; ++i) {
        if (maps[i]) continue;
        if (!baker) baker.emplace(options.faceSize, options.supersampling);
        const ReferenceMap map = baker->bake(drawer, positions[i]);
        if (store) store->save(i, map);
        // Packed from what a later run will load (half floats), so that both runs show the same pictures bit
        // for bit.
        std::optional<ReferenceMap> stored = store ? store->load(i).map : std::nullopt;
        maps[i] = pack(stored ? *stored : map);
        if (const auto key = store ? packedFileKey(store->file(i), store->contentHash()) : std::nullopt)
            savePacked(store->packedFile(i), *key, *maps[i]);
        ++result.baked;
        if (carryOn) result.complete = carryOn(++done, positions.size()) || done == positions.size();
    }
    for (auto& map : maps)
        if (map) result.maps.push_back(std::move(*map));
    return result;
}

}  // namespace reflection
