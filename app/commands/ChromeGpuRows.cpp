#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/commands/ChromeBench.h"
#include "app/commands/ChromeShapes.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "app/stability/SeededRandom.h"
#include "reflection/gl/ChromeSearch.h"
#include "reflection/gl/Finish.h"

namespace app {

using reflection::Bend;
using reflection::ChromeMapBuffer;
using reflection::ChromeSearch;
using reflection::GpuReflection;
using reflection::ReflectionPoint;
using reflection::ReflectionStatus;

namespace {

/// Vertices for a shape on convex pieces, and on concave ones, where all points are looked for.
constexpr std::size_t onConvex = 20000, onConcave = 400;
/// Pieces of a shape, the largest first.
constexpr std::size_t mostPieces = 8;

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Agreement {
    std::size_t searches = 0, found = 0, hidden = 0, unreflected = 0, differ = 0;
    std::size_t toDouble = 0, toThorough = 0;
    double point = 0, image = 0;  ///< worst, radians seen from the eye, of those that both find

    /// Everything relative to the eye but `vertex` and `centre`, which are in the reflector's frame.
    void add(const GpuReflection& g, const ReflectionPoint& r, const glm::dvec3& eye,
             const glm::dvec3& vertex, const glm::dvec3& centre) {
        ++searches;
        found += g.statusOf() == ReflectionStatus::found;
        hidden += g.statusOf() == ReflectionStatus::hidden;
        unreflected += g.statusOf() == ReflectionStatus::unreflected;
        differ += g.statusOf() != r.status;
        if (g.statusOf() != ReflectionStatus::found || r.status != ReflectionStatus::found) return;
        point = std::max(point, angleBetween(centre + glm::dvec3(g.point) - eye, r.point - eye));
        image = std::max(image, angleBetween(glm::dvec3(g.fromEye), virtualVertex(r, vertex) - eye));
    }
};

/// One map; adds milliseconds of each round.
void measure(ChromeSearch& search, const reflection::ReflectorMap& map, const glm::dvec3& eye,
             std::span<const glm::dvec3> around, const ChromeBenchOptions& options, Agreement& agreement,
             std::vector<double>& onGpu, std::vector<double>& onCpu) {
    const glm::dvec3 centre = map.frame().centre;
    std::vector<glm::vec3> relative;
    std::vector<glm::dvec3> vertices;
    for (const glm::dvec3& v : around) {
        relative.emplace_back(v - centre);
        // What the card is given, to the last bit.
        vertices.push_back(centre + glm::dvec3(relative.back()));
    }
    const ChromeMapBuffer buffer(map);
    const reflection::gl::Buffer given = reflection::gl::Buffer::filled(std::span<const glm::vec3>(relative));
    const reflection::gl::Buffer results =
        reflection::gl::Buffer::sized(relative.size() * sizeof(GpuReflection));
    std::vector<ReflectionPoint> points(vertices.size());
    onGpu.resize(static_cast<std::size_t>(options.repeats), 0.0);
    onCpu.resize(static_cast<std::size_t>(options.repeats), 0.0);
    for (int round = -1; round < options.repeats; ++round) {
        const Stopwatch watch;
        search.search(buffer, eye, given.name(), relative.size(), results.name());
        reflection::finishGpu();
        const double gpu = watch.elapsed();
        findReflectionPoints(map, eye, vertices, points, options.vertex.search);
        if (round < 0) continue;
        onGpu[static_cast<std::size_t>(round)] += gpu;
        onCpu[static_cast<std::size_t>(round)] += watch.elapsed() - gpu;
    }
    const ChromeSearch::Left left = search.leftOfLast();
    agreement.toDouble += left.toDouble;
    agreement.toThorough += left.toThorough;
    const std::vector<GpuReflection> read = ChromeSearch::read(results.name(), relative.size());
    for (std::size_t k = 0; k < read.size(); ++k) agreement.add(read[k], points[k], eye, vertices[k], centre);
}

std::string scientific(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", x);
    return text;
}

}  // namespace

MirrorRows chromeSearchesOnGpu(const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = "search, gpu: reflection points by the graphics card against the processor's";
    out.table.push_back({"shape", "bend", "vertices", "M a second", "cpu, one thread", "in double, %",
                         "thorough, %", "found", "hidden", "unreflected", "lost", "statuses differ", "asked",
                         "point, rad", "image, rad", "asked"});
    ChromeSearch search;
    stability::SeededRandom random(options.seed, 32);
    for (const ChromeShape& shape : chromeShapes(options.car, options.carLength)) {
        const glm::dvec3 eye = shape.centre + 4 * shape.radius * shape.from;
        for (const Bend bend : {Bend::convex, Bend::concave}) {
            if (options.stop()) return out;
            const std::vector<glm::dvec3> all =
                verticesAround(shape, bend == Bend::convex ? onConvex : onConcave, random);
            Agreement sum;
            std::vector<double> gpu, cpu;
            std::size_t pieces = 0;
            for (const reflection::ReflectorPiece& p : shape.reflector.pieces) {
                if (p.bend != bend || p.built.map.empty() || pieces >= mostPieces) continue;
                ++pieces;
                // On open pieces the processor's search takes as long as on concave ones.
                const std::size_t n =
                    p.built.report.coveredShare < 1 ? std::min(all.size(), onConcave * 5) : all.size();
                measure(search, p.built.map, eye, std::span(all).first(n), options, sum, gpu, cpu);
            }
            if (pieces == 0) continue;
            const auto n = static_cast<double>(sum.searches);
            const double lost = n - static_cast<double>(sum.found + sum.hidden + sum.unreflected);
            const double rate = n / timingOf(gpu).median * 1e-3, onCpu = n / timingOf(cpu).median * 1e-3;
            const double inDouble = 100 * static_cast<double>(sum.toDouble) / n;
            const double thorough = 100 * static_cast<double>(sum.toThorough) / n;
            const std::string bent = bend == Bend::convex ? "convex" : "concave";
            out.table.push_back({shape.name, bent + ", " + std::to_string(pieces),
                                 std::to_string(sum.searches), fixed(rate, 3), fixed(onCpu, 3),
                                 fixed(inDouble, 1), fixed(thorough, 2), std::to_string(sum.found),
                                 std::to_string(sum.hidden), std::to_string(sum.unreflected), fixed(lost, 0),
                                 std::to_string(sum.differ), "0", scientific(sum.point),
                                 scientific(sum.image), "<= 1e-4"});
            out.rows.push_back({{"part", "search, gpu"},
                                {"shape", shape.name},
                                {"bend", bent},
                                {"pieces", pieces},
                                {"searches", sum.searches},
                                {"search_ms", app::toJson(timingOf(gpu))},
                                {"million_searches_per_second", rate},
                                {"million_searches_per_second_on_one_thread_of_the_processor", onCpu},
                                {"settled_in_double_percent", inDouble},
                                {"settled_thoroughly_percent", thorough},
                                {"found", sum.found},
                                {"hidden", sum.hidden},
                                {"unreflected", sum.unreflected},
                                {"lost", lost},
                                {"statuses_that_differ", sum.differ},
                                {"worst_angle_between_points_rad", sum.point},
                                {"worst_angle_between_virtual_vertices_rad", sum.image},
                                {"asked",
                                 {{"worst_angle_between_points_rad", 1e-4},
                                  {"worst_angle_between_virtual_vertices_rad", 1e-4},
                                  {"lost", 0}}}});
        }
    }
    if (options.advance) options.advance();
    return out;
}

}  // namespace app
