#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <utility>

#include "app/commands/ChromeBench.h"
#include "app/commands/HollowImages.h"
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

/// The virtual objects of one reflector for one share. Nothing is remembered from round to round: each is as
/// the first.
struct Crowd {
    std::vector<std::unique_ptr<VirtualObject>> objects;  ///< meshes within pieces
    reflection::VirtualCounts counts;

    Crowd(const StagedChrome& part, double share, const reflection::VirtualOptions& how) {
        reflection::VirtualOptions options = how;
        options.share = share;
        options.remember = false;
        for (std::size_t p = 0; p < part.reflector.pieces.size(); ++p)
            for (const CloseMesh& m : part.close)
                objects.push_back(std::make_unique<VirtualObject>(m.positions, options));
    }
    void update(const StagedChrome& part, const glm::dvec3& eye) {
        counts = {};
        std::size_t k = 0;
        std::vector<VirtualObject::Placed> placed;
        for (const reflection::ReflectorPiece& piece : part.reflector.pieces) {
            placed.clear();
            for (std::size_t m = 0; m < part.close.size(); ++m)
                placed.push_back({objects[k++].get(), glm::dmat4(1), {}});
            VirtualObject::update(piece.built.map, eye, placed);
            for (const VirtualObject::Placed& p : placed) {
                counts.vertices += p.counts.vertices;
                counts.searched += p.counts.searched;
                counts.atOutlines += p.counts.atOutlines;
                counts.inBentCells += p.counts.inBentCells;
                counts.lookups += p.counts.lookups;
            }
        }
    }
};

std::vector<Seen> seenIn(const StagedChrome& part, const glm::dvec3& eye, const PixelPlace& place,
                         const reflection::VirtualOptions& how) {
    std::vector<Seen> all;
    std::vector<glm::dvec3> where;
    for (const reflection::ReflectorPiece& piece : part.reflector.pieces)
        for (const CloseMesh& m : part.close) {
            const std::vector<glm::dvec3> vertices(m.positions.begin(), m.positions.end());
            std::vector<ReflectionPoint> points(vertices.size());
            findReflectionPoints(piece.built.map, eye, vertices, points, how);
            where.insert(where.end(), vertices.begin(), vertices.end());
            for (const ReflectionPoint& r : points) {
                Seen seen;
                seen.searched = place.of(r.point - eye);
                seen.found = r.status == ReflectionStatus::found && place.inside(seen.searched);
                all.push_back(seen);
            }
        }
    const TrueReflection truth(*part.mirror);
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t k) {
        Seen& seen = all[k];
        if (!seen.found) return;
        for (const TruePoint& t : truth.all(eye, where[k])) {
            // On concave pieces several; the image that the search has settled on is the nearest.
            const glm::dvec2 at = place.of(t.position - eye);
            if (seen.isTrue && glm::distance(at, seen.searched) >= glm::distance(seen.truth, seen.searched))
                continue;
            seen.isTrue = true;
            seen.truth = at;
        }
    });
    return all;
}

/// Every triangle in four.
void halveEdges(CloseMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [at, added] =
            middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
        if (added) mesh.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
        return at->second;
    };
    std::vector<std::uint32_t> fine;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const std::uint32_t a = mesh.indices[k], b = mesh.indices[k + 1], c = mesh.indices[k + 2];
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.insert(fine.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    mesh.indices = std::move(fine);
}

std::string inWords(const Spread& s) {
    return fixed(s.mean, 3) + " / " + fixed(s.p99, 2) + " / " + fixed(s.worst, 2);
}

}  // namespace

