#include "app/raytrace/RayTracer.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <optional>

#include "app/frame/Sky.h"
#include "app/frame/StandingReflectors.h"
#include "app/frame/ToneMap.h"
#include "app/raytrace/GroundShadows.h"
#include "app/raytrace/MirrorPixels.h"
#include "app/raytrace/Strata.h"
#include "app/raytrace/VehicleTiles.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace app {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
using Backs = reflection::TracedScene::Backs;

}  // namespace

std::vector<glm::vec3> TracedPicture::display(float exposure) const {
    std::vector<glm::vec3> pixels(radiance.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = toneMap(radiance[i], exposure) * displayFactor[i];
    return pixels;
}

MirroredLight TracedPicture::mirroredLight() const {
    MirroredLight light;
    light.size = size;
    light.high = size;
    light.radiance = mirrored;
    std::vector<unsigned char> known(kind.size());
    for (std::size_t i = 0; i < kind.size(); ++i) known[i] = kind[i] == SeenKind::vehicle ? 1 : 0;
    light.pixels = static_cast<std::uint64_t>(std::count(known.begin(), known.end(), 1));
    fillOutlines(light, known, {0, 0}, size, [](int, int) { return true; });
    return light;
}

void TracedPicture::append(const TracedPicture& below) {
    const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    size = {below.size.x, size.y + below.size.y};
    add(radiance, below.radiance);
    add(displayFactor, below.displayFactor);
    add(distance, below.distance);
    add(normal, below.normal);
    add(kind, below.kind);
    add(vehicle, below.vehicle);
    add(surface, below.surface);
    add(fresnel, below.fresnel);
    add(mirrored, below.mirrored);
}

struct RayTracer::Impl {
    Impl(const city::CityModel& cityModel, std::span<const vehicles::VehicleModel> models)
        : city(cityModel), meshes(cityModel, models), standing(meshes), shading(cityModel, meshes) {
        standing.addCity(city, {});
        // The reflectors' models are the last ones.
        if (models.size() >= city.reflectors.size()) {
            FrameScene reflectors;
            reflectors.vehicles =
                standingPoses(city, static_cast<std::uint32_t>(models.size() - city.reflectors.size()));
            std::vector<std::uint32_t> all(reflectors.vehicles.size());
            std::iota(all.begin(), all.end(), 0u);
            standing.addVehicles(reflectors, all, {});
        }
        standing.commit();
        shading.setSun(nullptr, &standing.traced());
    }

    /// What mirrors show: the city as fine as it gets, vehicles as the view has them, so that none is in the
    /// way of its own rays.
    RayScene mirrorScene(const DetailRule& vehicleDetail, std::uint32_t excludedVehicle) const {
        RayScene scene(meshes);
        scene.addCity(city, {});
        scene.addLamps(city, frame, {});
        std::vector<std::uint32_t> shown;
        for (std::uint32_t i = 0; i < frame.vehicles.size(); ++i)
            if (frame.vehicles[i].id != excludedVehicle) shown.push_back(i);
        scene.addVehicles(frame, shown, vehicleDetail);
        scene.commit();
        return scene;
    }
    RayPaths::Scene pathsIn(const RayScene& scene, const TraceOptions& options) const {
        RayPaths::Scene paths{&shading, &scene, &frame, options.windows > 0, nullptr, filter};
        paths.wet = options.wet;
        paths.seed = options.seed;
        paths.fading = options.mirrorFade > 0 ? 1 / options.mirrorFade : 0;
        return paths;
    }

    struct Scratch {
        std::vector<reflection::TracedRay> rays;
        std::vector<reflection::TracedHit> hits;
        std::vector<glm::ivec2> pixels;
        std::vector<MirrorPixel> mirrors;
        std::vector<glm::vec3> light;
        MirrorPixels gatherer;
        RayPaths paths;
    };

    void shadePixel(const ViewRays& rays, const GroundShadows& shadows, const RayScene& scene,
                    const reflection::TracedRay& ray, const reflection::TracedHit& hit, const glm::ivec2& at,
                    const TraceOptions& options, const RayPaths::Scene& paths, TracedPicture& picture,
                    std::size_t index, Scratch& out) const;
    PixelRays pixelRays(const ViewRays& rays, const glm::ivec2& pixel) const;

    const city::CityModel& city;
    RayMeshes meshes;
    RayScene standing;  ///< what casts shadows
    RayShading shading;
    FrameScene frame;
    std::shared_ptr<const SunMap> sunMap;
    TextureFilter filter = TextureFilter::standard;
    int height = 0;
    std::vector<unsigned char> known;  ///< pixels of `mirrored` that show a vehicle; valid within its tiles
    mutable tbb::enumerable_thread_specific<Scratch> scratch;
};

RayTracer::RayTracer(const city::CityModel& city, std::span<const vehicles::VehicleModel> models)
    : impl_(std::make_unique<Impl>(city, models)) {}
RayTracer::~RayTracer() = default;

void RayTracer::useSunMap(std::shared_ptr<const SunMap> map) {
    impl_->sunMap = std::move(map);
    impl_->shading.setSun(impl_->sunMap.get(), &impl_->standing.traced());
}

void RayTracer::useTextureFilter(TextureFilter filter) {
    impl_->filter = filter;
}

void RayTracer::prepare(const FrameScene& scene) {
    impl_->frame = scene;
    const float length = glm::length(scene.lighting.sunDirection);
    impl_->frame.lighting.sunDirection =
        length > 0 ? scene.lighting.sunDirection / length : glm::vec3(0, 0, 1);
    impl_->shading.setLighting(impl_->frame.lighting);
}

PixelRays RayTracer::Impl::pixelRays(const ViewRays& rays, const glm::ivec2& pixel) const {
    // The rasteriser's derivatives are differences within blocks of two by two pixels, counted from the
    // lower left corner of the picture.
    const int left = pixel.x & ~1;
    const int lower = height - 1 - ((height - 1 - pixel.y) & ~1);
    const auto through = [&](int x, int y) { return rays.through(glm::vec2(x, y) + 0.5f); };
    return {true, rays.eye, {through(left, lower), through(left + 1, lower), through(left, lower - 1)}};
}

void RayTracer::Impl::shadePixel(const ViewRays& rays, const GroundShadows& shadows, const RayScene& scene,
                                 const reflection::TracedRay& ray, const reflection::TracedHit& hit,
                                 const glm::ivec2& at, const TraceOptions& options,
                                 const RayPaths::Scene& paths, TracedPicture& picture, std::size_t index,
                                 Scratch& out) const {
    picture.displayFactor[index] = shadows.factor(ray.direction, hit.found() ? hit.t : infinity);
    picture.distance[index] = hit.t;
    if (!hit.found()) {
        picture.radiance[index] = skyRadiance(frame.lighting, ray.direction);
        return;
    }
    const PlacedMesh& placed = scene.placed(hit.instance);
    const MetTriangle triangle = shading.triangle(placed, hit);
    const glm::vec2 weights(hit.u, hit.v);
    picture.normal[index] = triangle.facing();
    if (placed.kind != PlacedMesh::Kind::lamp) picture.surface[index] = triangle.corner[2]->material;
    switch (placed.kind) {
        case PlacedMesh::Kind::lamp:
            picture.kind[index] = SeenKind::lamp;
            picture.radiance[index] = placed.radiance;
            return;
        case PlacedMesh::Kind::city: {
            picture.kind[index] = SeenKind::city;
            PixelRays pixel = pixelRays(rays, at);
            const PatternSampler::Level level = shading.levelOf(triangle, pixel.apex, pixel.through, filter);
            if (const auto pane = options.windows > 0
                                      ? shading.glass(placed, triangle, weights, ray.direction)
                                      : std::nullopt) {
                const GlassShares shares = glassShares(pane->glass, -glm::dot(pane->normal, ray.direction));
                picture.kind[index] = pane->glass.roughness <= 0             ? SeenKind::glass
                                      : pane->glass == city::polishedGranite ? SeenKind::stone
                                                                             : SeenKind::frosted;
                picture.fresnel[index] = shares.mirrored;
                picture.radiance[index] =
                    shares.through * shading.city(placed, triangle, pane->weights, level,
                                                  behindSky(pane->glass), behindSun(pane->glass));
                if (pane->glass.roughness > 0) {
                    const PathRay met{{},
                                      ray.direction,
                                      0,
                                      ray.spread,
                                      glm::vec3(shares.mirrored),
                                      static_cast<std::uint32_t>(index),
                                      {}};
                    RayPaths::addRoughRays(paths, *pane, met, ray.spread * hit.t, true, out.paths.rays);
                    return;
                }
                pixel.reflect(pane->at, pane->normal);
                out.paths.rays.push_back({pane->at, mirrorDirection(pane->normal, -ray.direction),
                                          ray.spread * hit.t, ray.spread, glm::vec3(shares.mirrored),
                                          static_cast<std::uint32_t>(index), pixel, paths.fading});
                return;
            }
            picture.radiance[index] = shading.city(placed, triangle, weights, level);
            const auto ground =
                options.wet ? shading.wetGround(placed, hit, triangle, ray.direction) : std::nullopt;
            if (!ground) return;
            picture.radiance[index] *= ground->under * (1 - ground->mirrored);
            if (!(ground->mirrored > 0)) return;
            picture.kind[index] = SeenKind::water;
            picture.fresnel[index] = ground->mirrored;
            if (options.windows <= 0) {
                picture.radiance[index] +=
                    shading.wetSurroundings(triangle, weights, ray.direction, *ground) * ground->mirrored;
                return;
            }
            PathRay met{{},   ray.direction, 0, ray.spread, glm::vec3(1), static_cast<std::uint32_t>(index),
                        pixel};
            RayPaths::addWetRays(paths, *ground, triangle.at(weights), met, ray.spread * hit.t, hit.t, true,
                                 out.paths.rays);
            return;
        }
        case PlacedMesh::Kind::vehicle:
            break;
    }
    const vehicles::VehiclePose& pose = frame.vehicles[placed.vehicle];
    const VehiclePoint point = shading.vehicle(placed, triangle, weights, pose);
    const float fresnel = coatFresnel(point.coat, glm::dot(point.normal, -ray.direction));
    picture.kind[index] = SeenKind::vehicle;
    picture.vehicle[index] = pose.id;
    picture.normal[index] = point.normal;
    picture.radiance[index] = point.coat.diffuse * (1 - fresnel);
    if (options.plain) {
        picture.radiance[index] +=
            plainSurroundings(frame.lighting, point.coat, mirrorDirection(point.normal, -ray.direction)) *
            fresnel;
    } else {
        picture.fresnel[index] = fresnel;
        out.mirrors.push_back({at, &placed, triangle, weights});
    }
}

TracedPicture RayTracer::render(const View& view, const TraceOptions& options) const {
    return renderRows(view, options, 0, view.size.y);
}

TracedPicture RayTracer::renderRows(const View& view, const TraceOptions& options, int first, int end) const {
    TracedPicture picture;
    first = std::max(first, 0);
    end = std::min(end, view.size.y);
    if (view.size.x <= 0 || end <= first) return picture;
    picture.size = {view.size.x, end - first};
    const std::size_t width = static_cast<std::size_t>(view.size.x);
    const std::size_t count = width * static_cast<std::size_t>(end - first);
    picture.radiance.resize(count);
    picture.displayFactor.assign(count, glm::vec3(1));
    picture.distance.assign(count, infinity);
    picture.normal.resize(count);
    picture.kind.assign(count, SeenKind::sky);
    picture.vehicle.resize(count);
    picture.surface.resize(count);
    picture.fresnel.resize(count);
    picture.mirrored.resize(count);

    Impl& my = *impl_;
    my.height = view.size.y;
    const DetailRule detail = DetailRule::of(view);
    RayScene seen(my.meshes);
    seen.addCity(my.city, detail);
    seen.addLamps(my.city, my.frame, detail);
    std::vector<std::uint32_t> all(my.frame.vehicles.size());
    std::iota(all.begin(), all.end(), 0u);
    seen.addVehicles(my.frame, all, detail);
    seen.commit();
    std::optional<RayScene> mirrored;
    if (!options.plain || options.windows > 0) mirrored.emplace(my.mirrorScene(detail, 0xffffffffu));
    const ViewRays rays(view);
    const GroundShadows shadows(my.frame, my.meshes, my.shading, view);
    // Windows show the vehicles' shadows as well; local maps do not.
    const GroundShadows everywhere(my.frame, my.meshes, my.shading);
    RayPaths::Scene throughGlass;
    if (mirrored) {
        throughGlass = my.pathsIn(*mirrored, options);
        throughGlass.film = options.film;
        throughGlass.shadows = &everywhere;
        throughGlass.filter = my.filter;
    }

    tbb::parallel_for(first, end, [&](int y) {
        Impl::Scratch& scratch = my.scratch.local();
        scratch.rays.clear();
        scratch.mirrors.clear();
        for (int x = 0; x < view.size.x; ++x) {
            const glm::vec3 through = rays.through(glm::vec2(x, y) + 0.5f);
            const float nearPlane = glm::length(through);
            scratch.rays.push_back({rays.eye, through / nearPlane, nearPlane, infinity, 0, rays.spread});
        }
        scratch.hits.resize(width);
        seen.traced().trace(scratch.rays, scratch.hits, Backs::pass);
        const std::size_t row = static_cast<std::size_t>(y - first) * width;
        for (int x = 0; x < view.size.x; ++x) {
            const auto i = static_cast<std::size_t>(x);
            my.shadePixel(rays, shadows, seen, scratch.rays[i], scratch.hits[i], {x, y}, options,
                          throughGlass, picture, row + i, scratch);
        }
        // Each pixel's ray adds to its own sum.
        if (!scratch.paths.rays.empty())
            scratch.paths.follow(throughGlass, options.windows - 1, picture.radiance);
        if (scratch.mirrors.empty()) return;
        scratch.light.resize(scratch.mirrors.size());
        scratch.gatherer.gather(my.pathsIn(*mirrored, options), rays, scratch.mirrors, options,
                                scratch.light);
        for (std::size_t i = 0; i < scratch.mirrors.size(); ++i) {
            const std::size_t index = row + static_cast<std::size_t>(scratch.mirrors[i].pixel.x);
            picture.mirrored[index] = scratch.light[i];
            picture.radiance[index] += scratch.light[i] * picture.fresnel[index];
        }
    });
    return picture;
}

MirroredLight RayTracer::mirrored(const View& view, std::span<const std::uint32_t> chosen,
                                  const TraceOptions& options) const {
    MirroredLight light;
    mirrored(view, chosen, options, light);
    return light;
}

void RayTracer::mirrored(const View& view, std::span<const std::uint32_t> chosen, const TraceOptions& options,
                         MirroredLight& light) const {
    light.low = light.high = glm::ivec2(0);
    light.pixels = light.rays = 0;
    if (view.size.x <= 0 || view.size.y <= 0) {
        light = {};
        return;
    }
    const auto width = static_cast<std::size_t>(view.size.x);
    if (light.size != view.size) {
        light.size = view.size;
        light.radiance.assign(width * static_cast<std::size_t>(view.size.y), glm::vec3(0));
    }
    Impl& my = *impl_;
    const DetailRule detail = DetailRule::of(view);
    RayScene seen(my.meshes);
    seen.addVehicles(my.frame, chosen, detail);
    seen.commit();
    const RayScene around = my.mirrorScene(detail, 0xffffffffu);
    const ViewRays rays(view);
    const VehicleTiles tiles(my.frame, chosen, my.meshes, view);
    if (tiles.size() == 0) return;
    std::vector<unsigned char>& known = my.known;
    known.resize(light.radiance.size());
    std::atomic<std::uint64_t> rayCount{0}, pixelCount{0};
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
        Impl::Scratch& scratch = my.scratch.local();
        scratch.rays.clear();
        scratch.mirrors.clear();
        const VehicleTiles::Tile tile = tiles[t];
        // Packets are blocks of four by four pixels.
        std::vector<glm::ivec2>& pixels = scratch.pixels;
        pixels.clear();
        for (int y = tile.low.y; y < tile.high.y; y += 4)
            for (int x = tile.low.x; x < tile.high.x; x += 4)
                for (int k = 0; k < 16; ++k) {
                    const glm::ivec2 p(x + (k & 3), y + (k >> 2));
                    if (p.x >= tile.high.x || p.y >= tile.high.y) continue;
                    pixels.push_back(p);
                    known[static_cast<std::size_t>(p.y) * width + static_cast<std::size_t>(p.x)] = 0;
                    light.radiance[static_cast<std::size_t>(p.y) * width + static_cast<std::size_t>(p.x)] =
                        glm::vec3(0);
                    const glm::vec3 through = rays.through(glm::vec2(p) + 0.5f);
                    const float nearPlane = glm::length(through);
                    scratch.rays.push_back(
                        {rays.eye, through / nearPlane, nearPlane, infinity, 0, rays.spread});
                }
        scratch.hits.resize(pixels.size());
        seen.traced().trace(scratch.rays, scratch.hits, Backs::pass);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (!scratch.hits[i].found()) continue;
            const PlacedMesh& placed = seen.placed(scratch.hits[i].instance);
            scratch.mirrors.push_back({pixels[i], &placed, my.shading.triangle(placed, scratch.hits[i]),
                                       glm::vec2(scratch.hits[i].u, scratch.hits[i].v)});
        }
        scratch.light.resize(scratch.mirrors.size());
        pixelCount += scratch.mirrors.size();
        rayCount += scratch.gatherer.gather(my.pathsIn(around, options), rays, scratch.mirrors, options,
                                            scratch.light);
        for (std::size_t i = 0; i < scratch.mirrors.size(); ++i) {
            const glm::ivec2 p = scratch.mirrors[i].pixel;
            const std::size_t index = static_cast<std::size_t>(p.y) * width + static_cast<std::size_t>(p.x);
            light.radiance[index] = scratch.light[i];
            known[index] = 1;
        }
    });
    light.rays = rayCount;
    light.pixels = pixelCount;
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
        fillOutlines(light, known, tiles[t].low, tiles[t].high,
                     [&](int x, int y) { return tiles.covers(x, y); });
    });
    light.low = view.size;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        light.low = glm::min(light.low, tiles[t].low);
        light.high = glm::max(light.high, tiles[t].high);
    }
}

