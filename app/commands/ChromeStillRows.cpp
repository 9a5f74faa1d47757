#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/commands/ChromeBench.h"
#include "app/commands/HollowImages.h"
#include "app/mirrors/TrueReflection.h"
#include "app/report/Table.h"

namespace app {

using reflection::ReflectionStatus;
using reflection::VirtualObject;

namespace {

/// A vertex is not said to jump by less than this: the eighth of a pixel to which rasterisers snap.
constexpr double floorPixels = 0.125;
/// Vertices that are followed: so many of the things nearest to a reflector, on convex pieces and, with every
/// image, in hollow ones.
constexpr std::size_t mostFollowed = 3000, mostInHollow = 600;
/// Steps are compared with the truth every so many.
constexpr int truthEvery = 250;

struct Followed {
    std::string name;
    reflection::VirtualOptions options;
};

/// What has come out of following one reflector's images.
struct Jumps {
    double ratio = 0;  ///< of a vertex's move to the largest of its neighbours', both at least the floor
    double at = 0;     ///< pixels that the vertex moved by there
    double own = 0;    ///< worst change of a vertex's move from one step to the next, pixels
    std::size_t moves = 0, jumps = 0;  ///< moves; those of more than twice every neighbour's
    std::size_t comes = 0, goes = 0;   ///< of images in hollow pieces
    std::vector<double> fromTruth;     ///< pixels between a step's move and the truth's
};

std::vector<std::vector<std::uint32_t>> neighboursOf(const CloseMesh& mesh) {
    std::vector<std::vector<std::uint32_t>> of(mesh.positions.size());
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = mesh.indices[k + i], b = mesh.indices[k + (i + 1) % 3];
            if (a == b) continue;
            of[a].push_back(b);
            of[b].push_back(a);
        }
    for (auto& n : of) {
        std::sort(n.begin(), n.end());
        n.erase(std::unique(n.begin(), n.end()), n.end());
    }
    return of;
}

}  // namespace

