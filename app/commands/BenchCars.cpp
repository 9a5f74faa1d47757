#include "app/commands/Benches.h"
#include "app/commands/CarsBench.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

int benchCars(const Options& options) {
    PreparedScene stage(options);
    ResultFile results("cars", std::string(programVersion), stage.context.renderer());
    if (!stage.reflections.complete) return reportBench(options, results, {});

    CarsBenchOptions settings;
    settings.seed = options.seed;
    settings.quality = options.quality;
    settings.mapsOn = options.mapsOn;
    settings.gpuMapBytes = options.gpuMapBytes();
    settings.resolution = options.resolution;
    settings.quiet = options.quiet;
    settings.frameStep = 1.0 / options.fps;
    if (!options.cars.empty()) settings.cars = options.cars;
    if (const auto frames = options.frameCount()) settings.frames = *frames;
    const std::vector<CarsRow> rows = runCarsBench(stage.scene, stage.reflections, stage.renderer, settings);

    std::vector<std::vector<std::string>> table{{"method", "cars", "seen", "frame ms", "of none",
                                                 "reflections ms", "rerender / it", "PSNR dB", "FLIP",
                                                 "maps a frame", "maps' bytes"}};
    for (const CarsRow& row : rows) {
        results.add({{"method", row.method},
                     {"city", options.city},
                     {"cars", row.cars},
                     {"visible", row.visible},
                     {"width", settings.resolution.x},
                     {"height", settings.resolution.y},
                     {"frame_ms", toJson(row.frame)},
                     {"reflection_ms", toJson(row.reflection)},
                     {"ratio_to_none", row.ratioToNone},
                     {"ratio_to_rerender", 1 / row.rerenderRatio},
                     {"maps_updated_per_frame", row.mapsPerFrame},
                     {"psnr_db", row.psnr},
                     {"mean_flip", row.flip},
                     {"texture_bytes", row.textureBytes},
                     {"reference_map_coverage", stage.reflections.coverage},
                     {"reference_maps", stage.reflections.maps.size()}});
        table.push_back({row.method, std::to_string(row.cars), std::to_string(row.visible),
                         fixed(row.frame.median, 1), fixed(row.ratioToNone, 3),
                         fixed(row.reflection.median, 2), fixed(row.rerenderRatio, 1), fixed(row.psnr, 1),
                         fixed(row.flip, 4), fixed(row.mapsPerFrame, 1),
                         byteSize(static_cast<double>(row.textureBytes))});
    }
    return reportBench(options, results, table);
}

}  // namespace app
