#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "app/frame/CameraRig.h"
#include "app/frame/ReflectionMethod.h"
#include "app/frame/Weather.h"

namespace app {

/// Who searches for reflection points in close chrome.
enum class ChromeSearchOn : std::uint8_t {
    automatic,  ///< "auto": the graphics card; the processor where that draws as well
    cpu,
    gpu,
};
inline constexpr std::array<std::string_view, 3> chromeSearchNames{"auto", "cpu", "gpu"};

/// What the command line asked for: plain data, every number finite and within the range that its --help
/// names.
struct Options {
    std::string bench;               ///< name of the measurement, for `bench`
    std::string city = "boulevard";  ///< built-in name or file; empty where the command line named none and
                                     ///< the command allows it
    std::uint64_t seed = 1;
    std::optional<double> size;  ///< metres, side of a generated city or clip square of a file
    /// One number; several where a measurement allows it, and then none unless the command line names some.
    std::vector<std::uint32_t> cars{60};
    std::optional<std::filesystem::path> car;     ///< GLB that replaces the built-in cars
    double carLength = 4.5;                       ///< metres
    std::optional<std::filesystem::path> staged;  ///< vehicles beside the traffic
    ReflectionMethod method = ReflectionMethod::mem;
    MemVariant mem = MemVariant::ours;
    Quality quality = Quality::medium;
    MapsOn mapsOn = MapsOn::automatic;
    double gpuMapMegabytes = 512;      ///< 2^20 bytes, for reference maps on the graphics card
    double budgetMs = 0;               ///< --budget; 0: none was named
    double error = 0;                  ///< --error; 0: none was named
    bool fixedQuality = false;         ///< --fixed-quality
    double cell = 1;                   ///< metres, side of a heightfield cell
    double hour = 15;                  ///< local solar time
    bool adapt = true;                 ///< --exposure auto: pictures open in shaded streets
    glm::ivec2 resolution{1280, 720};  ///< pixels
    std::filesystem::path out = "out";
    std::optional<std::filesystem::path> json;
    std::optional<std::filesystem::path> html;
    std::optional<double> seconds;
    std::optional<std::uint32_t> frames;
    std::uint32_t fps = 30;
    bool offscreen = false;
    std::optional<CameraMode> camera;  ///< nothing: shots of both kinds in turn
    std::uint32_t stills = 6;
    bool mirrors = true;           ///< windows mirror
    int mirrorDepth = 2;           ///< mirrors in a row
    std::uint32_t mirrorMaps = 8;  ///< reflections a frame at most
    double mirrorFade = 0;         ///< metres; 0: mirrors do not fade
    bool chrome = true;            ///< chrome shows close things itself
    int chromeBounces = 1;         ///< chrome parts in a row that show what is close
    double chromeShare = 0;        ///< of vertices that are searched for in it at most; 0: no bound
    Weather weather = Weather::dry;
    std::uint32_t samples = 64;  ///< mirror rays a pixel
    std::uint32_t bounces = 3;   ///< mirrors in a row
    bool quiet = false;
    std::optional<std::filesystem::path> exportCity, exportCar, exportDrive;
    std::uint64_t rays = 4'000'000;             ///< of `stability`
    std::optional<std::filesystem::path> save;  ///< folder for what was measured, as pictures
    bool publishedSearch = false;               ///< --search paper
    std::string part;                           ///< --part; empty: all of a measurement
    std::string view;                           ///< --view; empty: all views
    ChromeSearchOn chromeSearch = ChromeSearchOn::automatic;

    /// --gpu-map-memory in bytes.
    std::size_t gpuMapBytes() const { return static_cast<std::size_t>(gpuMapMegabytes * 1048576); }
    /// Frames that --frames or --seconds ask for; nothing where neither was given.
    std::optional<std::uint32_t> frameCount() const;
};

/// Groups of options; a command takes several.
enum OptionGroup : unsigned {
    cityOptions = 1u << 0,     ///< CITY, also spelt --city, --seed --size
    cityIsOptional = 1u << 1,  ///< no CITY means none, not the default
    trafficOptions = 1u << 2,  ///< --cars --car --car-length --staged
    severalCars = 1u << 3,     ///< --cars takes several numbers
    methodOption = 1u << 4,    ///< --method
    memOption = 1u << 5,       ///< --mem
    qualityOption = 1u << 6,   ///< --quality
    cellOption = 1u << 7,      ///< --cell
    timeOption = 1u << 8,      ///< --time
    resolutionOption = 1u << 9,
    outOptions = 1u << 10,       ///< --out
    jsonOptions = 1u << 11,      ///< --json
    durationOptions = 1u << 12,  ///< --seconds --frames --fps
    displayOptions = 1u << 13,   ///< --offscreen --camera --stills
    /// --city --car --drive as files to write; the city to export is then CITY alone, the body --body.
    exportOptions = 1u << 14,
    mapsOnOptions = 1u << 15,     ///< --maps-on --gpu-map-memory
    stabilityOptions = 1u << 16,  ///< --rays, and --seed without a city
    htmlOptions = 1u << 17,       ///< --html
    rayOptions = 1u << 18,        ///< --samples --bounces
    shotOptions = 1u << 19,       ///< --camera --stills, where there is never a window

    mirrorOptions = 1u << 22,  ///< --mirrors --mirror-depth --mirror-maps --mirror-fade --weather
    budgetOption = 1u << 20,   ///< --budget
    errorOptions = 1u << 21,   ///< --error --fixed-quality
    saveOption = 1u << 23,     ///< --save
    bodyOption = 1u << 24,     ///< --car --car-length, where nothing drives
    searchOption = 1u << 25,   ///< --search --part --chrome-search
    chromeOptions = 1u << 26,  ///< --chrome --chrome-share --chrome-bounces
    viewOption = 1u << 27,     ///< --view --part

    reflectionOptions = methodOption | memOption | qualityOption | cellOption | mapsOnOptions,
    pictureOptions = timeOption | resolutionOption,
    mapOptions = cellOption | timeOption,  ///< what reference maps depend on
};

/// A name that may follow `bench`.
struct BenchName {
    std::string name;
    std::string summary;
    unsigned groups = 0;  ///< the options it obeys; others are bad usage
};

/// One command of the program.
struct Command {
    std::string name;
    std::string summary;
    unsigned groups = 0;                     ///< where there are measurements: what all of them obey
    std::vector<BenchName> benches;          ///< not empty: the first argument is one of these
    std::function<int(const Options&)> run;  ///< returns the exit code
};

/// Either the options, or the exit code with which the program should end at once (after --help, or after a
/// usage error that has been explained on stderr).
using ParseOutcome = std::variant<Options, int>;

inline constexpr int exitOk = 0;
inline constexpr int exitFailed = 1;
inline constexpr int exitUsage = 2;

/// Parses the arguments behind the command's name. Help goes to stdout, complaints to stderr.
ParseOutcome parseOptions(const Command& command, std::span<const std::string> arguments);

/// The candidate nearest to a misspelt word, if any is near enough to be meant (at most a third of its
/// letters differ).
std::optional<std::string> suggestion(const std::string& word, std::span<const std::string> candidates);

}  // namespace app
