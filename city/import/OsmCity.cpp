#include "city/import/OsmCity.h"

#include <tbb/parallel_invoke.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "city/generate/ChunkCollector.h"
#include "city/generate/CityPlants.h"
#include "city/generate/Palette.h"
#include "city/generate/Random.h"
#include "city/generate/SignalHeads.h"
#include "city/import/OsmBuildings.h"
#include "city/import/OsmFurniture.h"
#include "city/import/OsmGround.h"
#include "city/import/OsmReader.h"
#include "city/import/OsmStreets.h"
#include "city/import/StreetWidths.h"
#include "city/roads/BuildRoadNetwork.h"
#include "city/roads/StreetSurfaces.h"

namespace city {

namespace {

/// Chunks of buildings are about this large, metres: a block or two.
constexpr float blockSize = 80;

/// Parts higher than this above ground do not stand in a street's way, metres.
constexpr float headroom = 4;

void note(CityModel& model, std::size_t count, const std::string& sentence) {
    if (count > 0) model.notes.push_back(std::to_string(count) + " " + sentence);
}

/// The underside of what does not reach the ground.
void appendUnderside(const BuildingShape& shape, Mesh& mesh) {
    const std::vector<glm::vec2> corners = triangulate(shape.footprint);
    const auto vertex = [&](glm::vec2 p) {
        return Vertex{glm::vec3(p, shape.base), {0, 0, -1}, p / shape.roofPatternSize, shape.roofMaterial};
    };
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.addTriangle(vertex(corners[i]), vertex(corners[i + 2]), vertex(corners[i + 1]));
}

struct BuiltCounts {
    std::size_t repaired = 0;
    std::size_t degenerate = 0;
};

BuiltCounts appendBuildings(const std::vector<BuildingPlan>& plans, ChunkCollector& chunks) {
    BuiltCounts counts;
    for (const BuildingPlan& plan : plans) {
        Mesh mesh;
        const BuildStatus status = appendBuilding(plan.shape, mesh);
        counts.repaired += status == BuildStatus::repaired;
        counts.degenerate += status == BuildStatus::degenerate;
        if (plan.shape.base > 0.5f && status != BuildStatus::degenerate) appendUnderside(plan.shape, mesh);
        chunks.add(ChunkKind::building, mesh);
        // What juts out over the pavement is no column of the heightfield.
        Mesh details;
        for (const Ledge& ledge : plan.ledges) appendLedge(plan.shape.footprint, ledge, details);
        chunks.add(ChunkKind::furniture, details);
    }
    return counts;
}

}  // namespace

CityModel loadOsmCity(const std::filesystem::path& file, const ImportOptions& options) {
    const OsmData data = readOsm(file, options.size);
    Palette palette = makePalette();
    palette.streets.tramBed = palette.cobbles;
    MaterialTable materials(palette.materials);

    StreetPlan streets = planStreets(data);
    const BuildingPlans buildings = planBuildings(data, streets.mainStreets, options.seed, materials);
    if (buildings.plans.empty() && streets.graph.edges.empty())
        throw std::runtime_error(
            file.string() +
            ": holds neither buildings nor streets within its bounds, so there is no city in it; "
            "export an area of a town, with all its ways");
    std::vector<Footprint> obstacles;
    for (const BuildingPlan& plan : buildings.plans)
        if (plan.shape.base < headroom) obstacles.push_back(plan.shape.footprint);
    const std::size_t narrowed = fitStreetsBetween(obstacles, streets.graph);
    const GroundPlan ground = planGround(data);

    CityModel model;
    model.name = file.stem().stem().string();
    model.frame = data.frame;
    ChunkCollector chunks(blockSize);
    BuiltCounts built;
    std::vector<Mesh> groundMeshes;
    std::vector<Mesh> streetMeshes;
    tbb::parallel_invoke([&] { streetMeshes = buildStreetSurfaces(streets.graph, palette.streets); },
                         [&] {
                             built = appendBuildings(buildings.plans, chunks);
                             groundMeshes = buildGround(ground, data.halfSize, palette);
                             model.roads = buildRoadNetwork(streets.graph);
                         });
    for (Mesh& mesh : groundMeshes) chunks.addWhole(ChunkKind::ground, std::move(mesh));
    for (Mesh& mesh : streetMeshes) chunks.addWhole(ChunkKind::ground, std::move(mesh));
    model.chunks = chunks.take();

    SignalLayout signals = layOutSignals(model.roads);
    model.signalHeads = std::move(signals.heads);
    Random random(options.seed);
    const Standing kinds = addPrototypes(palette, random, model);
    const FurnitureCounts furniture =
        placeFurniture(data, streets.graph, ground, obstacles, kinds, options.seed, model);
    for (const SignalPole& pole : signals.poles)
        place(model, kinds.signalPole, pole.foot, glm::vec2(pole.facing));
    model.materials = materials.take();
    model.bounds.extend(glm::vec3(-data.halfSize, groundHeight));
    model.bounds.extend(glm::vec3(data.halfSize, groundHeight));
    for (const Chunk& chunk : model.chunks)
        if (chunk.kind == ChunkKind::building) model.bounds.extend(chunk.bounds);
    for (const Placement& placement : model.placements) {
        const Aabb box = model.prototypes[placement.prototype].levels.front().mesh.bounds();
        model.bounds.max.z =
            std::max(model.bounds.max.z, (placement.worldFromPrototype * glm::vec4(box.max, 1)).z);
    }

    note(model, buildings.buildings,
         "buildings and " + std::to_string(buildings.parts) + " building parts were read.");
    note(model, buildings.guessedHeights,
         "heights of buildings were guessed from their neighbours' and their kind, as the file does not tell "
         "them.");
    note(model, buildings.replacedOutlines,
         "outlines of buildings were replaced by their parts; " + std::to_string(buildings.keptRemainders) +
             " keep what the parts leave free.");
    note(model, buildings.underground, "buildings underground were left out.");
    note(model, buildings.floating, "small parts of buildings with nothing below them were left out.");
    note(model, buildings.outside, "buildings outside the bounds were left out.");
    if (data.cutToWidest)
        model.notes.push_back(
            "The file was cut to 32,768 m, beyond which positions are not good to a millimetre; "
            "--size cuts out less.");
    note(model, built.repaired, "footprints crossed themselves and were mended.");
    note(model, built.degenerate, "footprints have no area or height and were left out.");
    note(model, data.missingNodeReferences,
         "references to nodes that the file does not hold were passed over.");
    note(model, data.incompleteRelations, "multipolygons whose ways are not all in the file were left out.");
    note(model, data.brokenAreas, "areas whose rings do not close were left out.");
    note(model, data.areasWithoutNodes, "areas of which the file holds hardly a node were left out.");
    note(model, streets.tunnels, "ways in tunnels and underground were left out.");
    note(model, streets.bridges, "ways on bridges were laid at ground level.");
    note(model, streets.guessedLanes,
         "of " + std::to_string(streets.carWays) +
             " streets do not tell their lanes; the class of the road decided.");
    note(model, narrowed, "pieces of streets were narrowed to fit between buildings.");
    note(model, streets.strandedSignals, "traffic signals are on no street that is drawn and were left out.");
    note(model, streets.tramWays, "tram tracks were read.");
    note(model, ground.openCoastlines,
         "coastlines do not part land from sea within the bounds and were left out.");
    note(model, furniture.trees,
         "trees and " + std::to_string(furniture.lamps) + " street lamps were placed.");
    note(model, furniture.rowTrees + furniture.woodTrees,
         "trees were set along tree rows and strewn in woods.");
    return model;
}

}  // namespace city
