#pragma once

#include "app/commands/CompareRun.h"
#include "app/commands/WindowsStage.h"
#include "app/compare/WindowRow.h"

namespace app {

/// What was measured of a case, and its errors.
WindowRow windowRowOf(const WindowsRun& run, std::uint32_t cars, glm::ivec2 size,
                      const WindowsRun::Errors& errors);

/// The windows of a street with cars: painted, without maps, with so many mirrors in a row and so many maps
/// at most; on the same frames, against ray traced windows. No rows where the city has no glass or the street
/// cannot be set; an interrupt ends it, what was measured until then is returned.
WindowComparison compareWindows(const Scene& scene, const PreparedReflections& prepared,
                                SceneRenderer& renderer, const CompareOptions& options);

}  // namespace app
