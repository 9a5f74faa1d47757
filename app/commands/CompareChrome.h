#pragma once

#include "app/commands/CompareRun.h"
#include "app/compare/ChromeRow.h"

namespace app {

/// Close-ups of chrome by every method against the truth: what stands on the city's square with a car beside
/// it, and the views of staged vehicles, where there are any. Times of the methods are of the same frame, in
/// turn. An interrupt ends it; what was measured until then is returned.
ChromeComparison compareChrome(const Scene& scene, const PreparedReflections& prepared,
                               SceneRenderer& renderer, const CompareOptions& options, Quality quality);

}  // namespace app
