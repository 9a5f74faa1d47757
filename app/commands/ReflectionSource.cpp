#include "app/commands/ReflectionSource.h"

#include "reflection/gl/ScreenLight.h"

namespace app {

namespace {

class EngineSource final : public ReflectionSource {
  public:
    EngineSource(const Scene& scene, const PreparedReflections& prepared, const ReflectionSettings& settings,
                 RayTracer& rays)
        : engine_(*prepared.tracer, prepared.maps, scene.models, settings), rays_(rays) {}

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
    std::size_t textureBytes() const override {
        return engine_.counters().localMapBytes + engine_.counters().referenceMapGpuBytes;
    }

  private:
    ReflectionEngine engine_;
    RayTracer& rays_;
    bool lent_ = false;
    std::vector<reflection::LocalMapSlot> slots_;
};

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
