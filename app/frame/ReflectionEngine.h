#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/frame/Detail.h"
#include "app/frame/FrameScene.h"
#include "app/frame/ReflectionMethod.h"
#include "app/frame/ReflectionPlan.h"
#include "app/frame/SunMap.h"
#include "reflection/gl/LocalMapTextures.h"
#include "reflection/gl/SceneDrawer.h"
#include "reflection/local_map/LocalMapBuilder.h"
#include "reflection/local_map/PackedMips.h"
#include "reflection/reference_maps/PackedReferenceMap.h"
#include "reflection/tracing/GridTracer.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

class RayTracer;

struct ReflectionSettings {
    ReflectionMethod method = ReflectionMethod::mem;
    MemVariant variant = MemVariant::ours;
    Quality quality = Quality::medium;
    bool everyFrame = false;       ///< rebuild every visible map every frame
    bool vehiclesInMaps = true;    ///< other vehicles appear in each vehicle's map
    bool parallax = true;          ///< maps of `mem` are looked up where a pixel's own ray ends
    bool wet = false;              ///< it has rained: what `raytrace` sees; maps are of dry streets
    bool shareMaps = true;         ///< small vehicles may show a neighbour's map
    std::uint32_t mapsInTurn = 0;  ///< see PlanOptions
    int sizeClass = -1;            ///< see PlanOptions
    MapsOn mapsOn = MapsOn::automatic;
    std::size_t gpuMapBytes =
        std::size_t{512} << 20;  ///< for reference maps on the GPU at most; those in use take turns there
    std::optional<ReflectionDetail> detail = std::nullopt;  ///< takes the place of what `quality` stands for
};

/// The detail in use: the settings' own, else their quality's.
ReflectionDetail detailOf(const ReflectionSettings& settings);
/// What the settings mean in numbers; kept in one place so that benches and panels show the same.
PlanOptions planOptionsFor(const ReflectionSettings& settings);
/// Mesh, lookup and candidate count of a local map of this size.
reflection::LocalMapRequest requestFor(const ReflectionSettings& settings, int faceSize);
/// Whether maps are looked up with parallax: the distances of the published methods' maps are not those of
/// what they show.
bool parallaxIn(const ReflectionSettings& settings);
std::size_t candidateCount(const ReflectionSettings& settings);

struct ReflectionCounters {
    std::uint32_t visible = 0, rebuilt = 0, fresh = 0, shared = 0, postponed = 0;
    std::uint64_t texels = 0, rays = 0;
    std::uint64_t mirrorPixels = 0;        ///< traced, with `raytrace`
    std::size_t localMapBytes = 0;         ///< on the GPU, skies for those that it builds included
    std::size_t referenceMapBytes = 0;     ///< in main memory
    std::size_t referenceMapGpuBytes = 0;  ///< on the GPU; 0 where local maps are made on the processor
    double referenceBytesPerTexel = 0;     ///< colour and distance together; 0 without maps
    double milliseconds = 0;               ///< planning, building and uploading, CPU side
};

/// Runs the reflections of a frame: plans which local maps to build, builds them on all cores (or has the
/// scene drawn, for `rerender`), uploads them; or has the GPU build them, see MapsOn. Keeps references to
/// tracer and maps. Needs a current GL 4.5 context.
class ReflectionEngine {
  public:
    ReflectionEngine(const reflection::GridTracer& tracer,
                     std::span<const reflection::PackedReferenceMap> maps,
                     std::span<const vehicles::VehicleModel> models, const ReflectionSettings& settings);
    ~ReflectionEngine();

    /// New settings; maps are forgotten where the method changes.
    void configure(const ReflectionSettings& settings);
    const ReflectionSettings& settings() const;

    /// Plans and executes one frame. `drawer` must be prepared with the same scene.
    const ReflectionPlan& update(const FrameScene& scene, std::span<const SeenVehicle> seen,
                                 reflection::SceneDrawer& drawer);

    /// What the method `raytrace` traces with, kept and prepared by `update`; null: plain paint. `sunMap` is
    /// asked for the rasteriser's shadows when the light is new, with the drawer prepared.
    void useRayTracer(RayTracer* tracer, std::function<std::shared_ptr<const SunMap>()> sunMap);
    /// For `raytrace`: traces what the vehicles last seen mirror in a view of the last frame, as the GL name
    /// of VehicleReflections::mirrored; good until the next call. 0 with every other method.
    std::uint32_t mirroredIn(const View& view);

    reflection::LocalMapTextures textures() const;
    const ReflectionCounters& counters() const;

    /// Reads a local map back from the GPU: for tests and measurements, since it waits.
    reflection::PackedMips mapIn(reflection::LocalMapSlot slot) const;

    /// From now on local maps keep their distances whether they are looked up with parallax or not: for
    /// measurements.
    void keepDistances();

    /// The mesh of a vehicle's local map, as lines in face coordinates, for looking at: built anew.
    std::vector<reflection::LocalMapMesh::Quad> meshOf(const glm::dvec3& centre, int face, int faceSize,
                                                       int& latticeSize) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
