#include "app/frame/ReflectionEngine.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "app/frame/MirroredVehicle.h"
#include "app/frame/SkyMaps.h"
#include "app/frame/StandingMaps.h"
#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleShading.h"
#include "app/raytrace/RayTracer.h"
#include "reflection/gl/LocalMapAtlas.h"
#include "reflection/gl/LocalMapPass.h"
#include "reflection/gl/ScreenLight.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/local_map/MovingObjects.h"
#include "reflection/local_map/PackedMips.h"
#include "reflection/reference_maps/Selection.h"

namespace app {

namespace {

reflection::LocalMapMethod localMethod(const ReflectionSettings& settings) {
    switch (settings.method) {
        case ReflectionMethod::box:
            return reflection::LocalMapMethod::box;
        case ReflectionMethod::mem:
            return settings.variant == MemVariant::paper ? reflection::LocalMapMethod::memPaper
                                                         : reflection::LocalMapMethod::mem;
        default:
            return reflection::LocalMapMethod::blend;
    }
}

/// Share of its vehicle's motion by which a map ages that is looked up with parallax. Measured with 10 and 30
/// moving cars: from 1 to 0.25, a third of the maps, and nothing lost (FLIP 0.0342 and 0.0343); at 0 as
/// little. But what the old centre did not see comes into view with the motion, so that maps must age.
constexpr float parallaxMotion = 0.25f;

/// No building throws its shadow farther, metres: 300 m high at a sun 10 degrees over the horizon.
constexpr double sunRange = 1700;

}  // namespace

ReflectionDetail detailOf(const ReflectionSettings& settings) {
    return settings.detail ? *settings.detail : detailOf(settings.quality);
}

PlanOptions planOptionsFor(const ReflectionSettings& settings) {
    const ReflectionDetail detail = detailOf(settings);
    PlanOptions options;
    options.texelBudget = static_cast<std::uint64_t>(std::max(detail.texelBudget, 0.0));
    options.texelsPerPixel = static_cast<float>(detail.texelsPerPixel);
    options.errorThreshold = static_cast<float>(detail.errorThreshold);
    options.share = settings.shareMaps;
    if (parallaxIn(settings)) options.ownMotion = parallaxMotion;
    options.mapsInTurn = settings.mapsInTurn;
    options.sizeClass = settings.sizeClass;
    // The paper rebuilds every visible vehicle's map every frame; re-rendering is the yardstick and does so
    // too, unless it is to take turns.
    options.everyFrame = settings.everyFrame ||
                         (settings.method == ReflectionMethod::rerender && settings.mapsInTurn == 0) ||
                         (settings.method == ReflectionMethod::mem && settings.variant == MemVariant::paper);
    return options;
}

std::size_t candidateCount(const ReflectionSettings& settings) {
    if (settings.method != ReflectionMethod::mem || settings.variant == MemVariant::paper) return 2;
    return static_cast<std::size_t>(std::max(1.0, std::round(detailOf(settings).candidates)));
}

reflection::LocalMapRequest requestFor(const ReflectionSettings& settings, int faceSize) {
    reflection::LocalMapRequest request;
    request.method = localMethod(settings);
    request.faceSize = faceSize;
    if (request.method == reflection::LocalMapMethod::memPaper) {
        // Section 4.4: 10 x 10, divided down to the size of a texel at most; R is not given in the paper: 0.5
        // divides at a change of scale of one half.
        request.mesh = {10, 0, reflection::RefineCriterion::depthRatio, 0.5f};
        while ((10 << (request.mesh.depth + 1)) <= faceSize) ++request.mesh.depth;
    } else {
        // Measured over ten places: a ray for every texel at edges and half the tolerance cost three times
        // the rays for 0.1 dB, since the lookups refine what the mesh leaves.
        request.mesh.baseCells = std::max(1, faceSize / 16);
        request.mesh.depth = faceSize >= 16 ? 3 : 0;
        request.mesh.threshold = 0.1f;
        request.lookup.lookups = static_cast<int>(std::max(1.0, std::round(detailOf(settings).lookups)));
    }
    return request;
}

bool parallaxIn(const ReflectionSettings& settings) {
    return settings.parallax && settings.method == ReflectionMethod::mem &&
           settings.variant == MemVariant::ours;
}

struct ReflectionEngine::Impl {
    Impl(const reflection::GridTracer& gridTracer, std::span<const reflection::PackedReferenceMap> allMaps,
         std::span<const vehicles::VehicleModel> allModels, const ReflectionSettings& wanted)
        : tracer(gridTracer), maps(allMaps), models(allModels), settings(wanted) {}

