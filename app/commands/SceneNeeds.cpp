#include "app/commands/SceneNeeds.h"

#include <algorithm>

#include "app/report/Table.h"
#include "city/model/CityHeightfield.h"
#include "reflection/local_map/LocalMapSlot.h"

namespace app {

namespace {

/// Of a packed reference map, colour and distance together: 2.79 to 2.83 in the built-in cities.
constexpr double bytesPerTexel = 2.8;

/// A local map with its smaller levels, 4 bytes a texel.
std::size_t localMapBytes(int faceSize) {
    std::size_t texels = 0;
    for (int side = faceSize; side >= 1; side /= 2)
        texels += 6 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    return 4 * texels;
}

std::string bytes(std::size_t count) {
    return byteSize(static_cast<double>(count));
}

}  // namespace

SceneNeeds sceneNeeds(const city::CityModel& city, const PreparationOptions& options) {
    SceneNeeds needs;
    for (const city::Lane& lane : city.roads.lanes)
        (lane.kind == city::LaneKind::tram ? needs.tramLanes : needs.carLanes) += 1;
    const std::vector<glm::vec3> positions = drivingPositions(city, 2);
    needs.drivingPositions = positions.size();
    if (positions.empty()) return needs;
    const city::Heightfield field = city::cityHeightfield(city, options.cell);
    needs.heightfieldCells =
        static_cast<std::size_t>(field.width()) * static_cast<std::size_t>(field.height());
    needs.heightfieldBytes = needs.heightfieldCells * sizeof(float);
    const reflection::GridTracer tracer(field);
    const reflection::Placement placed = reflection::placeReferenceMaps(tracer, positions, options.placement);
    needs.referenceMaps = placed.positions.size();
    needs.coverage = placed.coverage;
    const double texels =
        6.0 * options.faceSize * options.faceSize * static_cast<double>(needs.referenceMaps);
    needs.referenceMapBytes = static_cast<std::size_t>(bytesPerTexel * texels);
    needs.localMapBytesLeast = localMapBytes(reflection::localMapFaceSizes.back());
    needs.localMapBytesMost = localMapBytes(reflection::localMapFaceSizes.front());
    return needs;
}

std::vector<std::pair<std::string, std::string>> describe(const SceneNeeds& needs) {
    if (needs.drivingPositions == 0)
        return {{"reflections", "none: there are no lanes, so nothing drives and nothing mirrors"}};
    const std::string lanes =
        std::to_string(needs.carLanes) + " car lanes" +
        (needs.tramLanes > 0 ? " and " + std::to_string(needs.tramLanes) + " tram lanes" : ", no trams");
    return {{"reference maps",
             std::to_string(needs.referenceMaps) + ", about " + bytes(needs.referenceMapBytes) +
                 " (estimated): " + fixed(100 * needs.coverage, 1) + "% of what is seen from " + lanes},
            {"heightfield", bytes(needs.heightfieldBytes) + ", " + std::to_string(needs.heightfieldCells) +
                                " cells: what the local maps' rays meet"},
            {"local maps", "one a vehicle in view, " + bytes(needs.localMapBytesLeast) + " to " +
                               bytes(needs.localMapBytesMost) +
                               " by its size on screen: curved paint moves through the street"},
            {"while nothing moves", "no local map is rebuilt, and none is without a vehicle in view"},
            {"planar mirrors", "none: no city here has flat mirrors"},
            {"re-rendering", "none: only for comparison (--method rerender)"}};
}

}  // namespace app
