#include "app/commands/LocalMapBench.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "app/commands/CityTriangles.h"
#include "app/frame/ReflectionEngine.h"
#include "app/frame/SkyMaps.h"
#include "app/frame/ToneMap.h"
#include "app/report/Progress.h"
#include "reflection/gl/Finish.h"
#include "reflection/gl/LocalMapAtlas.h"
#include "reflection/gl/LocalMapPass.h"
#include "reflection/gl/ReferenceMapBaker.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/reference_maps/CubeMapping.h"
#include "reflection/reference_maps/Selection.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

using Picture = std::vector<glm::vec3>;  // six faces below each other, tone mapped

Picture pictureOf(const reflection::ReferenceMap& map, const Lighting& light) {
    Picture picture;
    for (const glm::vec3& c : map.colour) picture.push_back(toneMap(c, light.exposure));
    return picture;
}

Picture pictureOf(const reflection::LocalMap& map, const Lighting& light) {
    Picture picture;
    for (std::size_t i = 0; i < map.red.size(); ++i)
        picture.push_back(toneMap({map.red[i], map.green[i], map.blue[i]}, light.exposure));
    return picture;
}

/// Everything the methods share at one place.
struct Place {
    glm::dvec3 centre;
    glm::vec3 direction;
};

std::vector<Place> choosePlaces(const city::CityModel& city, const LocalMapBenchOptions& options) {
    std::mt19937_64 random(options.seed);
    std::vector<Place> places;
    if (city.roads.lanes.empty()) return places;
    for (int i = 0; i < options.places; ++i) {
        const city::Lane& lane = city.roads.lanes[random() % city.roads.lanes.size()];
        const std::size_t segment = random() % (lane.centreLine.size() - 1);
        const glm::vec3 a = lane.centreLine[segment], b = lane.centreLine[segment + 1];
        const auto along = static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53);
        const glm::vec3 d = b - a;
        places.push_back({glm::dvec3(a + along * d + glm::vec3(0, 0, options.centreHeight)),
                          d / std::max(glm::length(d), 1e-6f)});
    }
    return places;
}

class MethodRun {
  public:
    MethodRun(std::string name, const ReflectionSettings& settings)
        : name_(std::move(name)), settings_(settings) {}
    /// On the GPU.
    MethodRun(std::string name, const ReflectionSettings& settings,
              std::span<const reflection::PackedReferenceMap> maps)
        : name_(std::move(name)),
          settings_(settings),
          pass_(std::make_unique<reflection::LocalMapPass>(maps, settings.gpuMapBytes)) {}

    const std::string& name() const { return name_; }

    /// One map, in the slot of the atlas.
    void build(const PreparedReflections& prepared, const Place& place, const reflection::LocalMap& sky,
               reflection::LocalMapAtlas& atlas, reflection::LocalMapSlot slot) {
        const int faceSize = sky.faceSize;
        reflection::LocalMapRequest request = requestFor(settings_, faceSize);
        request.lookup.sky = &sky;
        request.centre = place.centre;
        request.streetDirection = place.direction;
        const std::vector<reflection::Candidate> candidates =
            request.method == reflection::LocalMapMethod::mem
                ? reflection::selectCandidates(prepared.maps, place.centre, *prepared.tracer,
                                               candidateCount(settings_))
                : reflection::selectNearestTwo(prepared.maps, place.centre);
        request.candidates = candidates;
        if (pass_) {
            const reflection::LocalMapJob job{slot, request, {}};
            rays_ = pass_->build(*prepared.tracer, std::span(&job, 1), atlas);
            return;
        }
        map_.resize(faceSize);
        mips_.resize(faceSize);
        std::array<std::uint32_t, 6> rays{};
        tbb::parallel_for(0, 6, [&](int face) {
            rays[static_cast<std::size_t>(face)] =
                builders_[static_cast<std::size_t>(face)].buildFace(*prepared.tracer, request, face, map_);
            reflection::packFaceMips(map_, face, mips_);
        });
        rays_ = 0;
        for (std::uint32_t r : rays) rays_ += r;
        atlas.upload(slot, mips_);
    }
    /// Of the map built last, which must still be in the slot.
    Picture picture(const reflection::LocalMapAtlas& atlas, reflection::LocalMapSlot slot,
                    const Lighting& light) {
        if (!pass_) return pictureOf(map_, light);
        atlas.download(slot, mips_);
        map_.resize(mips_.faceSize);
        for (std::size_t i = 0; i < map_.red.size(); ++i)
            reflection::unpackTexel(mips_.texels[i], map_.red[i], map_.green[i], map_.blue[i]);
        return pictureOf(map_, light);
    }
    const reflection::LocalMapPass* pass() const { return pass_.get(); }
    std::uint64_t rays() const { return rays_; }

