#include "app/commands/Options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <sstream>
#include <string_view>

#include "app/commands/NamedOption.h"
#include "app/commands/OptionChecks.h"
#include "app/commands/ReflectionOptions.h"

namespace app {

namespace {

void parseResolution(const std::string& text, glm::ivec2& target) {
    const char* end = text.data() + text.size();
    const auto [x, error] = std::from_chars(text.data(), end, target.x);
    bool good = error == std::errc() && x != end && *x == 'x';
    if (good) {
        const auto [rest, error2] = std::from_chars(x + 1, end, target.y);
        good = error2 == std::errc() && rest == end;
    }
    if (!good || target.x < 16 || target.y < 16 || target.x > 16384 || target.y > 16384)
        throw CLI::ValidationError(
            "--resolution", "'" + text + "' is not WIDTHxHEIGHT with both from 16 to 16384, like 1280x720");
}

void addBody(CLI::App& parser, Options& o, unsigned groups) {
    parser
        .add_option(groups & exportOptions ? "--body" : "--car", o.car,
                    "body for all cars: a binary glTF file")
        ->type_name("FILE.glb")
        ->check(isPath() & CLI::ExistingFile);
    parser.add_option("--car-length", o.carLength, "length to which the body is scaled, 0.5 to 60")
        ->type_name("METRES")
        ->capture_default_str()
        ->check(between(0.5, 60, "metres"));
}

void addTraffic(CLI::App& parser, Options& o, unsigned groups) {
    if (groups & severalCars)
        parser
            .add_option("--cars", o.cars,
                        "numbers of cars, separated by commas (default: the measurement's own)")
            ->delimiter(',')
            ->type_name("N")
            ->check(wholeBetween(1, 100000));
    else
        parser.add_option("--cars", o.cars, "number of cars (default 60)")
            ->delimiter(',')
            ->type_name("N")
            ->check(wholeBetween(0, 100000))
            ->expected(1);
    addBody(parser, o, groups);
    parser
        .add_option(
            "--staged", o.staged,
            "vehicles that stand or drive where this file puts them, beside the traffic, and views of "
            "them in place of the tour")
        ->type_name("FILE.json")
        ->check(isPath() & CLI::ExistingFile);
}

/// What the command line said and `Options` has no place for.
struct Spellings {
    std::optional<std::string> city;        ///< CITY
    std::optional<std::string> cityByName;  ///< --city
};

void addGroups(CLI::App& parser, Options& o, Spellings& spellings, const Command& command, unsigned groups) {
    if (!command.benches.empty()) parser.add_option("NAME", o.bench, "the measurement")->required();
    if (groups & cityOptions) {
        parser.add_option("CITY", spellings.city,
                          groups & cityIsOptional
                              ? "boulevard, paper, or a file (.osm, .osm.pbf, ...)"
                              : "boulevard (default), paper, or a file (.osm, .osm.pbf, ...)");
        if (!(groups & exportOptions))
            parser.add_option("--city", spellings.cityByName, "another way to write CITY")->type_name("CITY");
        parser.add_option("--seed", o.seed, "of everything that is drawn at random")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(0, 0xffffffffffffffffull));
        parser
            .add_option("--size", o.size,
                        "side of boulevard (200 to 2000, default 600), or of the square that is cut from a "
                        "file (100 to 20000, default: all of it)")
            ->type_name("METRES")
            ->check(between(100, 20000, "metres"));
    }
    if (groups & trafficOptions) addTraffic(parser, o, groups);
    if ((groups & bodyOption) && !(groups & trafficOptions)) addBody(parser, o, groups);
    if (groups & methodOption)
        addNamed(parser, "--method", o.method, reflectionMethodNames,
                 "how vehicles get their reflections (default mem)");
    if (groups & memOption)
        addNamed(parser, "--mem", o.mem, memVariantNames, "form of the method mem (default ours)");
    if (groups & qualityOption)
        addNamed(parser, "--quality", o.quality, qualityNames,
                 "detail of drawing and reflections (default medium)");
    if (groups & budgetOption) addBudget(parser, o, groups);
    if (groups & mapsOnOptions) {
        addNamed(parser, "--maps-on", o.mapsOn, mapsOnNames,
                 "where mem keeps reference maps and makes local maps (default auto: gpu, but cpu where "
                 "OpenGL is software)");
        parser
            .add_option("--gpu-map-memory", o.gpuMapMegabytes,
                        "for reference maps on the graphics card, 1 to 65536; where they do not all fit, "
                        "those in use take turns")
            ->type_name("MIB")
            ->capture_default_str()
            ->check(between(1, 65536, "MiB"));
    }
    if (groups & cellOption)
        parser.add_option("--cell", o.cell, "side of a heightfield cell, 0.1 to 50")
            ->type_name("METRES")
            ->capture_default_str()
            ->check(between(0.1, 50, "metres"));
    if (groups & timeOption)
        parser.add_option("--time", o.hour, "hour of the day, 0 to 24")
            ->type_name("HOUR")
            ->capture_default_str()
            ->check(between(0, 24, "hours"));
    if (groups & resolutionOption)
        parser
            .add_option_function<std::string>(
                "--resolution", [&o](const std::string& text) { parseResolution(text, o.resolution); },
                "of pictures (default 1280x720)")
            ->type_name("WxH");
    if (groups & durationOptions) {
        auto* seconds = parser.add_option("--seconds", o.seconds, "length of the drive")
                            ->type_name("S")
                            ->check(between(0.01, 86400, "seconds"));
        parser.add_option("--frames", o.frames, "length of the drive in frames")
            ->type_name("N")
            ->check(wholeBetween(1, 10000000))
            ->excludes(seconds);
        parser.add_option("--fps", o.fps, "frames per second of the drive")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(1, 240));
    }
    if (groups & outOptions)
        parser
            .add_option("--out", o.out,
                        "folder for pictures and video (screenshots, where there is a window)")
            ->type_name("DIR")
            ->capture_default_str()
            ->check(isPath());
    using Names = std::vector<std::string>;
    if (groups & searchOption)
        parser
            .add_option_function<std::string>(
                "--search", [&o](const std::string& text) { o.publishedSearch = text == "paper"; },
                "search for reflection points, ours (default) or paper: as published, 9 steps")
            ->type_name("NAME")
            ->check(CLI::IsMember(Names{"ours", "paper"}));
    if (groups & (searchOption | viewOption))
        parser.add_option("--part", o.part, "one part of the measurement alone")
            ->type_name("NAME")
            ->check(CLI::IsMember(groups & viewOption ? Names{"picture", "motion", "cost"}
                                                      : Names{"search", "gpu", "share", "published", "still",
                                                              "frame", "picture", "bounces", "none"}));
    if (groups & searchOption)
        addNamed(parser, "--chrome-search", o.chromeSearch, chromeSearchNames,
                 "who searches where pictures with chrome search for everything (default auto: gpu, but "
                 "cpu where OpenGL is software)");
    if (groups & viewOption)
        parser.add_option("--view", o.view, "only what is called so, or has this in its name")
            ->type_name("NAME");
    if (groups & saveOption)
        parser.add_option("--save", o.save, "folder for pictures of what was measured")
            ->type_name("DIR")
            ->check(isPath());
    if (groups & jsonOptions)
        parser.add_option("--json", o.json, "write the results to this file")
            ->type_name("FILE")
            ->check(isPath());
    if (groups & htmlOptions)
        parser.add_option("--html", o.html, "write a page with charts, pictures and the table to this file")
            ->type_name("FILE")
            ->check(isPath());
    if (groups & stabilityOptions) {
        parser
            .add_option("--rays", o.rays,
                        "rays of the tracer's campaign, 1 to 10^12; the other campaigns grow with them, up "
                        "to a hundredfold")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(1, 1'000'000'000'000));
        parser.add_option("--seed", o.seed, "of everything that is drawn at random")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(0, 0xffffffffffffffffull));
    }
    if (groups & displayOptions)
        parser
            .add_option_function<std::string>(
                "--exposure", [&o](const std::string& text) { o.adapt = text == "auto"; },
                "auto (default): pictures are exposed longer in shaded streets, as a camera does; hour: by "
                "the "
                "hour of the day alone, as in every measurement")
            ->type_name("auto|hour")
            ->check(CLI::IsMember({"auto", "hour"}));
    if (groups & displayOptions)
        parser.add_flag("--offscreen", o.offscreen, "no window, even where there is a display");
    if (groups & (displayOptions | shotOptions)) {
        addNamed(parser, "--camera", o.camera, cameraModeNames,
                 "camera at the start (default: off screen, shots of a car and of the tour in turn)");
        parser.add_option("--stills", o.stills, "pictures to take along a drive without a window")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(0, 10000));
    }
    if (groups & rayOptions) {
        parser.add_option("--samples", o.samples, "mirror rays for each pixel of a vehicle, 1 to 65536")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(1, 65536));
        parser.add_option("--bounces", o.bounces, "mirrors in a row, 1 to 16")
            ->type_name("N")
            ->capture_default_str()
            ->check(wholeBetween(1, 16));
    }
    if (groups & mirrorOptions) addMirrors(parser, o);
    if (groups & chromeOptions) addChrome(parser, o);
    if (groups & exportOptions) {
        parser.add_option("--city", o.exportCity, "write the city to this file")
            ->type_name("FILE.glb")
            ->check(isPath() & isGlb("the city itself is CITY, without --city"));
        parser.add_option("--car", o.exportCar, "write the first vehicle model to this file")
            ->type_name("FILE.glb")
            ->check(isPath() & isGlb("a body to be read is --body"));
        parser.add_option("--drive", o.exportDrive, "write camera and cars, frame by frame, to this file")
            ->type_name("FILE.json")
            ->check(isPath());
    }
    parser.add_flag("-q,--quiet", o.quiet, "no progress, no remarks: results, warnings and errors alone");
}

