#include "app/stability/DrawingCampaign.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/Lighting.h"
#include "app/frame/ReflectionEngine.h"
#include "app/render/Readback.h"
#include "app/render/SceneRenderer.h"
#include "app/stability/SeededRandom.h"
#include "city/generate/PaperCity.h"
#include "city/model/CityHeightfield.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "vehicles/models/Fleet.h"

namespace app::stability {

namespace {

/// A grey map, so that no baking is needed: what is drawn in it is not judged here.
reflection::PackedReferenceMap greyMap(const glm::dvec3& position) {
    reflection::ReferenceMap map;
    map.position = position;
    map.faceSize = 32;
    map.colour.assign(map.texelCount(), glm::vec3(0.5f));
    map.distance.assign(map.texelCount(), 20.0f);
    return {map, 8.0f};
}

struct Stage {
    city::CityModel city = city::generatePaperCity();
    std::vector<vehicles::VehicleModel> models = vehicles::builtInFleet();
    reflection::GridTracer tracer{city::cityHeightfield(city, 2)};
    std::vector<reflection::PackedReferenceMap> maps;
    glm::dvec3 start{0};  ///< on a lane
    glm::dvec3 ahead{1, 0, 0};

    Stage() {
        const auto& line = city.roads.lanes.at(city.roads.lanes.size() / 2).centreLine;
        start = line.front();
        ahead = glm::normalize(glm::dvec3(line.at(1)) - start);
        maps.push_back(greyMap(start + glm::dvec3(0, 0, 2.5)));
        maps.push_back(greyMap(start + 20.0 * ahead + glm::dvec3(0, 0, 2.5)));
    }

    /// Vehicles on a lattice around the start, 6 m apart: far more than there are streets for.
    FrameScene crowd(std::uint32_t cars) const {
        FrameScene scene;
        scene.lighting = lightingAt(15);
        scene.signalColours.assign(city.signalHeads.size(), vehicles::SignalColour::red);
        const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(cars))));
        for (std::uint32_t k = 0; k < cars; ++k) {
            vehicles::VehiclePose pose;
            pose.id = k;
            pose.model = k % static_cast<std::uint32_t>(models.size());
            pose.position =
                start + glm::dvec3(6.0 * (k % side) - 3.0 * side, 6.0 * (k / side) - 3.0 * side, 0);
            pose.heading = 0.1 * k;
            scene.vehicles.push_back(pose);
        }
        return scene;
    }
};

/// Draws a frame with its reflections. The share of pixels that are neither black nor transparent.
double drawnShare(const Stage& stage, const FrameScene& scene, glm::ivec2 size, Quality quality,
                  Antialiasing antialiasing) {
    SceneRenderer renderer(stage.city, stage.models, {antialiasing, quality != Quality::low, true});
    ReflectionSettings settings;
    settings.quality = quality;
    ReflectionEngine engine(stage.tracer, stage.maps, stage.models, settings);
    const OffscreenTarget target(size);
    const View view = lookAt(stage.start - 6.0 * stage.ahead + glm::dvec3(0, 0, 2),
                             stage.start + 10.0 * stage.ahead, std::numbers::pi / 3, size);
    FrameScene frame = scene;
    frame.views = {view};
    for (int k = 0; k < 2; ++k) {
        frame.time = k / 60.0;
        renderer.prepare(frame);
        std::vector<SeenVehicle> seen;
        for (const auto& v : renderer.visibleVehicles(view)) seen.push_back({v.index, v.diameterPixels});
        const ReflectionPlan& plan = engine.update(frame, seen, renderer);
        renderer.drawView(view, {engine.textures(), plan.slots}, target.framebuffer());
    }
    const Image8 image = readPixels(target.framebuffer(), size);
    std::size_t drawn = 0;
    for (std::size_t k = 0; k < image.rgba.size(); k += 4)
        drawn += image.rgba[k] + image.rgba[k + 1] + image.rgba[k + 2] > 0 ? 1 : 0;
    return static_cast<double>(drawn) / static_cast<double>(image.rgba.size() / 4);
}

}  // namespace

std::vector<Row> tryDrawing(const Options& options) {
    std::vector<Row> rows;
    const OffscreenContext context;
    const reflection::gl::DebugOutput debug;
    const Stage stage;
    const auto row = [&](const std::string& what, const FrameScene& scene, glm::ivec2 size, Quality quality,
                         Antialiasing antialiasing, double share) {
        if (options.stop()) return;
        const std::size_t errors = debug.errors().size();
        const double drawn = drawnShare(stage, scene, size, quality, antialiasing);
        Row result{"drawing",
                   what,
                   2,
                   0,
                   1 - drawn,
                   0.01,
                   "of the pixels left black",
                   "sky and street are nowhere black; no OpenGL error",
                   ""};
        const std::vector<std::string> now = debug.errors();
        result.failures = now.size() - errors;
        if (now.size() > errors) result.example = now[errors];
        rows.push_back(result);
        options.tell(share);
    };
    const FrameScene some = stage.crowd(40);
    for (const auto& [name, quality, antialiasing] :
         {std::tuple{"low quality, no antialiasing", Quality::low, Antialiasing::none},
          std::tuple{"high quality, 4 samples", Quality::high, Antialiasing::msaa4}}) {
        row(std::string("1x1, ") + name, some, {1, 1}, quality, antialiasing, 0.2);
        row(std::string("16384x16, ") + name, some, {16384, 16}, quality, antialiasing, 0.3);
        row(std::string("16x16384, ") + name, some, {16, 16384}, quality, antialiasing, 0.4);
    }
    row("no car", stage.crowd(0), {320, 180}, Quality::medium, Antialiasing::fxaa, 0.5);
    row("100,000 cars", stage.crowd(100'000), {320, 180}, Quality::medium, Antialiasing::fxaa, 1);
    return rows;
}

}  // namespace app::stability
