#include "app/commands/Commands.h"
#include "app/commands/OffscreenTour.h"
#include "app/commands/WindowTour.h"
#include "app/display/Window.h"

namespace app {

Command tourCommand() {
    return {.name = "tour",
            .summary = "traffic drives, the camera tours: in a window, or as stills and a video in --out",
            .groups = cityOptions | trafficOptions | reflectionOptions | budgetOption | errorOptions |
                      mirrorOptions | chromeOptions | pictureOptions | outOptions | jsonOptions | durationOptions |
                      displayOptions,
            .benches = {},
            .run = [](const Options& options) {
                return options.offscreen || !Window::possible() ? runOffscreenTour(options)
                                                                : runWindowTour(options);
            }};
}

}  // namespace app
