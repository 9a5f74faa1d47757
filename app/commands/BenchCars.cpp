#include <spdlog/spdlog.h>

#include <iostream>

#include "app/commands/Benches.h"
#include "app/commands/CarsBench.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/frame/AssembleFrame.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

int benchCars(const Options& options) {
    const OffscreenContext context;
    const Scene scene = loadScene(options);
    SceneRenderer renderer(scene.city, scene.models, {});
    renderer.prepare(emptyFrame(scene.city, scene.lighting));
    PreparationOptions preparation;
    preparation.cell = static_cast<float>(options.cell);
    preparation.quiet = options.quiet;
    const PreparedReflections prepared =
        prepareReflections(scene.city, scene.lighting, renderer, preparation);
    ResultFile results("cars", std::string(programVersion), context.renderer());
    if (!prepared.complete) {
        spdlog::warn(
            "interrupted before anything was measured: the reference maps that are finished are kept");
        if (options.json) results.write(*options.json, true);
        return exitFailed;
    }

    CarsBenchOptions settings;
    settings.seed = options.seed;
    settings.quality = options.quality;
    settings.resolution = options.resolution;
    settings.quiet = options.quiet;
    if (options.cars.size() > 1 || options.cars.front() != Options{}.cars.front())
        settings.cars = options.cars;
    if (const auto frames = options.frameCount()) settings.frames = *frames;
    const std::vector<CarsRow> rows = runCarsBench(scene, prepared, renderer, settings);

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
                     {"reference_map_coverage", prepared.coverage},
                     {"reference_maps", prepared.maps.size()}});
        table.push_back({row.method, std::to_string(row.cars), std::to_string(row.visible),
                         fixed(row.frame.median, 1), fixed(row.ratioToNone, 3),
                         fixed(row.reflection.median, 2), fixed(row.rerenderRatio, 1), fixed(row.psnr, 1),
                         fixed(row.flip, 4), fixed(row.mapsPerFrame, 1),
                         byteSize(static_cast<double>(row.textureBytes))});
    }
    std::cout << formatTable(table);
    if (options.json) results.write(*options.json, interrupted());
    if (interrupted()) spdlog::warn("interrupted: what was measured until then is kept");
    return interrupted() ? exitFailed : exitOk;
}

}  // namespace app
