#include "app/commands/ReflectionSource.h"

#include <glm/geometric.hpp>

#include "reflection/gl/ScreenLight.h"
#include "reflection/local_map/PackedMips.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace app {

namespace {

class EngineSource final : public ReflectionSource {
  public:
    EngineSource(const Scene& scene, const PreparedReflections& prepared, const ReflectionSettings& settings,
                 RayTracer& rays)
        : engine_(*prepared.tracer, prepared.maps, scene.models, settings), prepared_(prepared), rays_(rays) {
        if (settings.method == ReflectionMethod::mem) engine_.keepDistances();
    }

    void beginFrame(const FrameScene& scene, std::span<const SeenVehicle> seen,
                    SceneRenderer& renderer) override {
        if (engine_.settings().method == ReflectionMethod::none) return;
        if (engine_.settings().method == ReflectionMethod::raytrace && !lent_) {
            // Once: every time, the sun's shadows are read back.
            engine_.useRayTracer(&rays_, [&renderer] { return renderer.sunMap(); });
            lent_ = true;
        }
        slots_ = engine_.update(scene, seen, renderer).slots;
    }
    VehicleReflections forView(const View& view, const SceneRenderer&) override {
        VehicleReflections reflections;
        if (engine_.settings().method == ReflectionMethod::none) return reflections;
        reflections.textures = engine_.textures();
        reflections.slots = slots_;
        reflections.mirrored = engine_.mirroredIn(view);
        return reflections;
    }
    bool keepsMaps() const override {
        const ReflectionMethod method = engine_.settings().method;
        return method != ReflectionMethod::none && method != ReflectionMethod::fixed &&
               method != ReflectionMethod::raytrace && !planOptionsFor(engine_.settings()).everyFrame;
    }
    double mapsRebuilt() const override { return engine_.counters().rebuilt; }
    std::optional<ShownMap> shownMap(const FrameScene& scene, std::uint32_t vehicle) override;
    std::size_t textureBytes() const override {
        return engine_.counters().localMapBytes + engine_.counters().referenceMapGpuBytes;
    }

  private:
    ReflectionEngine engine_;
    const PreparedReflections& prepared_;
    RayTracer& rays_;
    reflection::LocalMap shown_;  ///< distances alone
    bool lent_ = false;
    std::vector<reflection::LocalMapSlot> slots_;
};

/// Distances from a centre as a local map keeps them: along the texels' cube directions.
template <class DistanceAt>
void fillDepths(int faceSize, const DistanceAt& distanceAt, reflection::LocalMap& map) {
    map.resize(faceSize);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < faceSize; ++y)
            for (int x = 0; x < faceSize; ++x) {
                const glm::vec3 direction = reflection::cubeDirection(face, glm::vec2(x, y) + 0.5f, faceSize);
                map.depth[map.faceOffset(face) + static_cast<std::size_t>(y * faceSize + x)] =
                    distanceAt(face, x, y) / glm::length(direction);
            }
}

std::optional<ShownMap> EngineSource::shownMap(const FrameScene& scene, std::uint32_t vehicle) {
    if (vehicle >= slots_.size() || !slots_[vehicle].valid()) return std::nullopt;
    const reflection::LocalMapSlot slot = slots_[vehicle];
    const ReflectionSettings& settings = engine_.settings();
    if (settings.method == ReflectionMethod::fixed && !prepared_.maps.empty()) {
        const reflection::PackedReferenceMap& map = prepared_.maps.front();
        const auto& level = map.levelFor(128);
        fillDepths(
            level.faceSize(), [&](int face, int x, int y) { return level.distanceAt(face, x, y); }, shown_);
        return ShownMap{&shown_, map.position(), false};
    }
    const glm::dvec3 centre =
        engine_.textures()
            .centres[static_cast<std::size_t>(slot.sizeClass)][static_cast<std::size_t>(slot.layer)];
    if (settings.method == ReflectionMethod::mem) {
        const reflection::PackedMips mips = engine_.mapIn(slot);
        shown_.resize(mips.faceSize);
        for (std::size_t i = 0; i < mips.nearness.size(); ++i)
            shown_.depth[i] = 1 / reflection::unpackNearness(mips.nearness[i]);
        return ShownMap{&shown_, centre, parallaxIn(settings)};
    }
    // What is drawn from a centre is what rays from there meet, as long as both are of this frame.
    if (settings.method != ReflectionMethod::rerender || settings.mapsInTurn != 0) return std::nullopt;
    const int faceSize = reflection::localMapFaceSizes[static_cast<std::size_t>(slot.sizeClass)];
    const reflection::ReferenceMap seen =
        rays_.environmentMap(centre, faceSize, scene.vehicles[vehicle].id, 1);
    fillDepths(
        faceSize,
        [&](int face, int x, int y) {
            return seen.distance[static_cast<std::size_t>((face * faceSize + y) * faceSize + x)];
        },
        shown_);
    return ShownMap{&shown_, centre, false};
}

class TracedTruth final : public ReflectionSource {
  public:
    explicit TracedTruth(RayTracer& rays) : rays_(rays) {}

    void beginFrame(const FrameScene& scene, std::span<const SeenVehicle> seen,
                    SceneRenderer& renderer) override {
        if (!sunMapTaken_) rays_.useSunMap(renderer.sunMap());
        sunMapTaken_ = true;
        rays_.prepare(scene);
        chosen_.clear();
        for (const SeenVehicle& vehicle : seen) chosen_.push_back(vehicle.index);
    }
    VehicleReflections forView(const View& view, const SceneRenderer&) override {
        rays_.mirrored(view, chosen_, truthTracing, light_);
        screen_.upload(light_.radiance, light_.size, light_.low, light_.high);
        VehicleReflections reflections;
        reflections.mirrored = screen_.name();
        return reflections;
    }
    bool keepsMaps() const override { return false; }
    std::optional<ShownMap> shownMap(const FrameScene&, std::uint32_t) override { return std::nullopt; }
    double mapsRebuilt() const override { return 0; }
    std::size_t textureBytes() const override { return 4 * light_.radiance.size(); }

  private:
    RayTracer& rays_;
    bool sunMapTaken_ = false;
    std::vector<std::uint32_t> chosen_;
    MirroredLight light_;
    reflection::ScreenLight screen_;
};

}  // namespace

std::unique_ptr<ReflectionSource> engineSource(const Scene& scene, const PreparedReflections& prepared,
                                               const ReflectionSettings& settings, RayTracer& rays) {
    return std::make_unique<EngineSource>(scene, prepared, settings, rays);
}

std::unique_ptr<ReflectionSource> tracedTruth(RayTracer& rays) {
    return std::make_unique<TracedTruth>(rays);
}

}  // namespace app
