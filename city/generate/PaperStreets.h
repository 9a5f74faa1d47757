#pragma once

#include "city/generate/ChunkCollector.h"
#include "city/generate/Palette.h"
#include "city/roads/StreetGraph.h"

namespace city {

/// The measures of the benchmark city: 4 by 4 streets in a square kilometre.
struct PaperLayout {
    static constexpr int lines = 4;                               ///< streets each way: 8 roads
    static constexpr float half = 500;                            ///< metres from the middle to the border
    static constexpr float firstLine = -375;                      ///< metres, axis of the first street
    static constexpr float spacing = 250;                         ///< metres between axes
    static constexpr float laneWidth = 3.25f;                     ///< metres, two lanes each way
    static constexpr float pavementWidth = 4.5f;                  ///< metres on each side
    static constexpr float kerbLine = 2 * laneWidth;              ///< metres from axis to kerb
    static constexpr float houseLine = kerbLine + pavementWidth;  ///< metres from axis to the houses
    static constexpr float kerbHeight = 0.12f;                    ///< metres

    static float line(int k) { return firstLine + spacing * static_cast<float>(k); }
};

StreetGraph paperStreetGraph();

/// Asphalt, pavements, kerbs, markings and the ground of the blocks in exactly `triangles` triangles: what is
/// left after the surfaces goes into lane dashes. Stop lines lie at the lanes' ends. Throws std::logic_error
/// when the number is too small.
void addPaperStreets(const RoadNetwork& roads, const Palette& palette, std::size_t triangles,
                     ChunkCollector& chunks);

}  // namespace city