MirrorRows chromeShares(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": share of the vertices close to a reflector that is searched for";
    out.table.push_back({"reflector", "share, %", "vertices", "searched", "at outlines", "bent", "ms",
                         "a second", "paper", "faster than 100 %", "paper", "asked",
                         "px from 100 %: mean/99 %/worst", "px from truth: mean/99 %/worst", "lost",
                         "no truth"});
    const glm::dvec3 eye = stage.world.eye;
    const PixelPlace place(stage.world.view(options.size));
    constexpr std::size_t shares = std::size(paperShares);
    struct Share {
        reflection::VirtualCounts counts;
        std::vector<double> ms, fromFull, fromTruth;
        std::size_t lost = 0, untrue = 0;
    };
    const auto add = [&](const std::string& name, std::size_t s, const Share& of, const Share& full) {
        const double paper = paperShares[s].fps / paperShares[0].fps;
        const Timing time = timingOf(of.ms);
        std::vector<double> ratios;
        for (std::size_t k = 0; k < of.ms.size(); ++k) ratios.push_back(full.ms[k] / of.ms[k]);
        const double faster = timingOf(ratios).median;
        const bool asked = paperShares[s].share == 0.096;
        const Spread toFull = spreadOf(of.fromFull), toTruth = spreadOf(of.fromTruth);
        out.table.push_back({name, fixed(100 * paperShares[s].share, 1), std::to_string(of.counts.vertices),
                             std::to_string(of.counts.searched), std::to_string(of.counts.atOutlines),
                             std::to_string(of.counts.inBentCells), fixed(time.median, 2),
                             fixed(1000 / time.median, 0), fixed(paperShares[s].fps, 1),
                             fixed(faster, 1) + "x", fixed(paper, 1) + "x", asked ? ">= 7.8x" : "",
                             inWords(toFull), inWords(toTruth), std::to_string(of.lost),
                             std::to_string(of.untrue)});
        nlohmann::ordered_json row{{"part", "share"},
                                   {"scene", stage.world.name},
                                   {"reflector", name},
                                   {"share", paperShares[s].share},
                                   {"vertices", of.counts.vertices},
                                   {"searched", of.counts.searched},
                                   {"at_outlines", of.counts.atOutlines},
                                   {"in_bent_cells", of.counts.inBentCells},
                                   {"lookups", of.counts.lookups},
                                   {"update_ms", app::toJson(time)},
                                   {"paper_fps", paperShares[s].fps},
                                   {"ratio_to_full", faster},
                                   {"paper_ratio", paper},
                                   {"px_from_full", toJson(toFull)},
                                   {"px_from_truth", toJson(toTruth)},
                                   {"found_in_full_only", of.lost},
                                   {"found_without_truth", of.untrue}};
        if (asked)
            row["asked"] = {{"ratio_to_full", 7.8}, {"worst_px_from_full", 1}, {"worst_px_from_truth", 2}};
        out.rows.push_back(std::move(row));
    };
    std::vector<Share> whole(shares);
    std::vector<StagedChrome> parts = stage.parts;
    // What a share saves depends on how many vertices a cell holds: the same things with finer triangles.
    for (const StagedChrome& part : stage.parts) {
        if (part.concave()) continue;
        parts.push_back(part);
        parts.back().name += ", 4 times the triangles";
        for (CloseMesh& m : parts.back().close) halveEdges(m);
        break;
    }
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (options.stop()) return out;
        const StagedChrome& part = parts[p];
        std::vector<Share> here(shares);
        std::vector<Seen> seen;
        std::vector<Crowd> crowds;
        // In hollow pieces every image is drawn, and measured as such; one round of them is enough.
        const bool hollow = part.concave() && !options.vertex.published;
        if (hollow) {
            HollowImages full;
            HollowTruth truth;
            for (std::size_t s = 0; s < shares; ++s) {
                const Stopwatch watch;
                HollowImages some = hollowImages(part.reflector.pieces.front().built.map, eye, part.close,
                                                 paperShares[s].share, options.vertex.search);
                Share& of = here[s];
                of.ms.push_back(watch.elapsed());
                of.counts.searched = some.searched;
                for (const CloseMesh& m : part.close) of.counts.vertices += m.positions.size();
                if (s == 0) {
                    full = some;
                    truth = hollowTruth(part, eye, place, full);
                }
                HollowErrors errors = hollowErrors(full, some, truth, place);
                of.fromFull = std::move(errors.fromFull);
                of.fromTruth = std::move(errors.fromTruth);
                of.lost = errors.lost, of.untrue = errors.untrue;
            }
        } else {
            seen = seenIn(part, eye, place, options.vertex);
            for (const PaperShare& s : paperShares) crowds.emplace_back(part, s.share, options.vertex);
        }
        for (int round = -1; round < options.repeats && !hollow; ++round)
            for (std::size_t s = 0; s < shares; ++s) {
                const Stopwatch watch;
                crowds[s].update(part, eye);
                if (round >= 0) here[s].ms.push_back(watch.elapsed());
            }
        for (std::size_t s = 0; s < shares; ++s) {
            Share& of = here[s];
            if (!hollow) of.counts = crowds[s].counts;
            std::size_t at = 0;
            for (std::size_t o = 0; !hollow && o < crowds[s].objects.size(); ++o)
                for (const reflection::VirtualVertex& v : crowds[s].objects[o]->vertices()) {
                    const Seen& is = seen[at++];
                    if (!is.found) continue;
                    of.untrue += !is.isTrue;
                    // Cells across an outline are searched vertex by vertex: others' nodes all agree.
                    if (v.status != ReflectionStatus::found) {
                        ++of.lost;
                        continue;
                    }
                    const glm::dvec2 pixel = place.of(glm::dvec3(v.fromEye));
                    of.fromFull.push_back(glm::distance(pixel, is.searched));
                    if (is.isTrue) of.fromTruth.push_back(glm::distance(pixel, is.truth));
                }
            add(hollow ? part.name + ", every image" : part.name, s, of, here[0]);
            if (p >= stage.parts.size()) continue;
            Share& all = whole[s];
            all.counts.vertices += of.counts.vertices;
            all.counts.searched += of.counts.searched;
            all.counts.atOutlines += of.counts.atOutlines;
            all.counts.inBentCells += of.counts.inBentCells;
            all.counts.lookups += of.counts.lookups;
            all.lost += of.lost, all.untrue += of.untrue;
            all.fromFull.insert(all.fromFull.end(), of.fromFull.begin(), of.fromFull.end());
            all.fromTruth.insert(all.fromTruth.end(), of.fromTruth.begin(), of.fromTruth.end());
            all.ms.resize(static_cast<std::size_t>(options.repeats));
            for (std::size_t k = 0; k < all.ms.size(); ++k) all.ms[k] += of.ms[k % of.ms.size()];
        }
        if (options.advance && p < stage.parts.size()) options.advance();
    }
    if (stage.parts.size() > 1)
        for (std::size_t s = 0; s < shares; ++s) add("all", s, whole[s], whole[0]);
    return out;
}

}  // namespace app
