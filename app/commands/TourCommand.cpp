#include <cstdlib>

#include "app/commands/Commands.h"
#include "app/commands/OffscreenTour.h"

namespace app {

namespace {

int run(const Options& options) {
    return runOffscreenTour(options);
}

}  // namespace

Command tourCommand() {
    return {.name = "tour",
            .summary = "traffic drives, the camera tours: in a window, or as stills and a video in --out",
            .groups = cityOptions | trafficOptions | reflectionOptions | pictureOptions | outOptions |
                      jsonOptions | durationOptions | displayOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
