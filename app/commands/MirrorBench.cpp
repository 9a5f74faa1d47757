#include "app/commands/MirrorBench.h"

#include <algorithm>
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

double frameTime(MirrorStage& stage, const TreeSettings& settings) {
    finishDrawing();
    const Stopwatch watch;
    stage.draw(settings);
    finishDrawing();
    return watch.elapsed();
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
        const reflection::TreeCounters counters = stage.draw(settings).counters;
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
                                   {"environment_faces", counters.faces},
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
            std::string name = world.name + " " + v.name;
            std::replace(name.begin(), name.end(), ' ', '_');
            name.erase(std::remove(name.begin(), name.end(), ','), name.end());
            saveRadiance(stage.read(), options.size, *options.save, name);
        }
        if (options.advance) options.advance();
    }
    return out;
}

MirrorRows culling(const MirrorWorld& given, const MirrorBenchOptions& options, bool eachEconomy) {
    MirrorWorld world = given;
    world.depth = 2;
    MirrorRows out;
    out.title = world.name + ", depth 2: what culling is worth";
    out.table.push_back({"drawn", "maps", "faces", "triangles", "texels", "frame, ms", "all / this",
                         "reflections alone", "PSNR, dB"});
    struct Case {
        std::string name;
        Economies economies;
        CurvedMaps curved;
        glm::ivec2 mapSize;
        bool together = false;  ///< maps of a level side by side
        bool plain = false;     ///< without any reflection
    };
    const CurvedMaps first = world.curved.empty() ? CurvedMaps::none : CurvedMaps::viewDependent;
    std::vector<std::vector<Case>> groups;
    Economies all;
    all.cap = all.cutOff = all.detail = false;  // these change the picture
    const CurvedMaps second = world.curved.empty() ? CurvedMaps::none : CurvedMaps::cube;
    const glm::ivec2 paperMap(256, 256), pictureMap(0, 0);
    groups.push_back({{"256 x 256, all", Economies::paper(), first, paperMap},
                      {"256 x 256, culled", all, first, paperMap},
                      {"256 x 256, culled, together", all, first, paperMap, true}});
    if (first != second)
        groups.push_back({{"256 x 256, cubes, all", Economies::paper(), second, paperMap},
                          {"256 x 256, cubes, culled", all, second, paperMap},
                          {"256 x 256, cubes, culled, together", all, second, paperMap, true}});
    groups.push_back({{"picture's texels, all", Economies::paper(), second, pictureMap},
                      {"picture's texels, culled", all, second, pictureMap},
                      {"picture's texels, culled, together", all, second, pictureMap, true}});
    if (eachEconomy) {
        Economies more = all;
        more.cap = more.cutOff = true;
        groups.front().push_back({"with cap of 64 and cut-off", more, first, paperMap});
        for (const auto& [name, member] : {std::pair{"without off screen", &Economies::offScreen},
                                           std::pair{"without narrow", &Economies::narrow},
                                           std::pair{"without scissor", &Economies::scissor},
                                           std::pair{"without resolution", &Economies::resolution},
                                           std::pair{"without occlusion", &Economies::occlusion},
                                           std::pair{"without share", &Economies::share}}) {
            Economies less = all;
            less.*member = false;
            groups.front().push_back({name, less, first, paperMap});
        }
    }
    const auto settingsOf = [&](const Case& c) {
        TreeSettings settings = paperSettings(world, c.economies);
        settings.mapSize = c.mapSize;
        if (c.economies.cap) settings.mostMaps = 64;
        if (c.plain) settings.depth = 0;
        return settings;
    };
    for (std::vector<Case>& group : groups)
        group.push_back({"no reflections", all, group[0].curved, paperMap, false, true});
    for (const std::vector<Case>& group : groups) {
        std::vector<std::unique_ptr<MirrorStage>> stages;
        std::vector<std::vector<double>> times(group.size());
        std::vector<std::uint64_t> triangles(group.size());
        // Interleaved; the unculled one takes seconds on a street of windows.
        int rounds = 7;
        for (int round = 0; round <= rounds; ++round)
            for (std::size_t i = 0; i < group.size() && !options.stop(); ++i) {
                if (round == 0) {
                    reflection::MirrorPassOptions how = eightBits();
                    how.together = group[i].together;
                    stages.push_back(
                        std::make_unique<MirrorStage>(world, options.size, group[i].curved, how));
                }
                if (i >= stages.size()) continue;
                const std::uint64_t before = stages[i]->trianglesDrawn();
                const double ms = frameTime(*stages[i], settingsOf(group[i]));
                triangles[i] = stages[i]->trianglesDrawn() - before;
                if (round > 0) times[i].push_back(ms);
                if (round == 0 && ms > 500) rounds = 3;
            }
        if (options.stop()) return out;
        std::vector<glm::vec3> reference;
        for (std::size_t i = 0; i < group.size(); ++i) {
            const ReflectionTree& tree = stages[i]->draw(settingsOf(group[i]));
            const std::vector<glm::vec3> image = stages[i]->read();
            if (i == 0) reference = image;
            const double psnr =
                i == 0 ? std::numeric_limits<double>::quiet_NaN() : psnrOf(image, reference, options.size);
            std::vector<double> ratio;
            for (std::size_t k = 0; k < times[i].size(); ++k) ratio.push_back(times[0][k] / times[i][k]);
            const double gain = timingOf(ratio).median;
            const double plain = timingOf(times.back()).median;
            const double alone =
                (timingOf(times[0]).median - plain) / std::max(timingOf(times[i]).median - plain, 1e-3);
            const reflection::TreeCounters& c = tree.counters;
            out.table.push_back({group[i].name, std::to_string(c.generated()), std::to_string(c.faces),
                                 std::to_string(triangles[i]), std::to_string(c.texels),
                                 fixed(timingOf(times[i]).median, 2), i == 0 ? "1" : fixed(gain, 2),
                                 fixed(psnr, 1)});
            out.rows.push_back({{"part", "culling"},
                                {"scene", world.name},
                                {"method", group[i].name},
                                {"depth", world.depth},
                                {"generated", c.generated()},
                                {"environment_faces", c.faces},
                                {"texels", c.texels},
                                {"triangles_drawn", triangles[i]},
                                {"back_facing", c.backFacing},
                                {"off_screen", c.offScreen},
                                {"occluded", c.occluded},
                                {"shared", c.shared},
                                {"objects", c.objects},
                                {"objects_culled", c.objectsCulled},
                                {"frame_ms", toJson(timingOf(times[i]))},
                                {"ratio_to_all", gain},
                                {"ratio_to_all_reflections_alone", alone},
                                {"psnr_db", psnr}});
        }
        if (options.save) {
            std::string name = group[1].name + " " + world.name;
            name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == ',' || c == '\''; }),
                       name.end());
            std::replace(name.begin(), name.end(), ' ', '_');
            saveRadiance(stages[1]->read(), options.size, *options.save, name);
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
        std::string name = world.name + " traced";
        std::replace(name.begin(), name.end(), ' ', '_');
        name.erase(std::remove(name.begin(), name.end(), ','), name.end());
        saveRadiance(truth.radiance, options.size, *options.save, name);
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