/// Names that a command line may contain, for suggestions: "--cars", ...
std::vector<std::string> optionNames(const CLI::App& parser) {
    std::vector<std::string> names;
    for (const CLI::Option* option : parser.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

int complain(const Command& command, const std::string& message,
             const std::optional<std::string>& meant = std::nullopt) {
    std::cerr << "mirrorstreet " << command.name << ": " << message;
    if (meant) std::cerr << "; did you mean '" << *meant << "'?";
    std::cerr << "\nSee mirrorstreet " << command.name << " --help.\n";
    return exitUsage;
}

/// The measurements, for the help.
std::string benchList(const Command& command) {
    std::string list = "Measurements, each with options of its own (bench NAME --help):\n";
    for (const BenchName& bench : command.benches)
        list += "  " + bench.name + std::string(bench.name.size() < 12 ? 12 - bench.name.size() : 1, ' ') +
                bench.summary + "\n";
    return list;
}

/// Whether some measurement of the command has this option.
bool someBenchTakes(const Command& command, const std::string& option) {
    unsigned all = command.groups;
    for (const BenchName& bench : command.benches) all |= bench.groups;
    Options ignored;
    Spellings spellings;
    CLI::App parser;
    addGroups(parser, ignored, spellings, command, all);
    const std::vector<std::string> names = optionNames(parser);
    return std::find(names.begin(), names.end(), option) != names.end();
}

/// Brings both spellings of the city together and looks whether there is such a city, of that size. The exit
/// code of bad usage, which it has explained.
std::optional<int> settleCity(const Command& command, unsigned groups, const Spellings& spellings,
                              Options& options) {
    if (!(groups & cityOptions)) return std::nullopt;
    if (spellings.city && spellings.cityByName && *spellings.city != *spellings.cityByName)
        return complain(command, "two cities are named: '" + *spellings.city + "' and --city '" +
                                     *spellings.cityByName + "'");
    if (const auto& city = spellings.city ? spellings.city : spellings.cityByName) {
        if (city->empty()) return complain(command, "the city's name is empty");
        options.city = *city;
    }
    const bool builtIn = options.city == "boulevard" || options.city == "paper";
    std::error_code ignored;
    if (!builtIn && !options.city.empty() && !std::filesystem::is_regular_file(options.city, ignored)) {
        const std::vector<std::string> names{"boulevard", "paper"};
        return complain(
            command, "there is no city and no file named '" + options.city + "' (built in: boulevard, paper)",
            suggestion(options.city, names));
    }
    if (options.city == "boulevard" && options.size && (*options.size < 200 || *options.size > 2000)) {
        std::ostringstream size;
        size << *options.size;
        return complain(command,
                        "--size: " + size.str() + " is outside 200 to 2000 metres, the sizes of boulevard");
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::uint32_t> Options::frameCount() const {
    if (frames) return frames;
    if (seconds) return static_cast<std::uint32_t>(std::max(1.0, std::round(*seconds * fps)));
    return std::nullopt;
}

ParseOutcome parseOptions(const Command& command, std::span<const std::string> arguments) {
    // Options of measurements are those of the one that is named; it may stand behind some of them.
    const BenchName* bench = nullptr;
    for (const std::string& argument : arguments)
        for (const BenchName& known : command.benches)
            if (bench == nullptr && argument == known.name) bench = &known;
    const unsigned groups = command.groups | (bench != nullptr ? bench->groups : 0u);

    Options options;
    Spellings spellings;
    if (groups & cityIsOptional) options.city.clear();
    if (groups & severalCars) options.cars.clear();
    CLI::App parser(command.summary, "mirrorstreet " + command.name);
    parser.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::Throw);
    addGroups(parser, options, spellings, command, groups);
    if (!command.benches.empty()) parser.footer(benchList(command));
    // CLI11 takes the next argument for a value that is missing behind '='.
    for (const std::string& argument : arguments)
        if (argument.size() > 3 && argument.starts_with("--") && argument.find('=') + 1 == argument.size())
            return complain(command, argument + " has no value behind the '='");
    try {
        parser.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
        std::cout << parser.help();
        return exitOk;
    } catch (const CLI::ExtrasError&) {
        const std::vector<std::string> left = parser.remaining();
        const std::string word = left.empty() ? "" : left.front().substr(0, left.front().find('='));
        if (bench != nullptr && someBenchTakes(command, word))
            return complain(command, "the measurement '" + bench->name + "' does not depend on " + word);
        const std::string what = word.starts_with('-') ? "unknown option '" : "unexpected argument '";
        return complain(command, what + word + "'", suggestion(word, optionNames(parser)));
    } catch (const CLI::ParseError& error) {
        return complain(command, error.what());
    }
    if (!command.benches.empty() && (bench == nullptr || bench->name != options.bench)) {
        std::vector<std::string> names;
        for (const BenchName& known : command.benches) names.push_back(known.name);
        return complain(command, "there is no measurement '" + options.bench + "'",
                        suggestion(options.bench, names));
    }
    if (const std::optional<int> code = settleCity(command, groups, spellings, options)) return *code;
    return options;
}

std::optional<std::string> suggestion(const std::string& word, std::span<const std::string> candidates) {
    std::optional<std::string> best;
    std::size_t bestDistance = 0;
    for (const std::string& candidate : candidates) {
        // Edit distance with swaps of neighbours (Damerau): d[i][j] between the first i and the first j
        // letters.
        std::vector<std::vector<std::size_t>> d(word.size() + 1,
                                                std::vector<std::size_t>(candidate.size() + 1));
        for (std::size_t i = 0; i <= word.size(); ++i)
            for (std::size_t j = 0; j <= candidate.size(); ++j) {
                if (i == 0 || j == 0) {
                    d[i][j] = i + j;
                    continue;
                }
                const std::size_t differs = word[i - 1] == candidate[j - 1] ? 0 : 1;
                d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + differs});
                if (i > 1 && j > 1 && word[i - 1] == candidate[j - 2] && word[i - 2] == candidate[j - 1])
                    d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
            }
        const std::size_t distance = d[word.size()][candidate.size()];
        if (!best || distance < bestDistance) {
            best = candidate;
            bestDistance = distance;
        }
    }
    if (!best || 3 * bestDistance > std::max(word.size(), best->size())) return std::nullopt;
    return best;
}

}  // namespace app
