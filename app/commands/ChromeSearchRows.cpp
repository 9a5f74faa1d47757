#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/commands/ChromeBench.h"
#include "app/commands/ChromeShapes.h"
#include "app/mirrors/TrueReflection.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "app/stability/SeededRandom.h"

namespace app {

using reflection::Bend;
using reflection::ReflectionPoint;
using reflection::ReflectionStatus;

namespace {

/// Searches on concave pieces look for all points, and on open ones some look for a point that is not there:
/// so many vertices fewer.
constexpr std::size_t fewer = 50;

double angleAt(const glm::dvec3& eye, const glm::dvec3& vertex, const ReflectionPoint& r) {
    const glm::dvec3 h = glm::normalize(eye - r.point) + glm::normalize(vertex - r.point);
    return std::atan2(glm::length(glm::cross(h, r.normal)), glm::dot(h, r.normal));
}

std::string scientific(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", x);
    return text;
}

struct Outcome {
    std::size_t found = 0, hidden = 0, unreflected = 0, outOfSteps = 0, lookups = 0;
    double worst = 0, sum = 0;  ///< radians, of those found
    void count(const ReflectionPoint& r, double angle) {
        lookups += r.lookups;
        hidden += r.status == ReflectionStatus::hidden;
        unreflected += r.status == ReflectionStatus::unreflected;
        outOfSteps += r.status == ReflectionStatus::outOfSteps;
        if (r.status != ReflectionStatus::found) return;
        ++found;
        worst = std::max(worst, angle);
        sum += angle;
    }
};

}  // namespace

MirrorRows chromeSearches(const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = "searches for reflection points, one thread";
    out.table.push_back({"shape", "bend", "map, KiB", "vertices", "M a second", "asked", "lookups", "found",
                         "hidden", "unreflected", "lost", "worst residual, rad", "asked"});
    stability::SeededRandom random(options.seed, 31);
    for (const ChromeShape& shape : chromeShapes(options.car, options.carLength)) {
        const glm::dvec3 eye = shape.centre + 4 * shape.radius * shape.from;
        const std::vector<glm::dvec3> all = verticesAround(shape, options.vertices, random);
        // Parts that are cut: convex pieces and concave ones each as one, by far the larger ones first.
        for (const Bend bend : {Bend::convex, Bend::concave}) {
            if (options.stop()) return out;
            std::vector<const reflection::ReflectorPiece*> pieces;
            std::size_t bytes = 0;
            for (const reflection::ReflectorPiece& p : shape.reflector.pieces)
                if (p.bend == bend && !p.built.map.empty() && pieces.size() < 8)
                    pieces.push_back(&p), bytes += p.built.map.bytes();
            if (pieces.empty()) continue;
            const bool open = std::any_of(pieces.begin(), pieces.end(),
                                          [](const auto* p) { return p->built.report.coveredShare < 1; });
            const std::size_t n = std::max<std::size_t>(
                all.size() / (bend == Bend::concave || open ? fewer : 1) / pieces.size(), 16);
            const std::span<const glm::dvec3> vertices = std::span(all).first(std::min(n, all.size()));
            std::vector<ReflectionPoint> points(vertices.size());
            Outcome outcome;
            std::vector<double> ms;
            for (int round = -1; round < options.repeats; ++round) {
                const Stopwatch watch;
                double elapsed = 0;
                for (const reflection::ReflectorPiece* p : pieces) {
                    const double before = watch.elapsed();
                    findReflectionPoints(p->built.map, eye, vertices, points, options.vertex);
                    elapsed += watch.elapsed() - before;
                    if (round == 0)
                        for (std::size_t k = 0; k < points.size(); ++k)
                            outcome.count(points[k], angleAt(eye, vertices[k], points[k]));
                }
                if (round >= 0) ms.push_back(elapsed);
            }
            const std::size_t searches = vertices.size() * pieces.size();
            const double lost = static_cast<double>(searches) -
                                static_cast<double>(outcome.found + outcome.hidden + outcome.unreflected);
            const double rate = static_cast<double>(searches) / timingOf(ms).median * 1e-3;
            const double lookups = static_cast<double>(outcome.lookups) / static_cast<double>(searches);
            const std::string bent = bend == Bend::convex ? "convex" : "concave";
            const std::size_t same = static_cast<std::size_t>(
                std::count_if(shape.reflector.pieces.begin(), shape.reflector.pieces.end(),
                              [&](const reflection::ReflectorPiece& p) { return p.bend == bend; }));
            out.table.push_back(
                {shape.name, bent + ", " + std::to_string(pieces.size()) + " of " + std::to_string(same),
                 std::to_string(bytes / 1024), std::to_string(searches), fixed(rate, 3), ">= 5",
                 fixed(lookups, 1), std::to_string(outcome.found), std::to_string(outcome.hidden),
                 std::to_string(outcome.unreflected), fixed(lost, 0), scientific(outcome.worst), "<= 1e-6"});
            out.rows.push_back(
                {{"part", "search"},
                 {"shape", shape.name},
                 {"bend", bent},
                 {"pieces", pieces.size()},
                 {"pieces_of_this_bend", same},
                 {"map_bytes", bytes},
                 {"searches", searches},
                 {"search_ms", app::toJson(timingOf(ms))},
                 {"million_searches_per_second", rate},
                 {"lookups", lookups},
                 {"found", outcome.found},
                 {"hidden", outcome.hidden},
                 {"unreflected", outcome.unreflected},
                 {"lost", lost},
                 {"worst_residual_rad", outcome.worst},
                 {"asked", {{"million_searches_per_second", 5}, {"worst_residual_rad", 1e-6}, {"lost", 0}}}});
        }
        if (options.advance) options.advance();
    }
    return out;
}

MirrorRows publishedSearches(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": the published search by its steps, and ours";
    out.table.push_back({"reflector", "search", "vertices", "lookups", "us a vertex",
                         "residual, degrees: mean/99 %/worst", "px from ours: mean/99 %/worst",
                         "found by both", "only ours", "only it"});
    const glm::dvec3 eye = stage.world.eye;
    const PixelPlace place(stage.world.view(options.size));
    constexpr double degrees = 57.29577951308232;
    for (const StagedChrome& part : stage.parts) {
        if (options.stop()) return out;
        // The paper's search is for convex pieces; on concave ones it walks to one of the points.
        const reflection::ReflectorPiece* piece =
            part.reflector.pieces.empty() ? nullptr : &part.reflector.pieces.front();
        if (piece == nullptr || piece->built.map.empty()) continue;
        std::vector<glm::dvec3> vertices;
        for (const CloseMesh& m : part.close)
            vertices.insert(vertices.end(), m.positions.begin(), m.positions.end());
        std::vector<ReflectionPoint> ours(vertices.size()), points(vertices.size());
        // 0 steps: ours.
        for (const int steps : {0, 3, 5, 7, 9}) {
            std::vector<double> ms;
            const int rounds = piece->bend == Bend::convex ? options.repeats : 1;
            for (int round = 0; round < rounds; ++round) {
                const Stopwatch watch;
                // Every point counts, whatever its error.
                if (steps == 0)
                    findReflectionPoints(piece->built.map, eye, vertices, points);
                else
                    findReflectionPointsAsPublished(piece->built.map, eye, vertices, points,
                                                    {.steps = steps, .threshold = 1});
                ms.push_back(watch.elapsed());
            }
            if (steps == 0) ours = points;
            std::vector<double> angles, pixels;
            std::size_t lookups = 0, both = 0, onlyOurs = 0, onlyIt = 0;
            for (std::size_t k = 0; k < points.size(); ++k) {
                lookups += points[k].lookups;
                const bool mine =
                    ours[k].status == ReflectionStatus::found && place.inside(place.of(ours[k].point - eye));
                const bool its = points[k].status == ReflectionStatus::found &&
                                 place.inside(place.of(points[k].point - eye));
                onlyOurs += mine && !its;
                onlyIt += its && !mine;
                if (!mine || !its) continue;
                ++both;
                angles.push_back(degrees * angleAt(eye, vertices[k], points[k]));
                pixels.push_back(
                    glm::distance(place.of(points[k].point - eye), place.of(ours[k].point - eye)));
            }
            const Spread angle = spreadOf(angles), pixel = spreadOf(pixels);
            const double perVertex = static_cast<double>(lookups) / static_cast<double>(vertices.size());
            const double each = 1000 * timingOf(ms).median / static_cast<double>(vertices.size());
            const std::string name = steps == 0 ? "ours" : "published, " + std::to_string(steps) + " steps";
            out.table.push_back(
                {part.name, name, std::to_string(vertices.size()), fixed(perVertex, 1), fixed(each, 2),
                 scientific(angle.mean) + " / " + scientific(angle.p99) + " / " + scientific(angle.worst),
                 fixed(pixel.mean, 3) + " / " + fixed(pixel.p99, 2) + " / " + fixed(pixel.worst, 2),
                 std::to_string(both), std::to_string(onlyOurs), std::to_string(onlyIt)});
            out.rows.push_back({{"part", "published"},
                                {"scene", stage.world.name},
                                {"reflector", part.name},
                                {"method", name},
                                {"steps", steps},
                                {"vertices", vertices.size()},
                                {"lookups", perVertex},
                                {"microseconds_per_vertex", each},
                                {"residual_degrees", toJson(angle)},
                                {"px_from_ours", toJson(pixel)},
                                {"found_by_both", both},
                                {"found_by_ours_only", onlyOurs},
                                {"found_by_it_only", onlyIt}});
        }
        if (options.advance) options.advance();
    }
    return out;
}

}  // namespace app
