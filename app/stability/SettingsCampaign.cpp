// Settings at both ends, views of 1x1 to 16384 pixels, 0 and 100,000 cars.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "app/frame/FrameScene.h"
#include "app/frame/ReflectionPlan.h"
#include "app/frame/View.h"
#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "reflection/local_map/LocalMapBuilder.h"
#include "reflection/local_map/PackedMips.h"
#include "reflection/reference_maps/Placement.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

/// Cars of a great town, all of them seen from above: sizes of a thousandth to ten thousand pixels.
FrameScene crowd(std::uint32_t cars, SeededRandom& random, std::vector<SeenVehicle>& seen) {
    FrameScene scene;
    seen.clear();
    const double side = std::max(10.0, 20 * std::sqrt(static_cast<double>(cars)));
    for (std::uint32_t k = 0; k < cars; ++k) {
        vehicles::VehiclePose pose;
        pose.id = k;
        pose.position = {random.between(0, side), random.between(0, side), 0};
        pose.heading = random.between(0, 6.28);
        pose.speed = random.oneIn(4) ? 0.0f : static_cast<float>(random.between(0, 14));
        scene.vehicles.push_back(pose);
        seen.push_back({k, static_cast<float>(random.magnitude(1e-3, 1e4))});
    }
    return scene;
}

/// What must hold of any plan.
std::uint64_t faultsOf(const ReflectionPlan& plan, const FrameScene& scene, std::span<const SeenVehicle> seen,
                       const PlanOptions& options) {
    std::uint64_t faults = 0;
    const auto sides = reflection::localMapFaceSizes;
    if (plan.slots.size() != scene.vehicles.size() || plan.visible != seen.size()) ++faults;
    std::uint64_t texels = 0;
    std::set<std::pair<int, int>> built;
    for (const MapJob& job : plan.jobs) {
        const auto size = static_cast<std::size_t>(job.slot.sizeClass);
        if (!job.slot.valid() || size >= sides.size() || job.slot.layer < 0 ||
            job.slot.layer >= options.layersAtMost || job.vehicle >= scene.vehicles.size()) {
            ++faults;
            continue;
        }
        texels += 6 * static_cast<std::uint64_t>(sides[size]) * static_cast<std::uint64_t>(sides[size]);
        if (!built.emplace(job.slot.sizeClass, job.slot.layer).second) ++faults;  // two maps in one place
    }
    if (texels != plan.texels) ++faults;
    for (const reflection::LocalMapSlot& slot : plan.slots)
        if (slot.valid() && (slot.layer < 0 || slot.layer >= options.layersAtMost)) ++faults;
    return faults;
}

