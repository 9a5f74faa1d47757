#include <OpenImageIO/oiioversion.h>
#include <hwy/targets.h>
#include <spdlog/version.h>
#include <CLI/Version.hpp>
#include <glm/detail/setup.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <thread>

#include "app/commands/Commands.h"
#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/commands/SceneNeeds.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/Lighting.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "city/model/GlassFronts.h"

namespace app {

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

void print(const std::string& title, const Rows& rows) {
    std::cout << title << "\n";
    for (const auto& [name, value] : rows)
        std::cout << "  " << name << std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') << value
                  << "\n";
}

std::string version(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string instructionSets() {
    std::string names;
    // The best comes first: the lowest bit.
    for (auto targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1)
        names += (names.empty() ? "" : " ") + std::string(hwy::TargetName(targets & -targets));
    return names;
}

void printMachine() {
    print("mirrorstreet " + std::string(programVersion),
          {{"processor", processorName()},
           {"threads", std::to_string(std::thread::hardware_concurrency())},
           {"instruction sets", instructionSets()},
           {"cache folder", cacheFolder().string()}});
    print("libraries (at compile time)",
          {{"OpenImageIO", OIIO_VERSION_STRING},
           {"GLM", version(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH)},
           {"nlohmann-json",
            version(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
           {"CLI11", CLI11_VERSION},
           {"spdlog", version(SPDLOG_VER_MAJOR, SPDLOG_VER_MINOR, SPDLOG_VER_PATCH)}});
    std::cout.flush();
}

void printOpenGl() {
    const OffscreenContext context;
    print("OpenGL",
          {{"renderer", context.renderer()},
           {"version", context.version()},
           {"software", context.software() ? "yes: expect a fraction of a graphics card's speed" : "no"},
           {"local maps made by", context.software()
                                      ? "the processor (--maps-on gpu asks for OpenGL)"
                                      : "the graphics card (--maps-on cpu asks for the processor)"}});
    print("limits", contextLimits());
}

/// What the cache holds of them for the default light.
std::string referenceMapsOf(const city::CityModel& city, const Options& options) {
    PreparationOptions preparation;
    preparation.cell = static_cast<float>(options.cell);
    const std::optional<CachedReflections> cached = cachedReflections(
        city, lightingAt(options.hour, city.frame ? city.frame->latitude() : 50), preparation);
    if (!cached) return "none in the cache yet (bake, or the first tour, makes them)";
    std::string text = std::to_string(cached->finished) + " of " + std::to_string(cached->placed) +
                       " in the cache, for " + fixed(100 * cached->coverage, 1) + "% of what is seen";
    if (cached->bytesPerTexel > 0)
        text += "; " + byteSize(static_cast<double>(cached->bytes)) + ", " + fixed(cached->bytesPerTexel, 2) +
                " bytes a texel for colour and distance, in main memory as on a graphics card";
    return text;
}

void printCity(const Options& options) {
    const city::CityModel city = loadCityOf(options, false);
    std::size_t buildings = 0;
    for (const city::Chunk& chunk : city.chunks) buildings += chunk.kind == city::ChunkKind::building;
    std::size_t carLanes = 0, tramLanes = 0;
    double carMetres = 0, tramMetres = 0;
    for (const city::Lane& lane : city.roads.lanes) {
        const bool tram = lane.kind == city::LaneKind::tram;
        (tram ? tramLanes : carLanes) += 1;
        (tram ? tramMetres : carMetres) += laneLength(lane);
    }
    const auto signalled =
        std::count_if(city.roads.junctions.begin(), city.roads.junctions.end(),
                      [](const city::Junction& junction) { return !junction.signal.phases.empty(); });
    const glm::vec3 size = city.bounds.empty() ? glm::vec3(0) : city.bounds.size();
    Rows rows{{"size", fixed(size.x, 0) + " x " + fixed(size.y, 0) + " m, " + fixed(size.z, 0) + " m high"},
              {"triangles", std::to_string(city.triangleCount())},
              {"building chunks",
               std::to_string(buildings) + " of " + std::to_string(city.chunks.size()) + " chunks"},
              {"car lanes", std::to_string(carLanes) + ", " + fixed(carMetres / 1000, 1) + " km"},
              {"tram lanes", std::to_string(tramLanes) + ", " + fixed(tramMetres / 1000, 1) + " km"},
              {"junctions", std::to_string(city.roads.junctions.size()) + ", " + std::to_string(signalled) +
                                " with signals"}};
    std::map<std::string, std::size_t> things;
    for (const city::Placement& placement : city.placements)
        ++things[city.prototypes[placement.prototype].name];
    for (const auto& [name, count] : things) rows.emplace_back(name, std::to_string(count));
    if (city.frame)
        rows.emplace_back(
            "origin", fixed(city.frame->latitude(), 5) + " N, " + fixed(city.frame->longitude(), 5) + " E");
    std::ostringstream hash;
    hash << std::hex << std::setw(16) << std::setfill('0') << city.contentHash();
    rows.emplace_back("content hash", hash.str());
    rows.emplace_back("reference maps", referenceMapsOf(city, options));
    const city::GlassCensus glass = city::glassFronts(city).census;
    rows.emplace_back("windows that mirror", std::to_string(glass.shopFronts) + " shop fronts and " +
                                                 std::to_string(glass.curtainWalls) + " curtain walls with " +
                                                 std::to_string(glass.panes) + " panes, " +
                                                 fixed(glass.area, 0) + " m2, in " +
                                                 std::to_string(glass.planes) + " planes");
    rows.emplace_back("windows that do not", std::to_string(glass.tooSmall) + " fronts with less than " +
                                                 fixed(city::leastGlass, 0) + " m2 of glass, " +
                                                 std::to_string(glass.painted) +
                                                 " walls whose small windows stay painted");
    print(city.name.empty() ? options.city : city.name, rows);
    for (const std::string& note : city.notes) std::cout << "  note: " << note << "\n";
    PreparationOptions preparation;
    preparation.cell = static_cast<float>(options.cell);
    print("what its reflections need (found without drawing it)", describe(sceneNeeds(city, preparation)));
}

}  // namespace

Command infoCommand() {
    return {.name = "info",
            .summary = "versions, OpenGL renderer and limits; with a CITY, what the city holds",
            .groups = cityOptions | cityIsOptional,
            .benches = {},
            .run = [](const Options& options) {
                if (!options.city.empty()) {
                    printCity(options);
                    return exitOk;
                }
                printMachine();
                printOpenGl();
                return exitOk;
            }};
}

}  // namespace app
