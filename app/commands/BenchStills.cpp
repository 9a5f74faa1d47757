#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "app/commands/Benches.h"
#include "app/commands/CityTriangles.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/PreparedScene.h"
#include "app/commands/ReflectionSource.h"
#include "app/commands/Version.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/ReflectionEngine.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

struct Shot {
    std::uint32_t vehicle = 0;
    View view;
};

/// Looks at a vehicle from in front and beside it, at a driver's height.
View viewOf(const vehicles::VehiclePose& pose, double distance, glm::ivec2 size) {
    const double angle = pose.heading + glm::radians(38.0);
    const glm::dvec3 middle = pose.position + glm::dvec3(0, 0, 0.7);
    // Distances are to the body: half a car's length from its middle.
    const glm::dvec3 eye =
        middle + (distance + 2.0) * glm::dvec3(std::cos(angle), std::sin(angle), 0) + glm::dvec3(0, 0, 0.9);
    // Farther cars are seen through a longer lens, so that their paint can be judged in the picture.
    const double fov = distance < 5 ? 50 : distance < 20 ? 26 : 9;
    return lookAt(eye, middle, glm::radians(fov), size);
}

/// The share of a vehicle's near side that is seen from the eye, past all that stands in the city.
float seenShare(const reflection::TriangleTracer& triangles, const glm::dvec3& eye,
                const vehicles::VehiclePose& pose) {
    constexpr float halfLength = 2.6f;  // metres; what is nearer to its middle is behind its side
    const glm::vec3 forward(std::cos(pose.heading), std::sin(pose.heading), 0);
    std::vector<float> x, y, z;
    for (int step = -12; step <= 12; ++step)  // closer together than a pole is wide
        for (const float height : {0.3f, 0.7f, 1.2f}) {
            const float along = 0.15f * static_cast<float>(step);
            const glm::vec3 d = glm::vec3(pose.position - eye) + along * forward + glm::vec3(0, 0, height);
            x.push_back(d.x);
            y.push_back(d.y);
            z.push_back(d.z);
        }
    std::vector<float> t(x.size());
    triangles.traceFan(glm::vec3(eye), x, y, z, t);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < t.size(); ++i)
        seen += (1 - t[i]) * glm::length(glm::vec3(x[i], y[i], z[i])) < halfLength ? 1 : 0;
    return static_cast<float>(seen) / static_cast<float>(t.size());
}

/// The vehicle that is seen best from that distance: nothing of the city between, and dark paint, which shows
/// reflections.
Shot chooseShot(const FrameScene& scene, const reflection::TriangleTracer& triangles, double distance,
                glm::ivec2 size) {
    Shot best;
    float bestScore = -std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < scene.vehicles.size(); ++i) {
        const vehicles::VehiclePose& pose = scene.vehicles[i];
        if (pose.model > 1) continue;  // hatchbacks and saloons
        const View view = viewOf(pose, distance, size);
        // Nobody else near the line of sight.
        float room = 10;
        for (const vehicles::VehiclePose& other : scene.vehicles) {
            if (other.id == pose.id) continue;
            const glm::dvec3 towards = glm::normalize(pose.position - view.eye);
            const double along = glm::dot(other.position - view.eye, towards);
            if (along < -3 || along > distance + 2) continue;
            room =
                std::min(room, static_cast<float>(glm::length(other.position - view.eye - along * towards)));
        }
        const float brightness = (pose.paint.r + pose.paint.g + pose.paint.b) / 3;
        const float score =
            300 * seenShare(triangles, view.eye, pose) + std::min(room, 4.0f) * 5 - brightness * 6;
        if (score > bestScore) {
            bestScore = score;
            best = {i, view};
        }
    }
    return best;
}

/// What the pictures of a city are called: its name, or its file's up to the first dot.
std::string pictureName(const std::string& city) {
    const std::string file = std::filesystem::path(city).filename().string();
    const std::size_t dot = file.find('.', 1);
    return file.substr(0, dot);
}

}  // namespace

int benchStills(const Options& options) {
    const std::string name = pictureName(options.city);
    requireWritable(options.out / (name + ".png"));
    RenderOptions rendering;
    rendering.antialiasing = Antialiasing::msaa4;
    PreparedScene stage(options, rendering);
    const Scene& scene = stage.scene;
    SceneRenderer& renderer = stage.renderer;
    const PreparedReflections& prepared = stage.reflections;
    ResultFile results("stills", std::string(programVersion), stage.context.renderer());
    std::vector<std::vector<std::string>> table{{"picture", "PSNR dB", "FLIP"}};
    if (!prepared.complete) return reportBench(options, results, table);

    reflection::TriangleTracer triangles;
    addCity(triangles, scene.city);
    triangles.commit();
    const vehicles::Traffic traffic = startTraffic(scene, options.seed, options.cars.front());
    const OffscreenTarget target(options.resolution);
    MirrorMask mirrors;
    RayTracer rays(scene.city, scene.models);
    // The truth comes first: the others are compared with it.
    const std::vector<std::pair<std::string, std::optional<ReflectionMethod>>> methods{
        {"truth", std::nullopt},
        {"none", ReflectionMethod::none},
        {"static", ReflectionMethod::fixed},
        {"box", ReflectionMethod::box},
        {"mem", ReflectionMethod::mem},
        {"rerender", ReflectionMethod::rerender}};
    for (const int distance : {3, 10, 40}) {
        FrameScene frame = assembleFrame(scene.city, traffic, scene.lighting, {}, scene.staged);
        if (frame.vehicles.empty()) {
            spdlog::error("the city has no vehicles to look at; ask for some with --cars");
            return exitFailed;
        }
        const Shot shot = chooseShot(frame, triangles, distance, options.resolution);
        frame.views = {shot.view};
        renderer.prepare(frame);
        std::vector<SeenVehicle> seen;
        for (const auto& v : renderer.visibleVehicles(shot.view)) seen.push_back({v.index, v.diameterPixels});
        const std::vector<unsigned char> mask = mirrors.of(renderer, frame, target);
        std::vector<glm::vec3> truth;
        for (const auto& [methodName, method] : methods) {
            if (interrupted()) return reportBench(options, results, table);
            ReflectionSettings settings;
            settings.method = method.value_or(ReflectionMethod::none);
            settings.variant = options.mem;
            settings.quality = options.quality;
            settings.everyFrame = true;
            const std::unique_ptr<ReflectionSource> source =
                method ? engineSource(scene, prepared, settings, rays) : tracedTruth(rays);
            renderer.prepare(frame);
            source->beginFrame(frame, seen, renderer);
            renderer.drawView(shot.view, source->forView(shot.view, renderer), target.framebuffer());
            const Image8 image = readPixels(target.framebuffer(), target.size());
            const std::string file = name + "_" + std::to_string(distance) + "m_" + methodName + ".png";
            writePng({image.size.x, image.size.y, image.rgba}, options.out / file);
            const std::vector<glm::vec3> pixels = toFloat(image);
            if (!method) truth = pixels;
            const int w = image.size.x, h = image.size.y;
            const double psnr = reflection::psnr({w, h, pixels}, {w, h, truth}, mask);
            const double flip = reflection::meanError(reflection::flip({w, h, pixels}, {w, h, truth}), mask);
            results.add({{"method", methodName},
                         {"city", options.city},
                         {"distance_m", distance},
                         {"psnr_db", psnr},
                         {"mean_flip", flip}});
            table.push_back({file, fixed(psnr, 1), fixed(flip, 4)});
        }
    }
    return reportBench(options, results, table);
}

}  // namespace app
