#include <spdlog/spdlog.h>

#include <iostream>

#include "app/commands/Commands.h"
#include "app/commands/PreparedScene.h"
#include "app/report/Table.h"

namespace app {

namespace {

int run(const Options& options) {
    const PreparedScene stage(options, {}, true);
    const PreparedReflections& prepared = stage.reflections;
    if (!prepared.complete) {
        spdlog::warn(
            "interrupted: the maps that are finished stay in the cache; run bake again for the rest");
        return exitFailed;
    }

    std::size_t bytes = 0;
    for (const auto& map : prepared.maps) bytes += map.bytes();
    std::cout << "reference maps  " << prepared.maps.size() << " (" << prepared.loaded << " from the cache, "
              << prepared.baked << " drawn)\n"
              << "coverage        " << fixed(100 * prepared.coverage, 2)
              << " % of the surface visible from the lanes\n"
              << "memory          " << byteSize(static_cast<double>(bytes)) << "\n"
              << "cache           " << prepared.folder.string() << "\n";
    return exitOk;
}

}  // namespace

Command bakeCommand() {
    return {.name = "bake",
            .summary =
                "places and draws the city's reference maps into the cache; goes on where it was interrupted",
            .groups = cityOptions | mapOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
