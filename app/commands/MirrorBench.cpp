#include "app/commands/MirrorBench.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "app/display/OffscreenTarget.h"
#include "app/mirrors/MirrorTruth.h"
#include "app/render/MirrorStage.h"
#include "app/report/Picture.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/truth/ImageError.h"

namespace app {

using reflection::CurvedMaps;
using reflection::Economies;
using reflection::ReflectionTree;
using reflection::TreeSettings;

namespace {

constexpr double megabyte = 1 << 20;

/// The paper's maps: 256 x 256 texels of 4 bytes, cube faces of 128 x 128.
TreeSettings paperSettings(const MirrorWorld& world, const Economies& economies) {
    TreeSettings settings;
    settings.depth = world.depth;
    settings.economies = economies;
    settings.mapSize = {256, 256};
    settings.faceSize = 128;
    settings.mostMaps = 1u << 20;
    return settings;
}

reflection::MirrorPassOptions eightBits() {
    reflection::MirrorPassOptions options;
    options.format = reflection::MirrorFormat::rgba8;
    return options;
}

Timing timed(MirrorStage& stage, const TreeSettings& settings, int frames) {
    stage.draw(settings);
    std::vector<double> ms;
    for (int i = 0; i < frames; ++i) ms.push_back(frameTime(stage, settings));
    return timingOf(ms);
}

std::string both(double ours, double theirs, int decimals) {
    // Halves up, as the paper rounds.
    const double unit = decimals == 0 ? 1 : 10;
    return fixed(std::floor(ours * unit + 0.5) / unit, decimals) + " / " +
           (theirs < 0 ? "-" : fixed(theirs, decimals));
}

double psnrOf(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, const glm::ivec2& size,
              reflection::PixelMask mask = {}) {
    return reflection::psnr({size.x, size.y, a}, {size.x, size.y, b}, mask);
}

struct Variant {
    std::string name;
    CurvedMaps curved;
    bool refresh;
};

}  // namespace

double frameTime(MirrorStage& stage, const TreeSettings& settings) {
    finishDrawing();
    const Stopwatch watch;
    stage.draw(settings);
    finishDrawing();
    return watch.elapsed();
}

std::string fileName(const std::string& text) {
    std::string name;
    for (char c : text) {
        if (c == ' ') name += '_';
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.') name += c;
    }
    return name;
}

void saveRadiance(const std::vector<glm::vec3>& radiance, const glm::ivec2& size,
                  const std::filesystem::path& folder, const std::string& name) {
    Picture picture;
    picture.width = size.x;
    picture.height = size.y;
    for (const glm::vec3& c : radiance) {
        for (int i = 0; i < 3; ++i) {
            const float v = std::clamp(c[i], 0.f, 1.f);
            const float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
            picture.rgba.push_back(static_cast<std::uint8_t>(encoded * 255 + 0.5f));
        }
        picture.rgba.push_back(255);
    }
    std::filesystem::create_directories(folder);
    writePng(picture, folder / (name + ".png"));
}

MirrorRows tableOne(const MirrorWorld& world, const PaperRow* paper, const MirrorBenchOptions& options) {
    MirrorRows out;
    out.title = world.name + ": ours / the paper's";
    out.table.push_back({"maps", "depth", "planar", "curved", "triangles", "generated", "curved maps",
                         "memory, MB", "traditional, MB", "frame, ms"});
    for (const Variant& v :
         {Variant{"view dependent", CurvedMaps::viewDependent, true},
          Variant{"cube, dynamic", CurvedMaps::cube, true}, Variant{"cube, static", CurvedMaps::cube, false},
          Variant{"paraboloids, dynamic", CurvedMaps::dualParaboloid, true}}) {
        if (options.stop()) return out;
        MirrorStage stage(world, options.size, v.curved, eightBits());
        TreeSettings settings = paperSettings(world, Economies::paper());
        // Maps of maps of maps: interreflections have settled after a few frames.
        for (int i = 0; i < 3; ++i) stage.draw(settings);
        settings.refreshCurved = v.refresh;
        const Timing time = timed(stage, settings, 7);
        settings.curved = v.curved;
        const ReflectionTree& tree = stage.draw(settings);
        const reflection::TreeCounters counters = tree.counters;
        // Which maps the environment maps show in each other, as in the paper's figure 6.
        std::size_t fresh = 0, old = 0;
        for (const reflection::EnvironmentJob& job : tree.environments) {
            fresh += static_cast<std::size_t>(std::ranges::count(job.others, reflection::MapAge::thisFrame));
            old += static_cast<std::size_t>(std::ranges::count(job.others, reflection::MapAge::lastFrame));
        }
        const reflection::MirrorPassCounters held = stage.pass().counters();
        const reflection::MapMemory memory =
            reflection::paperMemory(settings, world.mirrors.size(), world.curved.size());
        const bool dependent = v.curved == CurvedMaps::viewDependent, cube = v.curved == CurvedMaps::cube;
        const bool known = paper != nullptr && (dependent || cube);
        double theirs = -1;
        if (known)
            theirs = dependent   ? paper->viewDependent
                     : v.refresh ? paper->dynamicPlanar
                                 : paper->staticPlanar;
        const double used = !known ? -1 : dependent ? paper->usedDependent : paper->usedIndependent;
        const double traditional = !known      ? -1
                                   : dependent ? paper->traditionalDependent
                                               : paper->traditionalIndependent;
        const double fps = !known      ? -1
                           : dependent ? paper->fpsDependent
                           : v.refresh ? paper->fpsDynamic
                                       : paper->fpsStatic;
        const std::string maps =
            dependent ? "-"
                      : std::to_string(counters.faces) + " / " +
                            (known && v.refresh ? "6*" + std::to_string(paper->curvedMaps) : "-");
        out.table.push_back({v.name, std::to_string(world.depth), std::to_string(world.mirrors.size()),
                             std::to_string(world.curved.size()), std::to_string(world.triangles()),
                             both(counters.generated(), theirs, 0), maps,
                             both(static_cast<double>(memory.used) / megabyte, used, 1),
                             both(static_cast<double>(memory.traditional) / megabyte, traditional, 1),
                             fixed(time.median, 2)});
        nlohmann::ordered_json row{{"part", "table 1"},
                                   {"scene", world.name},
                                   {"method", v.name},
                                   {"depth", world.depth},
                                   {"planar", world.mirrors.size()},
                                   {"curved", world.curved.size()},
                                   {"triangles", world.triangles()},
                                   {"generated", counters.generated()},
                                   {"in_environments", counters.planarInEnvironments},
                                   {"environment_faces", counters.faces},
                                   {"interreflections_of_this_frame", fresh},
                                   {"interreflections_of_last_frame", old},
                                   {"map_bytes", memory.used},
                                   {"map_bytes_traditional", memory.traditional},
                                   {"map_bytes_held", held.mapBytes + held.environmentBytes},
                                   {"spare_bytes", held.spareBytes},
                                   {"width", options.size.x},
                                   {"height", options.size.y},
                                   {"frame_ms", toJson(time)}};
        if (known) {
            row["paper"] = {{"generated", theirs},
                            {"map_megabytes", used},
                            {"map_megabytes_traditional", traditional},
                            {"fps", fps}};
            if (cube && v.refresh) row["paper"]["environment_faces"] = 6 * paper->curvedMaps;
        }
        out.rows.push_back(std::move(row));
        if (options.save) {
            saveRadiance(stage.read(), options.size, *options.save, fileName(world.name + " " + v.name));
        }
        if (options.advance) options.advance();
    }
    return out;
}

MirrorRows curvedError(const MirrorWorld& given, const MirrorBenchOptions& options) {
    MirrorWorld world = given;
    MirrorRows out;
    out.title = world.name + ": curved reflectors against ray tracing of eight bounces";
    out.table.push_back({"maps", "PSNR on curved, dB", "PSNR of the picture, dB"});
    const reflection::TreeView view = world.view(options.size);
    const TracedPicture truth = MirrorTruth(world).picture(view, {.depth = 8, .samples = 32});
    struct Case {
        const char* name;
        CurvedMaps curved;
        bool nearness = false;
    };
    for (const auto& [name, curved, nearness] :
         {Case{"none", CurvedMaps::none}, Case{"view dependent", CurvedMaps::viewDependent},
          Case{"cube", CurvedMaps::cube}, Case{"paraboloids", CurvedMaps::dualParaboloid},
          Case{"cube, parallax", CurvedMaps::cube, true},
          Case{"paraboloids, parallax", CurvedMaps::dualParaboloid, true}}) {
        if (options.stop()) return out;
        reflection::MirrorPassOptions how;
        how.nearness = nearness;
        MirrorStage stage(world, options.size, curved, how);
        TreeSettings settings;
        settings.depth = std::max(world.depth, 3);
        settings.mostMaps = 4096;
        for (int i = 0; i < 4; ++i) stage.draw(settings);
        const std::vector<glm::vec3> image = stage.read();
        const double on = psnrOf(image, truth.radiance, options.size, truth.curved);
        const double whole = psnrOf(image, truth.radiance, options.size);
        out.table.push_back({name, fixed(on, 1), fixed(whole, 1)});
        out.rows.push_back({{"part", "curved"},
                            {"scene", world.name},
                            {"method", name},
                            {"psnr_db_on_curved", on},
                            {"psnr_db", whole}});
    }
    if (options.save) {
        saveRadiance(truth.radiance, options.size, *options.save, fileName(world.name + " traced"));
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
