#include <spdlog/spdlog.h>

#include <iostream>

#include "app/commands/Benches.h"
#include "app/commands/LoadScene.h"
#include "app/commands/LocalMapBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/frame/AssembleFrame.h"
#include "app/render/SceneRenderer.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

int benchLocalMap(const Options& options) {
    const OffscreenContext context;
    const Scene scene = loadScene(options);
    SceneRenderer renderer(scene.city, scene.models, {});
    renderer.prepare(emptyFrame(scene.city, scene.lighting));
    PreparationOptions preparation;
    preparation.cell = static_cast<float>(options.cell);
    preparation.quiet = options.quiet;
    const PreparedReflections prepared =
        prepareReflections(scene.city, scene.lighting, renderer, preparation);
    ResultFile results("localmap", std::string(programVersion), context.renderer());
    if (!prepared.complete) {
        spdlog::warn(
            "interrupted before anything was measured: the reference maps that are finished are kept");
        if (options.json) results.write(*options.json, true);
        return exitFailed;
    }

    LocalMapBenchOptions settings;
    settings.seed = options.seed;
    settings.lighting = scene.lighting;
    const std::vector<LocalMapRow> rows = runLocalMapBench(scene.city, prepared, renderer, settings);

    std::vector<std::vector<std::string>> table{
        {"method", "ms", "of rerender", "PSNR dB", "worst", "to 4x4", "FLIP", "rays"}};
    for (const LocalMapRow& row : rows) {
        results.add({{"method", row.method},
                     {"city", options.city},
                     {"face_size", settings.faceSize},
                     {"time_ms", toJson(row.time)},
                     {"ratio_to_rerender", row.ratioToRerender},
                     {"psnr_db", row.psnr},
                     {"psnr_worst_db", row.psnrWorst},
                     {"psnr_supersampled_db", row.psnrSupersampled},
                     {"mean_flip", row.flip},
                     {"rays", row.rays > 0 ? nlohmann::ordered_json(row.rays) : nullptr}});
        table.push_back({row.method, fixed(row.time.median, 2), fixed(row.ratioToRerender, 4),
                         fixed(row.psnr, 1), fixed(row.psnrWorst, 1), fixed(row.psnrSupersampled, 1),
                         fixed(row.flip, 3), row.rays > 0 ? std::to_string(row.rays) : "-"});
    }
    std::cout << formatTable(table);
    if (options.json) results.write(*options.json, interrupted());
    if (interrupted()) spdlog::warn("interrupted: what was measured until then is kept");
    return interrupted() ? exitFailed : exitOk;
}

}  // namespace app
