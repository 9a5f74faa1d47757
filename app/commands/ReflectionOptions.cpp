#include "app/commands/ReflectionOptions.h"

#include <charconv>
#include <string_view>

#include "app/commands/NamedOption.h"
#include "app/commands/OptionChecks.h"
#include "app/frame/ChromeDrawing.h"

namespace app {

namespace {

/// "16ms", "16 ms" or "16".
void parseBudget(const std::string& text, double& target) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, target);
    std::string_view unit(rest, static_cast<std::size_t>(end - rest));
    while (unit.starts_with(' ')) unit.remove_prefix(1);
    if (error != std::errc() || !(unit.empty() || unit == "ms") || !(target >= 0.1 && target <= 10000))
        throw CLI::ValidationError("--budget",
                                   "'" + text + "' is not a time from 0.1 to 10000 milliseconds, like 16ms");
}

}  // namespace

void addBudget(CLI::App& parser, Options& o, unsigned groups) {
    auto* budget = parser
                       .add_option_function<std::string>(
                           "--budget", [&o](const std::string& text) { parseBudget(text, o.budgetMs); },
                           "time of a frame to be held by method mem: detail follows the load; calibrates "
                           "once, half a minute")
                       ->type_name("MS");
    if (!(groups & errorOptions)) return;
    parser
        .add_option("--error", o.error,
                    "mean FLIP on mirrors, 0.001 to 1, to be met with the cheapest detail (method mem)")
        ->type_name("FLIP")
        ->check(between(0.001, 1, ""))
        ->excludes(budget);
    parser.add_flag(
        "--fixed-quality", o.fixedQuality,
        "nothing adapts while it runs, for runs that can be repeated: --error chooses by the calibration "
        "alone, --budget by the time that the first view takes, and says what it chose");
}

void addMirrors(CLI::App& parser, Options& o) {
    parser
        .add_option_function<std::string>(
            "--mirrors", [&o](const std::string& text) { o.mirrors = text == "on"; },
            "windows of shops and curtain walls mirror the street and each other: on (default) or off")
        ->type_name("on|off")
        ->check(CLI::IsMember({"on", "off"}));
    addNamed(parser, "--weather", o.weather, weatherNames,
             "wet: streets mirror as after rain, with puddles, where --mirrors are on (default dry)");
    parser.add_option("--mirror-depth", o.mirrorDepth, "mirrors in a row, 0 to 8")
        ->type_name("N")
        ->capture_default_str()
        ->check(wholeBetween(0, 8));
    parser
        .add_option("--mirror-maps", o.mirrorMaps,
                    "reflections drawn a frame at most, 0 to 1000, the least visible left out")
        ->type_name("N")
        ->capture_default_str()
        ->check(wholeBetween(0, 1000));
    parser
        .add_option(
            "--mirror-fade", o.mirrorFade,
            "metres behind a window or wet street, 0.1 to 10000, on which what it mirrors fades to 1/e; 0 "
            "(default): it does not")
        ->type_name("METRES")
        ->check(CLI::IsMember({"0"}) | between(0.1, 10000, "metres"));
}

void addChrome(CLI::App& parser, Options& o) {
    parser
        .add_option_function<std::string>(
            "--chrome", [&o](const std::string& text) { o.chrome = text == "auto"; },
            "chrome that is large in the picture shows what is close to it where it truly appears: auto "
            "(default) or off; its reflectors are made in the background (waited for offscreen and with "
            "--fixed-quality), once: they are kept in the cache folder. A budget asks for larger chrome")
        ->type_name("auto|off")
        ->check(CLI::IsMember({"auto", "off"}));
    parser
        .add_option(
            "--chrome-share", o.chromeShare,
            "of the vertices that a piece of chrome shows, search for no more than this share, 0.001 to 1, "
            "those first that would be farthest off; the rest follow them in cells; 1 searches for all. "
            "Default: as many as it takes until none is off by more than a quarter of a pixel")
        ->type_name("SHARE")
        ->check(between(0.001, 1, ""));
    parser
        .add_option("--chrome-bounces", o.chromeBounces,
                    "chrome parts in a row that show what is close to them where it is, 1 to 4; 1: chrome "
                    "seen in the chrome of another mirrors its vehicle's map alone. More take time only "
                    "where such chrome is large enough")
        ->type_name("N")
        ->capture_default_str()
        ->check(wholeBetween(1, mostChromeBounces));
}

}  // namespace app
