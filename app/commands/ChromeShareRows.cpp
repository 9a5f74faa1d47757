#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>

#include "app/commands/ChromeBench.h"
#include "app/mirrors/TrueReflection.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/chrome/VirtualObject.h"

namespace app {

using reflection::ReflectionPoint;
using reflection::ReflectionStatus;
using reflection::VirtualObject;

namespace {

/// Figure 7 of the paper: shares, and frames a second there.
struct PaperShare {
    double share, fps;
};
constexpr PaperShare paperShares[]{{1, 1.3}, {0.143, 8.3}, {0.096, 10.1}, {0.055, 13.6}, {0.041, 16.3}};

/// Where a vertex is seen in one piece: by a search of its own, and truly.
struct Seen {
    bool found = false, isTrue = false;
    glm::dvec2 searched{0}, truth{0};
};

/// The virtual objects of one reflector for one share.
struct Crowd {
    std::vector<std::unique_ptr<VirtualObject>> objects;  ///< meshes within pieces
    reflection::VirtualCounts counts;

    Crowd(const ChromePart& part, double share) {
        reflection::VirtualOptions options;
        options.share = share;
        for (std::size_t p = 0; p < part.reflector.pieces.size(); ++p)
            for (const CloseMesh& m : part.close)
                objects.push_back(std::make_unique<VirtualObject>(m.positions, options));
    }
    void update(const ChromePart& part, const glm::dvec3& eye) {
        counts = {};
        std::size_t k = 0;
        for (const reflection::ReflectorPiece& piece : part.reflector.pieces)
            for (std::size_t m = 0; m < part.close.size(); ++m) {
                const reflection::VirtualCounts c = objects[k++]->update(piece.built.map, eye, glm::dmat4(1));
                counts.vertices += c.vertices;
                counts.searched += c.searched;
                counts.atOutlines += c.atOutlines;
            }
    }
};

std::vector<Seen> seenIn(const ChromePart& part, const glm::dvec3& eye, const PixelPlace& place) {
    std::vector<Seen> all;
    for (const reflection::ReflectorPiece& piece : part.reflector.pieces)
        for (const CloseMesh& m : part.close) {
            const std::vector<glm::dvec3> vertices(m.positions.begin(), m.positions.end());
            std::vector<ReflectionPoint> points(vertices.size());
            reflection::findReflectionPoints(piece.built.map, eye, vertices, points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                Seen seen;
                seen.searched = place.of(points[i].point - eye);
                seen.found = points[i].status == ReflectionStatus::found && place.inside(seen.searched);
                if (seen.found) {
                    const auto truth = trueReflection(*part.mirror, eye, vertices[i], points[i].point);
                    seen.isTrue = truth.has_value();
                    if (truth) seen.truth = place.of(truth->position - eye);
                }
                all.push_back(seen);
            }
        }
    return all;
}

nlohmann::ordered_json toJson(const Spread& s) {
    return {{"n", s.n}, {"mean", s.mean}, {"p99", s.p99}, {"worst", s.worst}};
}

std::string inWords(const Spread& s) {
    return fixed(s.mean, 3) + " / " + fixed(s.p99, 2) + " / " + fixed(s.worst, 2);
}

}  // namespace

MirrorRows chromeShares(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": share of vertices that is searched for";
    out.table.push_back({"reflector", "share, %", "vertices", "searched", "at outlines", "ms",
                         "faster than 100 %", "paper", "px from 100 %: mean/99 %/worst",
                         "px from truth: mean/99 %/worst", "lost"});
    const glm::dvec3 eye = stage.world.eye;
    const PixelPlace place(stage.world.view(options.size));
    constexpr std::size_t shares = std::size(paperShares);
    std::vector<std::vector<double>> whole(shares);
    std::vector<reflection::VirtualCounts> wholeCounts(shares);
    std::vector<std::vector<double>> wholeFromFull(shares), wholeFromTruth(shares);
    const auto row = [&](const std::string& name, std::size_t s, const reflection::VirtualCounts& counts,
                         const Timing& time, double faster, const Spread& full, const Spread& truth,
                         std::size_t lost, std::size_t untrue) {
        const double paper = paperShares[s].fps / paperShares[0].fps;
        out.table.push_back({name, fixed(100 * paperShares[s].share, 1), std::to_string(counts.vertices),
                             std::to_string(counts.searched), std::to_string(counts.atOutlines),
                             fixed(time.median, 2), fixed(faster, 1) + "x", fixed(paper, 1) + "x",
                             inWords(full), inWords(truth), std::to_string(lost)});
        out.rows.push_back({{"part", "share"},
                            {"scene", stage.world.name},
                            {"reflector", name},
                            {"share", paperShares[s].share},
                            {"vertices", counts.vertices},
                            {"searched", counts.searched},
                            {"at_outlines", counts.atOutlines},
                            {"update_ms", app::toJson(time)},
                            {"ratio_to_full", faster},
                            {"paper_ratio", paper},
                            {"px_from_full", toJson(full)},
                            {"px_from_truth", toJson(truth)},
                            {"found_in_full_only", lost},
                            {"found_without_truth", untrue}});
    };
    for (const ChromePart& part : stage.parts) {
        if (options.stop()) return out;
        const std::vector<Seen> seen = seenIn(part, eye, place);
        std::vector<Crowd> crowds;
        for (const PaperShare& s : paperShares) crowds.emplace_back(part, s.share);
        std::vector<std::vector<double>> ms(shares);
        for (int round = -1; round < options.repeats; ++round)
            for (std::size_t s = 0; s < shares; ++s) {
                const Stopwatch watch;
                crowds[s].update(part, eye);
                if (round >= 0) ms[s].push_back(watch.elapsed());
            }
        for (std::size_t s = 0; s < shares; ++s) {
            std::vector<double> fromFull, fromTruth;
            std::size_t at = 0, lost = 0, untrue = 0;
            for (const auto& object : crowds[s].objects)
                for (const reflection::VirtualVertex& v : object->vertices()) {
                    const Seen& is = seen[at++];
                    if (!is.found) continue;
                    untrue += !is.isTrue;
                    // Cells across an outline are searched vertex by vertex: others' nodes all agree.
                    if (v.status != ReflectionStatus::found) {
                        ++lost;
                        continue;
                    }
                    const glm::dvec2 pixel = place.of(glm::dvec3(v.fromEye));
                    fromFull.push_back(glm::distance(pixel, is.searched));
                    if (is.isTrue) fromTruth.push_back(glm::distance(pixel, is.truth));
                }
            row(part.name, s, crowds[s].counts, timingOf(ms[s]),
                timingOf(ms[0]).median / timingOf(ms[s]).median, spreadOf(fromFull), spreadOf(fromTruth),
                lost, untrue);
        }
        if (options.advance) options.advance();
    }
    return out;
}

}  // namespace app