  private:
    std::string name_;
    ReflectionSettings settings_;
    std::array<reflection::LocalMapBuilder, 6> builders_;
    std::unique_ptr<reflection::LocalMapPass> pass_;
    reflection::LocalMap map_;
    reflection::PackedMips mips_;
    std::uint64_t rays_ = 0;
};

double squaredError(const Picture& a, const Picture& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::vec3 d = a[i] - b[i];
        sum += static_cast<double>(glm::dot(d, d)) / 3;
    }
    return sum / static_cast<double>(a.size());
}

double decibels(double squared) {
    return -10 * std::log10(squared);
}

}  // namespace

std::vector<LocalMapRow> runLocalMapBench(const city::CityModel& city, const PreparedReflections& prepared,
                                          reflection::SceneDrawer& drawer,
                                          const LocalMapBenchOptions& options) {
    const int n = options.faceSize;
    SkyMaps skyMaps;
    const reflection::LocalMap& sky = skyMaps.of(options.lighting, n);
    std::vector<MethodRun> methods;
    const auto add = [&](const char* name, ReflectionMethod method, MemVariant variant, Quality quality) {
        methods.emplace_back(name, ReflectionSettings{method, variant, quality, true, false});
    };
    add("blend", ReflectionMethod::blend, MemVariant::ours, Quality::medium);
    add("box", ReflectionMethod::box, MemVariant::ours, Quality::medium);
    add("mem paper", ReflectionMethod::mem, MemVariant::paper, Quality::medium);
    add("mem low", ReflectionMethod::mem, MemVariant::ours, Quality::low);
    add("mem", ReflectionMethod::mem, MemVariant::ours, Quality::medium);
    add("mem high", ReflectionMethod::mem, MemVariant::ours, Quality::high);
    if (options.mapsOn == MapsOn::gpu ||
        (options.mapsOn == MapsOn::automatic && !reflection::softwareRenderer())) {
        ReflectionSettings settings{ReflectionMethod::mem, MemVariant::ours, Quality::medium, true, false};
        settings.gpuMapBytes = options.gpuMapBytes;
        methods.emplace_back("mem gpu", settings, prepared.maps);
    }

    reflection::TriangleTracer triangles;
    addCity(triangles, city);
    triangles.commit();

    const std::vector<Place> places = choosePlaces(city, options);
    reflection::ReferenceMapBaker plain(n, 1), fine(n, 4);
    reflection::LocalMapAtlas atlas;
    // A slot for re-rendering and one for each method, whose map is looked at in the end.
    atlas.reserve(0, 1 + static_cast<int>(methods.size()));
    const reflection::LocalMapSlot slot{0, 0};
    const auto slotOf = [](std::size_t method) {
        return reflection::LocalMapSlot{0, static_cast<std::int16_t>(1 + method)};
    };

    struct Sums {
        std::vector<double> times, ratios;
        double squared = 0, squaredFine = 0, worst = 0, flip = 0, squaredToProcessor = 0;
        std::uint64_t rays = 0;
    };
    std::vector<Sums> sums(methods.size());
    std::vector<double> rerenderTimes, embreeTimes, embreeRatios;
    double rerenderSquaredFine = 0;
    Progress progress("places", places.size(), options.quiet);
    std::size_t done = 0;
    for (const Place& place : places) {
        if (interrupted()) break;
        const Picture truth = pictureOf(plain.bake(drawer, place.centre), options.lighting);
        const Picture fineTruth = pictureOf(fine.bake(drawer, place.centre), options.lighting);

        std::vector<float> dx, dy, dz;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const glm::vec3 d = reflection::cubeDirection(face, glm::vec2(x, y) + 0.5f, n);
                    dx.push_back(d.x);
                    dy.push_back(d.y);
                    dz.push_back(d.z);
                }
        std::vector<float> t(dx.size());

        for (int round = 0; round <= options.repeats; ++round) {
            // Round 0 warms caches and is not counted.
            reflection::finishGpu();
            Stopwatch watch;
            reflection::CubeTarget target = atlas.target(slot);
            drawer.drawCube(place.centre, target, {});
            atlas.finishDrawn(slot);
            reflection::finishGpu();
            const double rerender = watch.lap();
            if (round > 0) rerenderTimes.push_back(rerender);

            tbb::parallel_for(std::size_t{0}, dx.size() / 1024, [&](std::size_t block) {
                const std::size_t first = block * 1024;
                const auto part = [first](auto& v) { return std::span(v).subspan(first, 1024); };
                triangles.traceFan(glm::vec3(place.centre), part(dx), part(dy), part(dz), part(t));
            });
            const double embree = watch.lap();
            if (round > 0) {
                embreeTimes.push_back(embree);
                embreeRatios.push_back(embree / rerender);
            }
            for (std::size_t m = 0; m < methods.size(); ++m) {
                watch.lap();
                methods[m].build(prepared, place, sky, atlas, slotOf(m));
                reflection::finishGpu();
                const double time = watch.lap();
                if (round > 0) {
                    sums[m].times.push_back(time);
                    sums[m].ratios.push_back(time / rerender);
                }
            }
        }
        rerenderSquaredFine += squaredError(truth, fineTruth);
        Picture processors;
        for (std::size_t m = 0; m < methods.size(); ++m) {
            const Picture picture = methods[m].picture(atlas, slotOf(m), options.lighting);
            if (methods[m].name() == "mem") processors = picture;
            sums[m].squaredToProcessor += methods[m].pass() ? squaredError(picture, processors) : 0;
            const double squared = squaredError(picture, truth);
            sums[m].squared += squared;
            sums[m].worst = std::max(sums[m].worst, squared);
            sums[m].squaredFine += squaredError(picture, fineTruth);
            sums[m].flip += reflection::meanError(reflection::flip({n, 6 * n, picture}, {n, 6 * n, truth}));
            sums[m].rays += methods[m].rays();
        }
        ++done;
        progress.advance();
    }

    std::vector<LocalMapRow> rows;
    if (done == 0) return rows;
    const auto count = static_cast<double>(done);
    for (std::size_t m = 0; m < methods.size(); ++m) {
        LocalMapRow row;
        row.method = methods[m].name();
        row.time = timingOf(sums[m].times);
        row.ratioToRerender = timingOf(sums[m].ratios).median;
        row.psnr = decibels(sums[m].squared / count);
        row.psnrWorst = decibels(sums[m].worst);
        row.psnrSupersampled = decibels(sums[m].squaredFine / count);
        row.flip = sums[m].flip / count;
        row.rays = sums[m].rays / done;
        if (const reflection::LocalMapPass* pass = methods[m].pass()) {
            row.psnrToProcessor = decibels(sums[m].squaredToProcessor / count);
            row.referenceMapGpuBytes = pass->bytes();
            row.bytesPerTexel = pass->bytesPerTexel();
        }
        rows.push_back(row);
    }
    LocalMapRow rerender;
    rerender.method = "rerender";
    rerender.time = timingOf(rerenderTimes);
    rerender.ratioToRerender = 1;
    rerender.psnrSupersampled = decibels(rerenderSquaredFine / count);
    rows.push_back(rerender);
    LocalMapRow embree;
    embree.method = "embree";
    embree.time = timingOf(embreeTimes);
    embree.ratioToRerender = timingOf(embreeRatios).median;
    embree.rays =
        static_cast<std::uint64_t>(6) * static_cast<std::uint64_t>(n) * static_cast<std::uint64_t>(n);
    rows.push_back(embree);
    return rows;
}

}  // namespace app
