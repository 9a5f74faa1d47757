#include "app/commands/PreparedScene.h"

#include "app/frame/AssembleFrame.h"

namespace app {

namespace {

PreparedReflections prepare(const Scene& scene, SceneRenderer& renderer, const Options& options,
                            bool cacheIsPurpose) {
    renderer.prepare(emptyFrame(scene.city, scene.lighting));
    PreparationOptions preparation;
    preparation.cell = static_cast<float>(options.cell);
    preparation.quiet = options.quiet;
    preparation.cacheIsPurpose = cacheIsPurpose;
    return prepareReflections(scene.city, scene.lighting, renderer, preparation);
}

}  // namespace

PreparedScene::PreparedScene(const Options& options, const RenderOptions& rendering, bool cacheIsPurpose)
    : scene(loadScene(options)),
      renderer(scene.city, scene.models, rendering),
      reflections(prepare(scene, renderer, options, cacheIsPurpose)) {}

}  // namespace app
