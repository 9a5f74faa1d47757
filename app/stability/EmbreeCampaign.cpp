// What a triangle tracer misses of the same kinds of rays: counted for comparison, not judged.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "app/commands/EmbreeColumns.h"
#include "app/stability/AdversarialRays.h"
#include "app/stability/ExactReference.h"
#include "app/stability/Stability.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

constexpr std::uint64_t raysOfFamily = 128;

struct Tally {
    std::uint64_t rays = 0, quick = 0, robust = 0, ours = 0;
};

/// Families whose numbers a float tracer of triangles is meant for.
constexpr RayFamily families[] = {
    RayFamily::anywhere,    RayFamily::alongEdges,   RayFamily::throughCorners, RayFamily::nearCorners,
    RayFamily::grazingTops, RayFamily::grazingWalls, RayFamily::vertical,       RayFamily::zeroComponents,
    RayFamily::onWalls,     RayFamily::outside};

void tryField(const FieldKind& kind, SeededRandom& random, std::vector<Tally>& tallies) {
    FieldKind solid = kind;
    solid.columns = Columns::solidTown;
    const city::Heightfield field = makeField(solid, random);
    const reflection::GridTracer tracer(field);
    const ExactReference reference(field);
    const EmbreeColumns quick(field, false), robust(field, true);
    const double farthest = std::max(std::abs(field.origin().x), std::abs(field.origin().y)) +
                            std::max(field.width(), field.height()) * static_cast<double>(field.cellSize());
    const double lowest = *std::min_element(field.cells().begin(), field.cells().end());
    for (std::size_t f = 0; f < std::size(families); ++f) {
        std::vector<city::Ray> rays;
        std::vector<float> truths;
        for (std::uint64_t k = 0; k < 4 * raysOfFamily && rays.size() < raysOfFamily; ++k) {
            const glm::vec3 start = startOf(families[f], field, random);
            const city::Ray ray{start, directionOf(families[f], field, start, random)};
            const ExactReference::Answer answer = reference.trace(ray);
            // Only rays that run through a column, deeper than vertices are off by being floats and by a
            // thousandth of a cell: touches of an edge or a top are nobody's miss.
            const double margin = std::max(1e-3 * static_cast<double>(field.cellSize()), farthest * 0x1p-22);
            if (answer.numerator == 0 || reference.depthOfPassage(ray, answer) < margin) continue;
            const auto t = static_cast<double>(answer.numerator / answer.denominator);
            // Columns have no bottom; Embree's boxes end below the lowest top.
            if (ray.origin.z + t * static_cast<double>(ray.direction.z) < lowest) continue;
            rays.push_back(ray);
            truths.push_back(static_cast<float>(t));
        }
        std::vector<float> t(rays.size());
        const auto passedThrough = [&](std::size_t k) {
            // Not at all, or nothing until it would long be inside.
            return !(t[k] <= truths[k] * 1.001f +
                                 static_cast<float>(std::sqrt(3.0)) * field.cellSize() /
                                     std::max({std::abs(rays[k].direction.x), std::abs(rays[k].direction.y),
                                               std::abs(rays[k].direction.z)}));
        };
        Tally& tally = tallies[f];
        tally.rays += rays.size();
        quick.single(rays, t);
        for (std::size_t k = 0; k < rays.size(); ++k) tally.quick += passedThrough(k) ? 1 : 0;
        robust.single(rays, t);
        for (std::size_t k = 0; k < rays.size(); ++k) tally.robust += passedThrough(k) ? 1 : 0;
        for (std::size_t k = 0; k < rays.size(); ++k) t[k] = tracer.trace(rays[k]).t;
        for (std::size_t k = 0; k < rays.size(); ++k) tally.ours += passedThrough(k) ? 1 : 0;
    }
}

}  // namespace

std::vector<Row> tryEmbree(const Options& options) {
    std::vector<Tally> tallies(std::size(families));
    const int rounds = 6 * std::min(options.effort(), 20);
    for (int round = 0; round < rounds && !options.stop(); ++round) {
        std::uint64_t stream = static_cast<std::uint64_t>(round) << 32;
        for (const FieldKind& kind : fieldKinds()) {
            SeededRandom random(options.seed, ++stream);
            if (kind.columns == Columns::town) tryField(kind, random, tallies);
        }
        options.tell((round + 1.0) / rounds);
    }
    const double endless = std::numeric_limits<double>::infinity();
    std::vector<Row> rows;
    Tally all;
    const auto add = [&](const std::string& who, const std::string& what, std::uint64_t rays,
                         std::uint64_t passed, bool judged) {
        rows.push_back({"embree", who + ": pass through a column, rays " + what, rays, judged ? passed : 0,
                        rays > 0 ? 100.0 * static_cast<double>(passed) / static_cast<double>(rays) : 0,
                        judged ? 0 : endless, "% of them",
                        judged ? "a ray through a column hits it" : "counted for comparison", ""});
    };
    for (std::size_t f = 0; f < std::size(families); ++f) {
        const Tally& tally = tallies[f];
        const std::string what(nameOf(families[f]));
        add("Embree", what, tally.rays, tally.quick, false);
        add("Embree robust", what, tally.rays, tally.robust, false);
        all.rays += tally.rays;
        all.quick += tally.quick;
        all.robust += tally.robust;
        all.ours += tally.ours;
    }
    add("Embree", "of all these kinds", all.rays, all.quick, false);
    add("Embree robust", "of all these kinds", all.rays, all.robust, false);
    add("GridTracer", "of all these kinds", all.rays, all.ours, true);
    return rows;
}

}  // namespace app::stability