MirrorRows chromeStills(const ChromeStage& stage, const ChromeBenchOptions& options) {
    MirrorRows out;
    out.title = stage.world.name + ": " + std::to_string(options.steps) +
                " small steps of the eye; a vertex's move against its neighbours'";
    out.table.push_back({"reflector", "searched", "moves", "worst ratio", "px there", "over 2x", "asked",
                         "images that come and go", "worst change of a move, px",
                         "px a step from truth: mean/99 %/worst"});
    const glm::dvec3 target = stage.world.target, start = stage.world.eye;
    // Half a millimetre a step on a circle about what is looked at: 0.5 m in all for 1,000.
    const double angle = 0.0005 / std::max(glm::distance(start, target), 1e-3);
    const auto eyeAt = [&](int step) {
        const double a = angle * (step - options.steps / 2);
        const glm::dvec3 d = start - target;
        return target +
               glm::dvec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
    };
    // Positions are measured in the first step's view: a turning camera would add moves of its own.
    const PixelPlace place(stage.world.view(options.size));
    std::vector<Followed> how;
    reflection::VirtualOptions all = options.vertex, some = options.vertex;
    all.share = 1;
    how.push_back({"all", all});
    some.bounded = false;
    how.push_back({"9.6 %", some});
    if (!options.vertex.published) {
        all.published = reflection::PublishedOptions{};
        how.push_back({"as published, 9 steps", all});
    }
    for (const StagedChrome& part : stage.parts) {
        const TrueReflection truth(*part.mirror);
        const auto nearest = [&](const glm::dvec3& from, const glm::dvec3& p, const glm::dvec2& seen,
                                 glm::dvec2& best) {
            double least = 1e300;
            for (const TruePoint& t : truth.all(from, p)) {
                const glm::dvec2 pixel = place.of(t.position - from);
                if (glm::distance(pixel, seen) < least) least = glm::distance(pixel, seen), best = pixel;
            }
            return least < 1e300;
        };
        std::vector<std::vector<std::vector<std::uint32_t>>> neighbours;
        for (const CloseMesh& m : part.close) neighbours.push_back(neighboursOf(m));
        for (const Followed& followed : how) {
            if (options.stop()) return out;
            Jumps result;
            for (const reflection::ReflectorPiece& piece : part.reflector.pieces) {
                if (piece.bend == reflection::Bend::concave && !followed.options.published) {
                    std::size_t left = mostInHollow;
                    std::vector<CloseMesh> meshes;
                    for (const CloseMesh& m : part.close)
                        if (m.positions.size() <= left) left -= m.positions.size(), meshes.push_back(m);
                    HollowFollower follower(meshes, place);
                    for (int step = 0; step <= options.steps; ++step) {
                        if (options.stop()) return out;
                        const glm::dvec3 eye = eyeAt(step), was = eyeAt(step - 1);
                        const auto compare = [&](std::size_t m, std::size_t k, const glm::dvec2& from,
                                                 const glm::dvec2& to) {
                            const glm::dvec3 p(meshes[m].positions[k]);
                            glm::dvec2 now(0), then(0);
                            if (nearest(eye, p, to, now) && nearest(was, p, from, then))
                                result.fromTruth.push_back(glm::distance(to - from, now - then));
                        };
                        follower.step(
                            hollowImages(piece.built.map, eye, meshes, followed.options.share,
                                         followed.options.search),
                            floorPixels,
                            step % truthEvery == 1 ? HollowFollower::Told(compare) : HollowFollower::Told());
                    }
                    if (follower.ratio > result.ratio) result.ratio = follower.ratio, result.at = follower.at;
                    result.own = std::max(result.own, follower.own);
                    result.moves += follower.moves, result.jumps += follower.jumps;
                    result.comes += follower.comes, result.goes += follower.goes;
                    continue;
                }
                std::size_t left = mostFollowed;
                for (std::size_t m = 0; m < part.close.size(); ++m) {
                    const CloseMesh& mesh = part.close[m];
                    if (mesh.positions.size() > left) continue;
                    left -= mesh.positions.size();
                    VirtualObject object(mesh.positions, followed.options);
                    const std::size_t n = mesh.positions.size();
                    std::vector<glm::dvec2> last(n), move(n), before(n);
                    std::vector<std::uint8_t> wasFound(n, 0), moved(n, 0), movedBefore(n, 0);
                    for (int step = 0; step <= options.steps; ++step) {
                        if (options.stop()) return out;
                        const glm::dvec3 eye = eyeAt(step);
                        object.update(piece.built.map, eye, glm::dmat4(1));
                        before.swap(move);
                        movedBefore.swap(moved);
                        for (std::size_t k = 0; k < n; ++k) {
                            const reflection::VirtualVertex& v = object.vertices()[k];
                            const bool found = v.status == ReflectionStatus::found;
                            // Seen from a moving eye, what lies still would move too: taken as a point of the
                            // picture of a camera that keeps its direction.
                            const glm::dvec2 at = found ? place.of(glm::dvec3(v.fromEye)) : glm::dvec2(0);
                            moved[k] = found && wasFound[k] && place.inside(at);
                            if (moved[k]) move[k] = at - last[k];
                            if (moved[k] && step % truthEvery == 1) {
                                const glm::dvec3 p(mesh.positions[k]);
                                glm::dvec2 now(0), then(0);
                                if (nearest(eye, p, at, now) && nearest(eyeAt(step - 1), p, last[k], then))
                                    result.fromTruth.push_back(glm::distance(move[k], now - then));
                            }
                            wasFound[k] = found;
                            last[k] = at;
                        }
                        for (std::size_t k = 0; k < n; ++k) {
                            if (!moved[k]) continue;
                            double around = 0;
                            bool known = false;
                            for (const std::uint32_t other : neighbours[m][k]) {
                                if (!moved[other]) continue;
                                known = true;
                                around = std::max(around, glm::length(move[other]));
                            }
                            if (movedBefore[k])
                                result.own = std::max(result.own, glm::distance(move[k], before[k]));
                            if (!known) continue;
                            ++result.moves;
                            const double length = glm::length(move[k]);
                            const double ratio =
                                std::max(length, floorPixels) / std::max(around, floorPixels);
                            result.jumps += ratio > 2;
                            if (ratio > result.ratio) result.ratio = ratio, result.at = length;
                        }
                    }
                }
            }
            const Spread fromTruth = spreadOf(result.fromTruth);
            out.table.push_back({part.name, followed.name, std::to_string(result.moves),
                                 fixed(result.ratio, 2), fixed(result.at, 2), std::to_string(result.jumps),
                                 "0", std::to_string(result.comes) + " / " + std::to_string(result.goes),
                                 fixed(result.own, 2),
                                 fixed(fromTruth.mean, 4) + " / " + fixed(fromTruth.p99, 3) + " / " +
                                     fixed(fromTruth.worst, 3)});
            out.rows.push_back({{"part", "still"},
                                {"scene", stage.world.name},
                                {"reflector", part.name},
                                {"method", followed.name},
                                {"steps", options.steps},
                                {"moves", result.moves},
                                {"floor_px", floorPixels},
                                {"worst_ratio_to_neighbours", result.ratio},
                                {"px_there", result.at},
                                {"over_twice_neighbours", result.jumps},
                                {"images_come", result.comes},
                                {"images_go", result.goes},
                                {"worst_change_of_a_move_px", result.own},
                                {"px_a_step_from_truth", toJson(fromTruth)},
                                {"asked", {{"over_twice_neighbours", 0}}}});
        }
        if (options.advance) options.advance();
    }
    return out;
}

}  // namespace app
