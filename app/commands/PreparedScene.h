#pragma once

#include "app/commands/LoadScene.h"
#include "app/commands/PreparedReflections.h"
#include "app/display/OffscreenContext.h"
#include "app/render/SceneRenderer.h"

namespace app {

/// What a command that draws without a window starts from: a context, the scene that the options name, a
/// renderer, and the city's reference maps. Throws what those throw.
struct PreparedScene {
    /// `cacheIsPurpose`: see PreparationOptions.
    explicit PreparedScene(const Options& options, const RenderOptions& rendering = {},
                           bool cacheIsPurpose = false);

    OffscreenContext context;
    Scene scene;
    SceneRenderer renderer;
    PreparedReflections reflections;  ///< not complete when an interrupt came
};

}  // namespace app