    const reflection::GridTracer& tracer;
    std::span<const reflection::PackedReferenceMap> maps;
    std::span<const vehicles::VehicleModel> models;
    std::vector<float> centreHeights;
    std::vector<MirroredVehicle> mirroredVehicles;  ///< one a model, made when first needed
    ReflectionSettings settings;
    ReflectionPlanner planner;
    ReflectionPlan plan;
    ReflectionCounters counters;
    reflection::LocalMapAtlas atlas;
    SkyMaps skyMaps;
    bool fixedMapBuilt = false;
    bool software = reflection::softwareRenderer();
    std::unique_ptr<reflection::LocalMapPass> gpu;  ///< made when first needed
    Lighting gpuLighting;                           ///< of the skies that it has

    struct Scratch {
        reflection::LocalMapBuilder builder;
    };
    tbb::enumerable_thread_specific<Scratch> scratch;
    std::vector<reflection::LocalMap> built;
    std::vector<reflection::PackedMips> packed;
    std::vector<reflection::LocalMapRequest> requests;
    std::vector<std::vector<reflection::Candidate>> candidates;
    std::vector<std::vector<reflection::MovingObject>> neighbours;

    StandingMaps standingMaps;

    bool onGpu() const {
        return settings.method == ReflectionMethod::mem && settings.variant == MemVariant::ours &&
               (settings.mapsOn == MapsOn::gpu || (settings.mapsOn == MapsOn::automatic && !software));
    }
    void countReferenceMaps();
    void forget() {
        planner.reset();
        standingMaps.forget();
        fixedMapBuilt = false;
    }
    void buildMaps(const FrameScene& scene, std::span<const MapJob> jobs);
    void buildOnGpu(const FrameScene& scene, std::span<const MapJob> jobs);
    void gatherNeighbours(const FrameScene& scene, const MapJob& job, int faceSize,
                          std::vector<reflection::MovingObject>& out);
    MirroredVehicle::SunAt sunOn(const FrameScene& scene, const vehicles::VehiclePose& pose) const;
    void buildFixedMap();