std::vector<Row> plans(const Options& options) {
    std::vector<Row> rows;
    for (const std::uint32_t cars : {0u, 1u, 1000u, 100'000u}) {
        const std::string what = std::to_string(cars) + " cars, all in view";
        Row sound{"settings",
                  "plans for " + what,
                  0,
                  0,
                  0,
                  0,
                  "faults",
                  "a place of its own for each map built, within what OpenGL grants; one slot a vehicle",
                  ""};
        Row budget{"settings",
                   "texels of plans for " + what,
                   0,
                   0,
                   0,
                   1,
                   "of the budget",
                   "beyond the budget only vehicles that have none yet get a map, one of the coarse ones",
                   ""};
        SeededRandom random(options.seed, 31);
        for (const bool best : {false, true}) {
            PlanOptions settings;
            settings.texelBudget = best ? 10'000'000 : 0;
            settings.texelsPerPixel = best ? 4.0f : 0.01f;
            settings.errorThreshold = best ? 0.0f : 100.0f;
            ReflectionPlanner planner;
            std::vector<SeenVehicle> seen;
            FrameScene scene = crowd(cars, random, seen);
            for (int frame = 0; frame < 4; ++frame) {
                scene.time = frame / 60.0;
                for (vehicles::VehiclePose& pose : scene.vehicles)
                    pose.position.x += static_cast<double>(pose.speed) / 60;
                const ReflectionPlan plan = planner.plan(scene, seen, {}, settings);
                ++sound.tried;
                sound.failures += faultsOf(plan, scene, seen, settings);
                // The first of a frame is made whatever it costs, and so are coarse ones for newcomers.
                const double most = static_cast<double>(settings.texelBudget) + 6.0 * 128 * 128 +
                                    6.0 * 16 * 16 * static_cast<double>(plan.jobs.size());
                ++budget.tried;
                const double share = static_cast<double>(plan.texels) / most;
                budget.worst = std::max(budget.worst, share);
                budget.failures += share > 1 ? 1 : 0;
            }
        }
        sound.worst = static_cast<double>(sound.failures);
        rows.push_back(sound);
        rows.push_back(budget);
    }
    return rows;
}

/// Local maps of every face size from 1 texel on, with the least and the most of every setting, and beyond.
Row localMaps(const Options& options) {
    Row row{"settings",
            "local maps with every setting at both ends and beyond",
            0,
            0,
            0,
            0,
            "of them wrong",
            "finite colours, positive depths",
            ""};
    SeededRandom random(options.seed, 32);
    city::Heightfield field(60, 60, 1, {-30, -30});
    for (int j = 0; j < 60; ++j)
        for (int i = 0; i < 60; ++i) field.set(i, j, std::abs(i - 30) > 8 ? 14.0f : 0.0f);
    const reflection::GridTracer tracer(field);
    std::vector<reflection::PackedReferenceMap> maps;
    for (int k = 0; k < 20; ++k) {
        reflection::ReferenceMap map;
        map.position = {random.between(-5, 5), random.between(-20, 20), 2};
        map.faceSize = 16;
        for (std::size_t t = 0; t < map.texelCount(); ++t) {
            map.colour.emplace_back(static_cast<float>(random.unit()));
            map.distance.push_back(random.oneIn(5) ? std::numeric_limits<float>::infinity()
                                                   : static_cast<float>(random.magnitude(0.1, 1e4)));
        }
        maps.emplace_back(map, 8.0f);
    }
    reflection::LocalMapBuilder builder;
    for (int round = 0; round < 120 * options.effort(); ++round) {
        reflection::LocalMapRequest request;
        request.method = static_cast<reflection::LocalMapMethod>(random.below(4));
        request.centre = {random.between(-6, 6), random.between(-25, 25), random.between(0.1, 3)};
        constexpr std::array<int, 6> sizes{1, 2, 7, 8, 64, 256};
        request.faceSize = sizes[static_cast<std::size_t>(random.below(round % 20 == 0 ? 6 : 5))];
        request.mesh.baseCells = random.oneIn(2) ? 1 : 32;
        request.mesh.depth = random.oneIn(2) ? 0 : 3;
        request.mesh.threshold = random.oneOf({0, 1e-9f, 1e9f});
        request.mesh.criterion = random.oneIn(2) ? reflection::RefineCriterion::planarity
                                                 : reflection::RefineCriterion::depthRatio;
        request.lookup.lookups = random.oneIn(2) ? 1 : 8;
        request.lookup.agreement = random.oneOf({0, 1e-9f, 1, 1e9f});
        std::vector<reflection::Candidate> candidates;
        constexpr std::array<int, 5> counts{0, 1, 2, 16, 20};
        for (int k = 0; k < counts[static_cast<std::size_t>(random.below(5))]; ++k)
            candidates.push_back({&maps[static_cast<std::size_t>(k)],
                                  glm::vec3(maps[static_cast<std::size_t>(k)].position() - request.centre)});
        request.candidates = candidates;
        reflection::LocalMap map;
        map.resize(request.faceSize);
        for (int face = 0; face < 6; ++face) builder.buildFace(tracer, request, face, map);
        reflection::PackedMips mips;
        reflection::packMips(map, mips);
        for (std::size_t k = 0; k < map.red.size(); ++k) {
            ++row.tried;
            const bool colour = map.red[k] >= 0 && map.green[k] >= 0 && map.blue[k] >= 0 &&
                                map.red[k] + map.green[k] + map.blue[k] < 10;
            row.failures += !colour || !(map.depth[k] > 0) ? 1 : 0;
        }
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

/// Projections of views of one pixel and of the widest: the middle of the view is the middle of the picture,
/// and its corners are where the field of view ends.
Row views(const Options& options) {
    // Six roundings of 2^-24 of coordinates up to 1, on half the width.
    Row row{"settings",
            "views of 1 to 16384 pixels a side: corners of the picture",
            0,
            0,
            0,
            8 * 0x1p-24,
            "of the picture's side",
            "8 roundings of 2^-24",
            ""};
    SeededRandom random(options.seed, 33);
    const std::array<int, 4> sides{1, 16, 720, 16384};
    for (const int width : sides)
        for (const int height : sides)
            for (const double fov : {0.001, 1.0, 3.0}) {
                const View view = lookAt({0, 0, 0}, {0, 1, 0}, fov, {width, height});
                for (const double sx : {-1.0, 0.0, 1.0})
                    for (const double sy : {-1.0, 0.0, 1.0}) {
                        const double up = std::tan(0.5 * fov);
                        const double across = up * width / height;
                        const double depth = random.magnitude(0.1, 1e4);
                        const glm::dvec3 p(sx * across * depth, depth, sy * up * depth);
                        const glm::vec4 clip =
                            view.clipFromView * view.viewFromWorld * glm::vec4(glm::vec3(p), 1);
                        const double error = std::max(std::abs(static_cast<double>(clip.x / clip.w) - sx),
                                                      std::abs(static_cast<double>(clip.y / clip.w) - sy)) /
                                             2;
                        ++row.tried;
                        row.worst = std::max(row.worst, error);
                        row.failures += !(error <= row.bound) || !(clip.z >= 0) ? 1 : 0;
                    }
            }
    return row;
}

Row placements() {
    Row row{"settings",
            "placing reference maps for no lane, one point, and settings at both ends",
            0,
            0,
            0,
            0,
            "of them wrong",
            "finite positions, a coverage of 0 to 1",
            ""};
    city::Heightfield field(30, 30, 1, {-15, -15});
    for (float& h : field.cells()) h = 0;
    const reflection::GridTracer tracer(field);
    for (const int points : {0, 1, 200})
        for (const float coverage : {0.0f, 1.0f})
            for (const float spacing : {0.0f, 0.5f, 1e6f})
                for (const float range : {1e-3f, 1e6f}) {
                    std::vector<glm::vec3> positions;
                    for (int k = 0; k < points; ++k)
                        positions.emplace_back(-10 + 0.1f * static_cast<float>(k), 0, 0);
                    reflection::PlacementOptions settings;
                    settings.coverage = coverage;
                    settings.spacing = spacing;
                    settings.range = range;
                    settings.directions = 64;
                    const reflection::Placement placed =
                        reflection::placeReferenceMaps(tracer, positions, settings);
                    ++row.tried;
                    bool good = placed.coverage >= 0 && placed.coverage <= 1;
                    for (const glm::vec3& p : placed.positions) good = good && std::isfinite(p.x + p.y + p.z);
                    row.failures += good ? 0 : 1;
                }
    row.worst = static_cast<double>(row.failures);
    return row;
}

}  // namespace

std::vector<Row> trySettings(const Options& options) {
    std::vector<Row> rows = plans(options);
    options.tell(0.4);
    if (!options.stop()) rows.push_back(localMaps(options));
    options.tell(0.8);
    if (!options.stop()) rows.push_back(views(options));
    if (!options.stop()) rows.push_back(placements());
    options.tell(1);
    return rows;
}

}  // namespace app::stability
