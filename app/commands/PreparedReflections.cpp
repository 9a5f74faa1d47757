#include "app/commands/PreparedReflections.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "app/report/Progress.h"
#include "city/model/CityHeightfield.h"
#include "reflection/gl/BakeReferenceMaps.h"
#include "reflection/reference_maps/PackedFile.h"
#include "reflection/reference_maps/Store.h"

namespace app {

namespace {

/// Changes when the drawing or the placement of reference maps changes, so that old caches are not taken for
/// new ones.
constexpr std::uint64_t bakeVersion = 2;

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
    // splitmix64's finaliser over the running hash.
    std::uint64_t z = hash + value + 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

std::uint64_t mix(std::uint64_t hash, float value) {
    return mix(hash, std::uint64_t{std::bit_cast<std::uint32_t>(value)});
}

std::uint64_t mix(std::uint64_t hash, const glm::vec3& v) {
    return mix(mix(mix(hash, v.x), v.y), v.z);
}

std::uint64_t contentHash(const city::CityModel& city, const Lighting& light,
                          const PreparationOptions& options) {
    std::uint64_t hash = mix(mix(std::uint64_t{0}, bakeVersion), city.contentHash());
    for (const glm::vec3& v :
         {light.sunDirection, light.sunIrradiance, light.skyIrradiance, light.groundIrradiance})
        hash = mix(hash, v);
    hash = mix(mix(hash, light.turbidity), std::uint64_t{light.lampsLit});
    hash = mix(mix(hash, static_cast<std::uint64_t>(options.faceSize)),
               static_cast<std::uint64_t>(options.supersampling));
    hash = mix(mix(mix(hash, options.cell), options.placement.coverage), options.placement.spacing);
    for (const city::StandingReflector& reflector : city.reflectors) hash = mix(hash, reflector.centre());
    return hash;
}

/// A city's name as part of a file name.
std::string fileNameOf(const std::string& name) {
    std::string safe;
    for (char c : name)
        safe += (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') ? c : '_';
    return safe.empty() ? "city" : safe;
}

reflection::ReferenceMapStore storeOf(const city::CityModel& city, const Lighting& lighting,
                                      const PreparationOptions& options) {
    const std::uint64_t hash = contentHash(city, lighting, options);
    std::ostringstream name;
    name << fileNameOf(city.name) << '-' << std::hex << std::setw(16) << std::setfill('0') << hash;
    return {(options.cache.empty() ? cacheFolder() : options.cache) / name.str(), hash};
}

}  // namespace

std::vector<glm::vec3> drivingPositions(const city::CityModel& city, float step) {
    std::vector<glm::vec3> positions;
    for (const city::Lane& lane : city.roads.lanes) {
        float next = 0;
        float along = 0;
        for (std::size_t i = 0; i + 1 < lane.centreLine.size(); ++i) {
            const glm::vec3 a = lane.centreLine[i], b = lane.centreLine[i + 1];
            const float length = glm::distance(a, b);
            while (next <= along + length && length > 0) {
                positions.push_back(a + (b - a) * ((next - along) / length));
                next += step;
            }
            along += length;
        }
    }
    return positions;
}

std::filesystem::path cacheFolder() {
    if (const char* own = std::getenv("MIRRORSTREET_CACHE"); own && *own) return own;
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg)
        return std::filesystem::path(xdg) / "mirrorstreet";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "mirrorstreet";
    return std::filesystem::temp_directory_path() / "mirrorstreet-cache";
}

std::optional<CachedReflections> cachedReflections(const city::CityModel& city, const Lighting& lighting,
                                                   const PreparationOptions& options) {
    const reflection::ReferenceMapStore store = storeOf(city, lighting, options);
    const std::optional<reflection::ReferenceMapStore::Plan> plan = store.loadPlan();
    if (!plan) return std::nullopt;
    CachedReflections cached;
    cached.placed = plan->positions.size();
    cached.coverage = plan->coverage;
    for (std::size_t i = 0; i < cached.placed; ++i) {
        const auto key = reflection::packedFileKey(store.file(i), store.contentHash());
        if (!key) continue;
        ++cached.finished;
        if (cached.bytesPerTexel > 0) continue;
        // All are of one size.
        if (const auto map = reflection::loadPacked(store.packedFile(i), *key)) {
            cached.bytes = map->bytes();
            cached.bytesPerTexel = static_cast<double>(map->bytes()) / static_cast<double>(map->texelCount());
        }
    }
    cached.bytes *= cached.finished;
    return cached;
}

PreparedReflections prepareReflections(const city::CityModel& city, const Lighting& lighting,
                                       reflection::SceneDrawer& drawer, const PreparationOptions& options) {
    PreparedReflections prepared;
    {
        const city::CityColumns columns = city::cityColumns(city, options.cell);
        prepared.tracer = std::make_unique<reflection::GridTracer>(columns.solid, columns.hanging);
    }
    if (!options.maps) return prepared;

    const reflection::ReferenceMapStore store = storeOf(city, lighting, options);
    prepared.folder = store.folder();

    std::optional<reflection::ReferenceMapStore::Plan> plan;
    bool useCache = options.useCache;
    std::error_code ignored;
    if (useCache) plan = store.loadPlan();
    if (useCache && !plan && std::filesystem::exists(store.planFile(), ignored))
        spdlog::warn("{}: the list of reference maps is damaged; it was rebuilt", store.planFile().string());
    const auto goOn = [&](std::size_t done, std::size_t total) {
        return !interrupted() && (!options.carryOn || options.carryOn(done, total));
    };
    if (!plan) {
        prepared.complete = goOn(0, 0);
        if (!prepared.complete) return prepared;
        // Crowns as columns here: a map that looks along under them would be taken for one that sees what is
        // behind.
        const reflection::GridTracer columns(city::cityHeightfield(city, options.cell));
        const reflection::Placement placed =
            reflection::placeReferenceMaps(columns, drivingPositions(city, 2), options.placement);
        plan.emplace();
        plan->positions.assign(placed.positions.begin(), placed.positions.end());
        // What stands mirrors the same surroundings for ever: a map from its own place has them at hand.
        for (const city::StandingReflector& reflector : city.reflectors)
            plan->positions.emplace_back(reflector.centre());
        plan->coverage = placed.coverage;
        try {
            if (useCache) store.savePlan(*plan);
        } catch (const std::runtime_error& error) {
            if (options.cacheIsPurpose) throw;
            spdlog::warn("{} The maps are drawn for this run alone.", error.what());
            useCache = false;
        }
    }
    prepared.coverage = plan->coverage;

    std::optional<Progress> progress;
    std::size_t shown = 0;
    const auto tell = [&](std::size_t done, std::size_t total) {
        if (!progress) {
            progress.emplace("reference maps", total, options.quiet);
            shown = 0;
        }
        progress->advance(done - shown);
        shown = done;
        return goOn(done, total);
    };
    prepared.complete = goOn(0, plan->positions.size());
    if (!prepared.complete) return prepared;
    reflection::BakeResult baked =
        reflection::bakeReferenceMaps(drawer, plan->positions, useCache ? &store : nullptr,
                                      {options.faceSize, options.supersampling}, tell);
    for (const std::string& damage : baked.damaged) spdlog::warn("{}; it was rebuilt", damage);
    prepared.maps = std::move(baked.maps);
    prepared.loaded = baked.loaded;
    prepared.baked = baked.baked;
    prepared.complete = baked.complete;
    if (!useCache) prepared.folder.clear();
    return prepared;
}

}  // namespace app