    RayTracer* rayTracer = nullptr;
    std::function<std::shared_ptr<const SunMap>()> sunMap;
    Lighting raysLighting;
    bool sunKnown = false;
    std::vector<std::uint32_t> mirrors;  ///< vehicles that were seen
    MirroredLight mirrored;
    reflection::ScreenLight screen;
    void prepareRays(const FrameScene& scene, std::span<const SeenVehicle> seen);
};

ReflectionEngine::ReflectionEngine(const reflection::GridTracer& tracer,
                                   std::span<const reflection::PackedReferenceMap> maps,
                                   std::span<const vehicles::VehicleModel> models,
                                   const ReflectionSettings& settings)
    : impl_(std::make_unique<Impl>(tracer, maps, models, settings)) {
    for (const vehicles::VehicleModel& model : models)
        impl_->centreHeights.push_back(model.reflectionCentre * model.height);
    impl_->countReferenceMaps();
}

ReflectionEngine::~ReflectionEngine() = default;

void ReflectionEngine::configure(const ReflectionSettings& settings) {
    if (settings.method != impl_->settings.method || settings.variant != impl_->settings.variant)
        impl_->forget();
    if (settings.gpuMapBytes != impl_->settings.gpuMapBytes) impl_->gpu.reset();
    impl_->settings = settings;
    if (!impl_->onGpu()) impl_->gpu.reset();
}

const ReflectionSettings& ReflectionEngine::settings() const {
    return impl_->settings;
}

void ReflectionEngine::keepDistances() {
    impl_->atlas.keepNearness();
    impl_->forget();
}

reflection::LocalMapTextures ReflectionEngine::textures() const {
    reflection::LocalMapTextures textures = impl_->atlas.textures();
    if (!parallaxIn(impl_->settings)) textures.nearnessArrays = {};
    return textures;
}
reflection::PackedMips ReflectionEngine::mapIn(reflection::LocalMapSlot slot) const {
    reflection::PackedMips mips;
    impl_->atlas.download(slot, mips);
    return mips;
}
const ReflectionCounters& ReflectionEngine::counters() const {
    return impl_->counters;
}

void ReflectionEngine::Impl::countReferenceMaps() {
    counters.referenceMapBytes = 0;
    std::size_t texels = 0;
    for (const reflection::PackedReferenceMap& map : maps) {
        counters.referenceMapBytes += map.bytes();
        texels += map.texelCount();
    }
    counters.referenceBytesPerTexel =
        texels == 0 ? 0 : static_cast<double>(counters.referenceMapBytes) / static_cast<double>(texels);
}

void ReflectionEngine::Impl::buildOnGpu(const FrameScene& scene, std::span<const MapJob> jobs) {
    if (!(gpuLighting == scene.lighting)) gpu->forgetSkies();
    gpuLighting = scene.lighting;
    std::vector<reflection::LocalMapJob> wanted(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) wanted[i] = {jobs[i].slot, requests[i], neighbours[i]};
    counters.rays = gpu->build(tracer, wanted, atlas);
    for (const MapJob& job : jobs) atlas.setCentre(job.slot, job.centre);
}

void ReflectionEngine::Impl::buildMaps(const FrameScene& scene, std::span<const MapJob> jobs) {
    built.resize(std::max(built.size(), jobs.size()));
    packed.resize(std::max(packed.size(), jobs.size()));
    requests.resize(jobs.size());
    candidates.resize(jobs.size());
    neighbours.resize(std::max(neighbours.size(), jobs.size()));
    std::array<const reflection::LocalMap*, reflection::localMapFaceSizes.size()> skies{};
    for (const MapJob& job : jobs) {
        const auto size = static_cast<std::size_t>(job.slot.sizeClass);
        skies[size] = &skyMaps.of(scene.lighting, reflection::localMapFaceSizes[size]);
    }
    if (settings.vehiclesInMaps && mirroredVehicles.empty())
        for (const vehicles::VehicleModel& model : models) mirroredVehicles.emplace_back(model);
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
        const int faceSize = reflection::localMapFaceSizes[static_cast<std::size_t>(jobs[i].slot.sizeClass)];
        reflection::LocalMapRequest request = requestFor(settings, faceSize);
        request.centre = jobs[i].centre;
        candidates[i] =
            request.method == reflection::LocalMapMethod::mem
                ? reflection::selectCandidates(maps, request.centre, tracer, candidateCount(settings))
                : reflection::selectNearestTwo(maps, request.centre);
        request.candidates = candidates[i];
        request.lookup.sky = skies[static_cast<std::size_t>(jobs[i].slot.sizeClass)];
        const double heading = scene.vehicles[jobs[i].vehicle].heading;
        request.streetDirection = {std::cos(heading), std::sin(heading), 0};
        requests[i] = request;
        neighbours[i].clear();
        if (settings.vehiclesInMaps) gatherNeighbours(scene, jobs[i], faceSize, neighbours[i]);
    });
    if (onGpu()) {
        if (!gpu) gpu = std::make_unique<reflection::LocalMapPass>(maps, settings.gpuMapBytes);
        if (gpu->usable()) {
            buildOnGpu(scene, jobs);
            return;
        }
    }
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        built[i].resize(requests[i].faceSize);
        packed[i].resize(requests[i].faceSize);
    }
    std::vector<StandingMaps::Kept*> kept(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i)
        if (const std::uint32_t id = scene.vehicles[jobs[i].vehicle].id; id >= firstStandingId)
            kept[i] = &standingMaps.of(id, scene.lighting, requests[i]);
    std::atomic<std::uint64_t> rays{0};
    tbb::parallel_for(std::size_t{0}, 6 * jobs.size(), [&](std::size_t k) {
        const int face = static_cast<int>(k % 6);
        StandingMaps::Kept* known = kept[k / 6];
        if (known == nullptr || !known->give(face, built[k / 6])) {
            rays += scratch.local().builder.buildFace(tracer, requests[k / 6], face, built[k / 6]);
            if (known != nullptr) known->keep(face, built[k / 6]);
        }
        reflection::drawMovingObjects(neighbours[k / 6], face, built[k / 6]);
        reflection::packFaceMips(built[k / 6], face, packed[k / 6]);
    });
    counters.rays = rays;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        atlas.upload(jobs[i].slot, packed[i]);
        atlas.setCentre(jobs[i].slot, jobs[i].centre);
    }
}

