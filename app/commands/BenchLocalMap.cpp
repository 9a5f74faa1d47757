#include "app/commands/Benches.h"
#include "app/commands/LocalMapBench.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

int benchLocalMap(const Options& options) {
    PreparedScene stage(options);
    ResultFile results("localmap", std::string(programVersion), stage.context.renderer());
    if (!stage.reflections.complete) return reportBench(options, results, {});

    LocalMapBenchOptions settings;
    settings.seed = options.seed;
    settings.quiet = options.quiet;
    settings.lighting = stage.scene.lighting;
    const std::vector<LocalMapRow> rows =
        runLocalMapBench(stage.scene.city, stage.reflections, stage.renderer, settings);

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
    return reportBench(options, results, table);
}

}  // namespace app