reflection::ReferenceMap RayTracer::environmentMap(const glm::dvec3& centre, int faceSize,
                                                   std::uint32_t excludedVehicle, int samples,
                                                   const TraceOptions& options) const {
    reflection::ReferenceMap map;
    if (faceSize <= 0) return map;
    map.position = centre;
    map.faceSize = faceSize;
    map.colour.assign(map.texelCount(), glm::vec3(0));
    map.distance.assign(map.texelCount(), infinity);
    Impl& my = *impl_;
    const RayScene scene = my.mirrorScene({}, excludedVehicle);
    samples = std::max(samples, 1);
    const glm::vec3 origin(centre);
    const float texel = 2.0f / static_cast<float>(faceSize);
    tbb::parallel_for(0, 6 * faceSize, [&](int row) {
        Impl::Scratch& scratch = my.scratch.local();
        const int face = row / faceSize, y = row % faceSize;
        std::vector<float> distances(static_cast<std::size_t>(samples));
        for (int x = 0; x < faceSize; ++x) {
            scratch.paths.rays.clear();
            const std::uint64_t key =
                strataKey(options.seed, static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(x));
            for (int s = 0; s < samples; ++s) {
                const glm::vec2 offset = samples == 1 ? glm::vec2(0.5f) : stratum(key, 0, s, samples);
                const glm::vec3 direction =
                    glm::normalize(reflection::cubeDirection(face, glm::vec2(x, y) + offset, faceSize));
                scratch.paths.rays.push_back({origin,
                                              direction,
                                              0,
                                              texel / std::sqrt(static_cast<float>(samples)),
                                              glm::vec3(1 / static_cast<float>(samples)),
                                              0,
                                              {}});
            }
            const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(faceSize) +
                                      static_cast<std::size_t>(x);
            scratch.paths.follow(my.pathsIn(scene, options), std::max(options.bounces, 1) - 1,
                                 {&map.colour[index], 1}, distances);
            map.distance[index] = reflection::representativeDistance(distances);
        }
    });
    return map;
}

}  // namespace app
