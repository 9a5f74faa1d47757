#pragma once

#include <string>
#include <vector>

#include "app/commands/PreparedScene.h"
#include "app/report/ResultFile.h"
#include "vehicles/traffic/Traffic.h"

namespace app {

/// Polished stone and frosted glass in a view along a front: error on the pixels of each, and of the clear
/// glass beside them, against rays that spread as the surface does; time of frames. Pictures in --out. Takes
/// the traffic; says so where the city has no such front.
void measureStone(const Options& options, PreparedScene& stage, vehicles::Traffic traffic,
                  ResultFile& results, std::vector<std::vector<std::string>>& table);

}  // namespace app