MirroredVehicle::SunAt ReflectionEngine::Impl::sunOn(const FrameScene& scene,
                                                     const vehicles::VehiclePose& pose) const {
    const vehicles::VehicleModel& model = models[pose.model];
    const glm::dvec3 towardsSun = glm::dvec3(scene.lighting.sunDirection) * sunRange;
    const auto lit = [this, towardsSun](const glm::dvec3& point) {
        return tracer.occluded(glm::vec3(point), glm::vec3(point + towardsSun)) ? 0.0f : 1.0f;
    };
    // Where the four corners of the roof agree, all of it is taken to.
    const glm::mat3 rotation = worldFromVehicle(pose);
    float sum = 0;
    for (const float x : {-0.5f, 0.5f})
        for (const float y : {-0.5f, 0.5f})
            sum += lit(pose.position +
                       glm::dvec3(rotation * glm::vec3(x * model.length, y * model.width, model.height)));
    if (sum == 0) return [](const glm::dvec3&) { return 0.0f; };
    if (sum == 4) return [](const glm::dvec3&) { return 1.0f; };
    return lit;
}

void ReflectionEngine::Impl::gatherNeighbours(const FrameScene& scene, const MapJob& job, int faceSize,
                                              std::vector<reflection::MovingObject>& out) {
    struct Near {
        double squared;
        std::uint32_t index;
    };
    std::vector<Near> near;
    for (std::uint32_t i = 0; i < scene.vehicles.size(); ++i) {
        const vehicles::VehiclePose& pose = scene.vehicles[i];
        if (i == job.vehicle || pose.model >= models.size()) continue;
        const glm::dvec3 apart = pose.position - job.centre;
        // Fewer than eight texels across (a face spans pi / 2): a blot on a body panel.
        const double size = std::max(models[pose.model].length, models[pose.model].height);
        const double range = size * faceSize / (8 * std::numbers::pi / 2);
        const double squared = glm::dot(apart, apart);
        if (squared <= range * range) near.push_back({squared, i});
    }
    // In a jam the nearest hide the rest.
    constexpr std::size_t mostNeighbours = 12;
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
        return a.squared != b.squared ? a.squared < b.squared : a.index < b.index;
    });
    near.resize(std::min(near.size(), mostNeighbours));
    std::erase_if(near, [&](const Near& other) {
        const vehicles::VehiclePose& pose = scene.vehicles[other.index];
        const vehicles::VehicleModel& model = models[pose.model];
        return tracer.occluded(glm::vec3(job.centre),
                               glm::vec3(pose.position + glm::dvec3(0, 0, model.height)), model.length);
    });
    out.resize(near.size());
    // A frame may have one map to build: its neighbours must not wait for one core.
    tbb::parallel_for(std::size_t{0}, near.size(), [&](std::size_t i) {
        const vehicles::VehiclePose& pose = scene.vehicles[near[i].index];
        // Four texels where the vehicle is nearest to the map's centre: one costs more, and was measured to
        // gain nothing.
        const double nearest = std::max(std::sqrt(near[i].squared) - 0.5 * models[pose.model].length, 1.0);
        const double allowed = 4 * nearest * (std::numbers::pi / 2) / faceSize;
        mirroredVehicles[pose.model].shade(pose, scene.lighting, job.centre, static_cast<float>(allowed),
                                           sunOn(scene, pose), out[i]);
    });
}

void ReflectionEngine::Impl::buildFixedMap() {
    if (fixedMapBuilt || maps.empty()) return;
    // The map that sees most of the city (placement puts it first) stands for all.
    reflection::LocalMapRequest request;
    request.method = reflection::LocalMapMethod::blend;
    request.faceSize = reflection::localMapFaceSizes[0];
    request.centre = maps.front().position();
    const std::vector<reflection::Candidate> one{{&maps.front(), glm::vec3(0)}};
    request.candidates = one;
    reflection::LocalMap map;
    map.resize(request.faceSize);
    for (int face = 0; face < 6; ++face) scratch.local().builder.buildFace(tracer, request, face, map);
    reflection::PackedMips mips;
    reflection::packMips(map, mips);
    atlas.reserve(0, 1);
    atlas.upload({0, 0}, mips);
    fixedMapBuilt = true;
}

