#include <iostream>

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
    settings.mapsOn = options.mapsOn;
    settings.gpuMapBytes = options.gpuMapBytes();
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
                     {"psnr_to_cpu_db", row.psnrToProcessor},
                     {"reference_map_gpu_bytes", row.referenceMapGpuBytes},
                     {"reference_map_bytes_per_texel", row.bytesPerTexel},
                     {"rays", row.rays > 0 ? nlohmann::ordered_json(row.rays) : nullptr}});
        table.push_back({row.method, fixed(row.time.median, 2), fixed(row.ratioToRerender, 4),
                         fixed(row.psnr, 1), fixed(row.psnrWorst, 1), fixed(row.psnrSupersampled, 1),
                         fixed(row.flip, 3), row.rays > 0 ? std::to_string(row.rays) : "-"});
    }
    const int code = reportBench(options, results, table);
    for (const LocalMapRow& row : rows)
        if (row.referenceMapGpuBytes > 0)
            std::cout << row.method << ": " << fixed(row.psnrToProcessor, 1)
                      << " dB PSNR to mem on the processor; "
                      << byteSize(static_cast<double>(row.referenceMapGpuBytes))
                      << " of reference maps on the GPU, " << fixed(row.bytesPerTexel, 2)
                      << " bytes a texel\n";
    return code;
}

}  // namespace app
