#include <spdlog/spdlog.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/Benches.h"
#include "app/commands/CityTriangles.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/StreetShots.h"
#include "app/commands/Version.h"
#include "app/commands/WindowsStage.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/WetRoad.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"

namespace app {

namespace {

constexpr double nightHour = 23;
/// Frames after which the maps of a standing view are as fine as they get.
constexpr int framesOfAge = 8;
constexpr std::uint32_t carsOnStreet = 30;

struct Still {
    std::string name;
    std::optional<StreetShot> shot;
    std::string missing;  ///< what the city has not, where there is no shot
    Lighting lighting;
    ReflectionMethod method = ReflectionMethod::mem;
    bool wet = false;
};

void writeImage(const Image8& image, const std::filesystem::path& file) {
    writePng({image.size.x, image.size.y, image.rgba}, file);
}

nlohmann::ordered_json known(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

int benchStreets(const Options& options) {
    const std::filesystem::path first = options.out / "street_shops.png";
    requireWritable(first);
    RenderOptions rendering;
    rendering.antialiasing = Antialiasing::msaa4;
    PreparedScene stage(options, rendering);
    const Scene& scene = stage.scene;
    ResultFile results("streets", std::string(programVersion), stage.context.renderer());
    std::vector<std::vector<std::string>> table{
        {"picture", "passes", "panes", "wet street", "glass, dB", "FLIP", "wet ground, dB", "FLIP"}};
    if (!stage.reflections.complete) return reportBench(options, results, table);
    const CarsStage set = setCarsStage(scene, stage.renderer, carsOnStreet, options.seed, options.resolution);
    if (!set.traffic) throw std::runtime_error("the city has no street to look down.");
    const FrameScene street =
        assembleFrame(scene.city, *set.traffic, scene.lighting, {set.view}, scene.staged);
    reflection::TriangleTracer triangles;
    addCity(triangles, scene.city);
    triangles.commit();
    View low = set.view;
    low.eye.z -= 2.4;  // from a bus driver's eyes to those of somebody in a van
    // Exposed as one would a photograph: for a street in the shade, and for dark paint, which mirrors 4%.
    Lighting shaded = scene.lighting, dark = scene.lighting;
    shaded.exposure *= 1.5f;
    dark.exposure *= 4.0f;
    // Maps of the city are of the day: at night each car's is drawn anew.
    const std::vector<Still> stills{
        {"shops", betweenShops(scene, street, triangles, options.resolution),
         "no lane between two shop fronts, 8 to 30 m apart, that show each other", shaded},
        {"door", windowInDoor(scene, street, triangles, options.resolution),
         "no lane within 16 m before a shop front that a car's door could show", dark},
        {"night", StreetShot{low, street.vehicles}, "", lightingAt(nightHour), ReflectionMethod::rerender,
         true}};
    for (const Still& still : stills) {
        if (interrupted()) break;
        if (!still.shot) {
            spdlog::warn("street_{}.png is left out: the city has {}.", still.name, still.missing);
            continue;
        }
        FrameScene frame = street;
        frame.views = {still.shot->view};
        frame.vehicles = still.shot->vehicles;
        frame.lighting = still.lighting;
        WindowsCase what{still.name, true, {}};
        what.settings.depth = 3;
        what.settings.maps = 16;
        if (still.wet) what.settings.wetRoad = roadSeenBy(scene.city.roads, still.shot->view);
        ReflectionSettings settings;
        settings.method = still.method;
        settings.quality = Quality::high;
        WindowsStage drawn(scene, stage.reflections, stage.renderer, options.resolution, {what}, settings);
        const Image8 image = drawn.picture(drawn.runs().front(), frame, framesOfAge);
        const std::string file = "street_" + still.name + ".png";
        writeImage(image, options.out / file);
        const MirrorCounters planned = drawn.runs().front().planned;
        const WindowsTruth truth = drawn.truthOf(frame, still.wet);
        const std::string traced = "street_" + still.name + "_truth.png";
        writeImage(toImage(truth.display, options.resolution), options.out / traced);
        WindowsRun::Errors errors;
        drawn.compare(
            frame, [&](const WindowsRun&) { return &truth; }, [](const WindowsRun&) { return false; },
            [&](WindowsRun&, WindowsPicture&& made) { errors = made.errors; });
        results.add({{"picture", file},
                     {"city", options.city},
                     {"passes", planned.passes},
                     {"windows", planned.windows},
                     {"wet_street", planned.road},
                     {"truth", traced},
                     {"psnr_db", known(errors.psnr)},
                     {"mean_flip", known(errors.flip)},
                     {"water_psnr_db", known(errors.waterPsnr)},
                     {"water_mean_flip", known(errors.waterFlip)}});
        table.push_back({file, std::to_string(planned.passes), std::to_string(planned.windows),
                         planned.road ? "yes" : "no", fixed(errors.psnr, 1), fixed(errors.flip, 4),
                         fixed(errors.waterPsnr, 1), fixed(errors.waterFlip, 4)});
    }
    return reportBench(options, results, table);
}

}  // namespace app