const ReflectionPlan& ReflectionEngine::update(const FrameScene& scene, std::span<const SeenVehicle> seen,
                                               reflection::SceneDrawer& drawer) {
    const auto start = std::chrono::steady_clock::now();
    Impl& engine = *impl_;
    engine.counters.rays = 0;
    engine.counters.mirrorPixels = 0;
    if (engine.settings.method == ReflectionMethod::none) {
        engine.plan = {};
    } else if (engine.settings.method == ReflectionMethod::raytrace) {
        engine.plan = {};
        engine.plan.visible = static_cast<std::uint32_t>(seen.size());
        engine.prepareRays(scene, seen);
    } else if (engine.settings.method == ReflectionMethod::fixed) {
        engine.plan = {};
        engine.plan.visible = static_cast<std::uint32_t>(seen.size());
        if (!seen.empty()) engine.buildFixedMap();
        engine.plan.slots.resize(scene.vehicles.size());
        if (engine.fixedMapBuilt)
            for (const SeenVehicle& vehicle : seen) engine.plan.slots[vehicle.index] = {0, 0};
    } else {
        if (parallaxIn(engine.settings) && !engine.atlas.keepsNearness()) {
            engine.atlas.keepNearness();
            engine.forget();
        }
        engine.plan = engine.planner.plan(scene, seen, engine.centreHeights, planOptionsFor(engine.settings));
        for (std::size_t c = 0; c < engine.planner.layersNeeded().size(); ++c)
            engine.atlas.reserve(static_cast<int>(c), engine.planner.layersNeeded()[c]);
        if (engine.settings.method == ReflectionMethod::rerender) {
            for (const MapJob& job : engine.plan.jobs) {
                reflection::CubeContent content;
                content.vehicles = engine.settings.vehiclesInMaps;
                content.excludedVehicle = scene.vehicles[job.vehicle].id;
                drawer.drawCube(job.centre, engine.atlas.target(job.slot), content);
                engine.atlas.finishDrawn(job.slot);
                engine.atlas.setCentre(job.slot, job.centre);
            }
        } else {
            engine.buildMaps(scene, engine.plan.jobs);
        }
    }
    engine.counters.visible = engine.plan.visible;
    engine.counters.rebuilt = static_cast<std::uint32_t>(engine.plan.jobs.size());
    engine.counters.fresh = engine.plan.fresh;
    engine.counters.shared = engine.plan.shared;
    engine.counters.postponed = engine.plan.postponed;
    engine.counters.texels = engine.plan.texels;
    engine.counters.localMapBytes = engine.atlas.bytes() + (engine.gpu ? engine.gpu->skyBytes() : 0);
    engine.counters.referenceMapGpuBytes = engine.gpu ? engine.gpu->bytes() : 0;
    engine.counters.milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return engine.plan;
}

void ReflectionEngine::Impl::prepareRays(const FrameScene& scene, std::span<const SeenVehicle> seen) {
    mirrors.clear();
    if (rayTracer == nullptr || seen.empty()) return;
    for (const SeenVehicle& vehicle : seen) mirrors.push_back(vehicle.index);
    if (!sunKnown || !(raysLighting == scene.lighting)) {
        rayTracer->useSunMap(sunMap ? sunMap() : nullptr);
        raysLighting = scene.lighting;
        sunKnown = true;
    }
    rayTracer->prepare(scene);
}

void ReflectionEngine::useRayTracer(RayTracer* tracer,
                                    std::function<std::shared_ptr<const SunMap>()> sunMap) {
    impl_->rayTracer = tracer;
    impl_->sunMap = std::move(sunMap);
    impl_->sunKnown = false;
}

std::uint32_t ReflectionEngine::mirroredIn(const View& view) {
    Impl& engine = *impl_;
    if (engine.settings.method != ReflectionMethod::raytrace || engine.rayTracer == nullptr ||
        engine.mirrors.empty())
        return 0;
    const auto start = std::chrono::steady_clock::now();
    TraceOptions options;
    options.wet = engine.settings.wet;
    engine.rayTracer->mirrored(view, engine.mirrors, options, engine.mirrored);
    engine.screen.upload(engine.mirrored.radiance, engine.mirrored.size, engine.mirrored.low,
                         engine.mirrored.high);
    engine.counters.rays += engine.mirrored.rays;
    engine.counters.mirrorPixels += engine.mirrored.pixels;
    engine.counters.milliseconds +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return engine.screen.name();
}

std::vector<reflection::LocalMapMesh::Quad> ReflectionEngine::meshOf(const glm::dvec3& centre, int face,
                                                                     int faceSize, int& latticeSize) const {
    reflection::LocalMapMesh mesh;
    mesh.build(impl_->tracer, glm::vec3(centre), face, requestFor(impl_->settings, faceSize).mesh);
    latticeSize = mesh.latticeSize();
    return {mesh.quads().begin(), mesh.quads().end()};
}

}  // namespace app
