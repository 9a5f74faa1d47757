#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/frame/MirroredLight.h"
#include "app/frame/SunMap.h"
#include "app/raytrace/PatternSampler.h"
#include "city/model/CityModel.h"
#include "reflection/reference_maps/ReferenceMap.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

/// How much work a picture is.
struct TraceOptions {
    /// Mirror rays of each pixel that shows a vehicle, spread over what the pixel reflects (and, on brushed
    /// rims, over their gloss). One: the ray of the pixel's middle alone.
    int samples = 1;
    /// Mirror rays in a row: 1 sees the other vehicles in plain paint, as drawn cubes do; 2 sees what they
    /// mirror, and so on; at least 1.
    int bounces = 1;
    bool plain = false;  ///< plain paint: the picture of the method `none`; samples and bounces do not matter
    std::uint64_t seed = 1;
    /// Mirrors in a row that begin with the city's glass: 0 leaves panes as they are painted. One ray a
    /// pixel.
    int windows = 0;
    /// It has rained: wet ground mirrors, as the first of `windows` mirrors in a row, or of `bounces` in what
    /// vehicles mirror; with 0 of them by mean light. Puddles by one ray a pixel.
    bool wet = false;
    float mirrorFade = 0;  ///< metres behind flat mirrors on which what they show fades to 1/e; 0: not
    /// Rays of a pixel for what the film of water on rough ground spreads, and frosted glass, and stone.
    int film = 64;
};

/// What a pixel or texel shows.
enum class SeenKind : std::uint8_t { sky, city, lamp, vehicle, glass, water, frosted, stone };

/// A ray traced picture, one sample a pixel for what is seen directly (as the rasteriser without
/// antialiasing), top row first.
struct TracedPicture {
    glm::ivec2 size{0};
    std::vector<glm::vec3> radiance;  ///< linear
    /// Factor on display colours: the shadows of vehicles on the ground, which the rasteriser blends so.
    std::vector<glm::vec3> displayFactor;
    std::vector<float> distance;  ///< metres from the eye, +infinity for sky
    std::vector<glm::vec3> normal;
    std::vector<SeenKind> kind;
    /// Of vehicles their id, of all else 0.
    std::vector<std::uint32_t> vehicle;
    /// Material of the city, vehicles::Surface of vehicles; 0 elsewhere.
    std::vector<std::uint32_t> surface;
    std::vector<float> fresnel;       ///< share of the mirrored light; 0 where none is traced
    std::vector<glm::vec3> mirrored;  ///< the light that vehicles mirror, already within `radiance`

    /// Display colours, sRGB-encoded 0..1, as drawView leaves them.
    std::vector<glm::vec3> display(float exposure) const;
    /// `mirrored` as the rasteriser takes it, with pixels next to vehicles filled in. For whole pictures.
    MirroredLight mirroredLight() const;
    /// Puts the rows of another picture, equally wide, below these.
    void append(const TracedPicture& below);
};

/// The scene of a frame as rays see it: the same city, materials, vehicles, sky and light as the rasteriser's
/// (SceneRenderer), shaded by the processor's twins of its shaders. Needs no OpenGL. What is seen directly
/// has the rasteriser's levels of detail; what is seen in a mirror is as fine as it gets.
///
/// Shadows: with a sun map (SceneRenderer::sunMap) those that the rasteriser draws, from the same map;
/// without, by rays to the sun. Either way the standing city casts them, and vehicles are in the same light
/// in mirrors as in the view. Deterministic: the same calls give the same pictures, bit for bit on one
/// machine, whatever the number of threads.
class RayTracer {
  public:
    /// Keeps references to both. Cost: a tree over the city's triangles (0.3 s for half a million).
    RayTracer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models);
    ~RayTracer();
    RayTracer(const RayTracer&) = delete;
    RayTracer& operator=(const RayTracer&) = delete;

    /// The rasteriser's shadows from now on; null: rays to the sun.
    void useSunMap(std::shared_ptr<const SunMap> map);

    /// How the rasteriser chooses textures' levels of detail for what is seen directly.
    void useTextureFilter(TextureFilter filter);

    /// Takes over this frame's vehicles, signals and light. Before any tracing. Cost: a tree over the
    /// vehicles.
    void prepare(const FrameScene& scene);

    /// The whole picture of a view. An empty picture for an empty view.
    TracedPicture render(const View& view, const TraceOptions& options) const;

    /// Rows [first, end) of that picture, so that long work can be done in parts: equal to the same rows of
    /// the whole, bit for bit.
    TracedPicture renderRows(const View& view, const TraceOptions& options, int first, int end) const;

    /// Vehicles' pixels alone, and those next to them. `chosen`: indices into FrameScene::vehicles of those
    /// that may be seen; others are not looked for.
    MirroredLight mirrored(const View& view, std::span<const std::uint32_t> chosen,
                           const TraceOptions& options) const;
    /// The same into a picture that is used again from frame to frame: pixels far from vehicles keep what
    /// they held.
    void mirrored(const View& view, std::span<const std::uint32_t> chosen, const TraceOptions& options,
                  MirroredLight& light) const;

    /// What is seen from a point, the vehicle of this id left out; `samples` rays a texel, stratified. Depth
    /// is the distance in metres, +infinity for sky; faces in CubeMapping's order.
    reflection::ReferenceMap environmentMap(const glm::dvec3& centre, int faceSize,
                                            std::uint32_t excludedVehicle, int samples,
                                            const TraceOptions& options = {}) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
