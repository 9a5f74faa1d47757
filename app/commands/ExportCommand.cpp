#include <spdlog/spdlog.h>

#include <iostream>
#include <stdexcept>

#include "app/commands/Commands.h"
#include "app/commands/LoadScene.h"
#include "app/export/ExportScene.h"
#include "app/frame/ShotPlan.h"
#include "app/report/Progress.h"

namespace app {

namespace {

constexpr double fovYDegrees = 60;  // as in the tour
constexpr std::uint32_t defaultFrames = 300;

/// A scene in which every vehicle is of the one kind that is exported, so that car and drive fit together.
Scene sceneOfOneModel(const Options& options) {
    Scene scene = loadScene(options);
    if (scene.models.empty())
        throw std::runtime_error("there is no vehicle to export; name one with --body.");
    scene.models.resize(1);
    scene.kinds.resize(1);
    return scene;
}

std::vector<DriveFrame> drive(const Scene& scene, const Options& options) {
    const std::uint32_t count = options.frameCount().value_or(defaultFrames);
    vehicles::Traffic traffic = startTraffic(scene, options.seed, options.cars.front());
    CameraRig camera(scene.city.tour, scene.city.bounds);
    ShotPlan shots(options.camera, scene.kinds);
    Progress progress("drive", count, options.quiet);
    std::vector<DriveFrame> frames;
    const double start = traffic.time();
    for (std::uint32_t frame = 0; frame < count && !interrupted(); ++frame) {
        const double time = static_cast<double>(frame) / options.fps;
        while (traffic.time() < start + time) traffic.step();
        shots.direct(time, traffic.poses(), camera);
        camera.update(frame == 0 ? 0 : 1.0 / options.fps, traffic.poses(), {});
        frames.push_back({camera.pose(), {traffic.poses().begin(), traffic.poses().end()}});
        progress.advance();
    }
    return frames;
}

int run(const Options& options) {
    if (!options.exportCity && !options.exportCar && !options.exportDrive) {
        std::cerr << "mirrorstreet export: nothing to write; name at least one of --city FILE.glb, --car "
                     "FILE.glb, --drive FILE.json\n";
        return exitUsage;
    }
    const Scene scene = sceneOfOneModel(options);
    const auto say = [](const std::filesystem::path& file) { std::cout << file.string() << std::endl; };
    if (options.exportCity) {
        exportCity(scene.city, *options.exportCity);
        say(*options.exportCity);
    }
    if (options.exportCar) {
        exportVehicle(scene.models.front(), *options.exportCar);
        say(*options.exportCar);
    }
    if (options.exportDrive) {
        const std::vector<DriveFrame> frames = drive(scene, options);
        if (interrupted()) {
            spdlog::warn("interrupted: the drive is not written");
            return exitFailed;
        }
        exportDrive(frames, fovYDegrees, options.resolution, options.fps, *options.exportDrive);
        say(*options.exportDrive);
    }
    return exitOk;
}

}  // namespace

Command exportCommand() {
    return {.name = "export",
            .summary = "city, car and drive for any other engine: glTF and JSON",
            .groups = cityOptions | trafficOptions | pictureOptions | durationOptions | exportOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
