#include <spdlog/spdlog.h>

#include <iostream>
#include <stdexcept>

#include "app/commands/Benches.h"
#include "app/commands/Commands.h"
#include "app/report/Progress.h"
#include "app/report/Table.h"

namespace app {

namespace {

std::vector<Bench> allBenches() {
    return {
        {{"cars",
          "frame time and error against the number of mirroring cars, every method on the same frames",
          trafficOptions | severalCars | qualityOption | cellOption | mapsOnOptions | pictureOptions |
              durationOptions},
         benchCars},
        {{"chrome",
          "close things in curved chrome: searches a second, shares of them, the published search, a moving "
          "eye, pictures against rays; in a kitchen, or a scene FILE.json",
          bodyOption | searchOption | saveOption},
         benchChrome},
        {{"empty", "what mem costs where there is nothing to reflect, against none",
          cellOption | pictureOptions},
         benchEmpty},
        {{"governor", "a budget held through a step from 10 to 200 cars on screen and back",
          budgetOption | cellOption | mirrorOptions | chromeOptions | pictureOptions},
         benchGovernor},
        {{"kerbside",
          "chrome bumper and wheel cover with a cyclist passing at 0.3 m, or the views of --staged "
          "FILE.json: "
          "error and time; pictures in --out",
          trafficOptions | qualityOption | cellOption | pictureOptions | chromeOptions | viewOption |
              outOptions},
         benchKerbside},
        {{"localmap", "one local map by every method, against re-rendering its six faces",
          mapOptions | mapsOnOptions},
         benchLocalMap},
        {{"mirrors",
          "recursive reflections in flat and curved mirrors: the paper's scenes and its table, culling, "
          "gloss and "
          "depth against ray tracing; or a scene FILE.json",
          saveOption},
         benchMirrors},
        {{"square",
          "what stands in the city and mirrors it, by every method, and its polished stone and frosted "
          "glass: error and time; pictures in --out",
          trafficOptions | qualityOption | cellOption | pictureOptions | chromeOptions | viewOption |
              outOptions},
         benchSquare},
        {{"stills", "a car at 3, 10 and 40 m by every method, as pictures in --out",
          trafficOptions | memOption | qualityOption | cellOption | pictureOptions | outOptions},
         benchStills},
        {{"streets",
          "two facing shops with a car between, a car's door with a window in it, a wet street at night: "
          "pictures in "
          "--out",
          cellOption | pictureOptions | outOptions},
         benchStreets},
        {{"tracer", "rays per second against heightfields, with an exact check; beside Embree", cellOption},
         benchTracer},
        {{"windows",
          "a street whose windows mirror it and its cars: time, passes and error against depth and number of "
          "maps; pictures in --out",
          cellOption | pictureOptions | outOptions},
         benchWindows}};
}

}  // namespace

int reportBench(const Options& options, const ResultFile& results,
                const std::vector<std::vector<std::string>>& table) {
    const bool measured = table.size() > 1;
    if (measured) std::cout << formatTable(table);
    if (options.json) results.write(*options.json, interrupted());
    if (!interrupted()) {
        if (!measured) spdlog::error("nothing was measured");
        return measured ? exitOk : exitFailed;
    }
    spdlog::warn(measured ? "interrupted: what was measured until then is kept"
                          : "interrupted before anything was measured");
    return exitFailed;
}

Command benchCommand() {
    std::vector<BenchName> names;
    for (const Bench& bench : allBenches()) names.push_back(bench.name);
    return {.name = "bench",
            .summary = "measurements, as a table and as --json",
            .groups = cityOptions | jsonOptions,
            .benches = names,
            .run = [](const Options& options) {
                for (const Bench& bench : allBenches())
                    if (bench.name.name == options.bench) return bench.run(options);
                throw std::runtime_error("there is no measurement '" + options.bench + "'.");
            }};
}

}  // namespace app
