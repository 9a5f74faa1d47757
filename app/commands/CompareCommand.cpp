#include <spdlog/spdlog.h>

#include <glm/trigonometric.hpp>
#include <iostream>

#include "app/commands/Commands.h"
#include "app/commands/CompareChrome.h"
#include "app/commands/CompareRun.h"
#include "app/commands/CompareWindows.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/Version.h"
#include "app/compare/ComparePage.h"
#include "app/report/AsideFile.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

namespace {

void printRows(const std::vector<CompareRow>& rows) {
    std::vector<std::vector<std::string>> table{{"method", "set", "cars", "views", "frame ms",
                                                 "reflections ms", "FLIP", "to rerender", "PSNR dB",
                                                 "flicker", "angle deg", "maps a frame", "front"}};
    for (const CompareRow& row : rows)
        table.push_back({row.point.title(), row.point.setting, std::to_string(row.cars), row.views,
                         fixed(row.frame.median, 1), fixed(row.reflection.median, 2),
                         fixed(row.againstTruth.flip, 4), fixed(row.againstRerender.flip, 4),
                         fixed(row.againstTruth.psnr, 1), fixed(row.againstTruth.flicker, 5),
                         fixed(glm::degrees(row.againstTruth.angle), 1), fixed(row.mapsPerFrame, 1),
                         row.onFront ? "*" : ""});
    std::cout << formatTable(table) << "\n";
    for (const FrontVerdict& v : frontVerdicts(rows))
        if (v.points > 0)
            std::cout << v.cars << " cars: mem's front is below " << v.other << " at " << v.below << " of "
                      << v.points << " settings\n";
}

void printWindows(const std::vector<WindowRow>& rows) {
    std::vector<std::vector<std::string>> table{{"windows", "in view", "mirror", "panes", "passes", "levels",
                                                 "frame ms", "/ painted", "FLIP", "PSNR dB"}};
    for (const WindowRow& row : rows)
        table.push_back({row.name, std::to_string(row.inView), std::to_string(row.fronts),
                         std::to_string(row.panes), std::to_string(row.passes), std::to_string(row.levels),
                         fixed(row.frame.median, 1), fixed(row.ratioToPainted, 2), fixed(row.flip, 4),
                         fixed(row.psnr, 1)});
    std::cout << formatTable(table) << "\n";
}

void printChrome(const std::vector<ChromeRow>& rows) {
    std::vector<std::vector<std::string>> table{
        {"close-up", "method", "parts", "pixels", "frame ms", "/ none", "FLIP", "PSNR dB"}};
    for (const ChromeRow& row : rows)
        table.push_back({row.view, row.method, std::to_string(row.jobs), std::to_string(row.pixels),
                         fixed(row.frame.median, 1), fixed(row.ratioToNone, 2), fixed(row.flip, 4),
                         fixed(row.psnr, 1)});
    std::cout << formatTable(table) << "\n";
}

int run(const Options& options) {
    PreparedScene stage(options);
    ResultFile results("compare", std::string(programVersion), stage.context.renderer());
    Comparison comparison;
    CompareOptions settings;
    settings.seed = options.seed;
    settings.resolution = options.resolution;
    settings.quiet = options.quiet;
    settings.frameStep = 1.0 / options.fps;
    settings.pictures = options.html.has_value();
    if (!options.cars.empty()) settings.cars = options.cars;
    if (const auto frames = options.frameCount()) settings.frames = *frames;
    if (stage.reflections.complete)
        comparison = runComparison(stage.scene, stage.reflections, stage.renderer, settings);

    WindowComparison windows;
    if (stage.reflections.complete && !interrupted())
        windows = compareWindows(stage.scene, stage.reflections, stage.renderer, settings);

    ChromeComparison chrome;
    if (stage.reflections.complete && !interrupted())
        chrome = compareChrome(stage.scene, stage.reflections, stage.renderer, settings, options.quality);

    const std::vector<CompareRow>& rows = comparison.rows;
    for (const CompareRow& row : rows) results.add(toJson(row, options.city));
    for (const WindowRow& row : windows.rows) results.add(toJson(row, options.city));
    for (const ChromeRow& row : chrome.rows) results.add(toJson(row, options.city));
    if (!rows.empty()) printRows(rows);
    if (!windows.rows.empty()) printWindows(windows.rows);
    if (!chrome.rows.empty()) printChrome(chrome.rows);
    if (options.json) results.write(*options.json, interrupted());
    if (options.html && !rows.empty()) {
        const nlohmann::ordered_json document = results.document(interrupted());
        PageHead head;
        head.city = options.city;
        head.seed = options.seed;
        head.version = document["version"];
        head.renderer = document["renderer"];
        head.cpu = document["cpu"];
        head.threads = document["threads"];
        head.frames = settings.frames;
        head.truth = comparison.truth;
        head.partial = interrupted();
        writeTextFile(*options.html, comparePage(head, rows, comparison.strips, windows, chrome));
        spdlog::info("page: {}", options.html->string());
    }
    if (interrupted()) {
        spdlog::warn(rows.empty() ? "interrupted before anything was measured"
                                  : "interrupted: what was measured until then is kept");
        return exitFailed;
    }
    if (rows.empty()) spdlog::error("nothing was measured");
    return rows.empty() ? exitFailed : exitOk;
}

}  // namespace

Command compareCommand() {
    return {.name = "compare",
            .summary =
                "error against time against number of cars for every method, their settings swept; and "
                "of windows that mirror, and of close chrome",
            .groups = cityOptions | trafficOptions | severalCars | cellOption | pictureOptions |
                      durationOptions | jsonOptions | htmlOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
