#include "reflection/chrome/VirtualObject.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace reflection {

namespace {

bool finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// On the line of sight through the point, at the length of the path. For a point that was found this is the
/// vertex mirrored at the tangent plane; for a hidden one, too, where the line of sight meets the surface.
glm::vec3 imageOf(const ReflectionPoint& r, const glm::dvec3& eye, const glm::dvec3& vertex) {
    return glm::vec3(virtualVertex(r, vertex) - eye);
}

/// Searches that one core answers at a time, where several do: as many as findReflectionPoints sorts
/// together.
constexpr std::size_t searchesATime = 256;

/// Below this there is less to interpolate between the eight corners of one cell than to search for.
constexpr std::size_t fewestVertices = 16;

/// Of what is left of a budget a round spends half, and no less than this: cells that come of larger ones
/// have their turn before all is spent.
constexpr std::size_t fewestInRound = 256;

/// Of a budget one part in so many is kept for what was refined in the last update, too: its cells are judged
/// anew now and then, which takes searches for corners besides.
constexpr std::size_t keptShare = 8;

/// How much farther off another cell must be to be refined in place of one that was in the last update, so
/// that cells at the end of a budget do not come and go.
constexpr float stays = 1.5f;

}  // namespace

void findReflectionPoints(const ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const glm::dvec3> vertices, std::span<ReflectionPoint> points,
                          const VirtualOptions& options, std::span<const glm::dvec3> guesses) {
    if (options.published)
        findReflectionPointsAsPublished(map, eye, vertices, points, *options.published);
    else if (options.threads && vertices.size() >= 2 * searchesATime)
        tbb::parallel_for(
            std::size_t{0}, (vertices.size() + searchesATime - 1) / searchesATime, [&](std::size_t k) {
                const std::size_t first = k * searchesATime;
                const std::size_t n = std::min(searchesATime, vertices.size() - first);
                findReflectionPoints(map, eye, vertices.subspan(first, n), points.subspan(first, n),
                                     options.search, guesses.empty() ? guesses : guesses.subspan(first, n));
            });
    else
        findReflectionPoints(map, eye, vertices, points, options.search, guesses);
}

VirtualObject::VirtualObject(std::vector<glm::vec3> positions, const VirtualOptions& options)
    : settings(options), points(std::move(positions)) {
    image.resize(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k)
        if (!finite(points[k])) broken.push_back(k);
    if (!(settings.share < 1) || points.size() <= fewestVertices) return;
    const double most = settings.share * static_cast<double>(points.size());
    if (settings.plainGrid || settings.published) {
        if (most >= 8) grid.emplace(points, static_cast<std::size_t>(most));
    } else {
        cells.emplace(points, settings);
    }
}

void VirtualObject::onGrid(const ReflectorMap& map, const glm::dvec3& eye,
                           const glm::dmat4& reflectorFromMesh, VirtualCounts& counts) {
    const std::span<const glm::vec3> nodes = grid->nodes();
    counts.nodes = nodes.size();
    asked.resize(nodes.size());
    answers.resize(nodes.size());
    atNodes.resize(nodes.size());
    atVertices.resize(points.size());
    for (std::size_t k = 0; k < nodes.size(); ++k)
        asked[k] = glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(nodes[k]), 1));
    findReflectionPoints(map, eye, asked, answers, settings);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        counts.add(answers[k]);
        atNodes[k] = glm::vec4(imageOf(answers[k], eye, asked[k]), 0);
    }
    grid->interpolate(atNodes, atVertices);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::array<std::uint32_t, 8>& n = grid->cells()[grid->places()[k].cell].nodes;
        // Seen if any corner is: what hides the others is left to what is drawn in front.
        ReflectionStatus status = answers[n[0]].status;
        for (const std::uint32_t i : n)
            if (answers[i].status == ReflectionStatus::found) status = ReflectionStatus::found;
        image[k] = {glm::vec3(atVertices[k]), status};
    }
}

bool VirtualObject::ask(SearchBatch& batch, bool first, VirtualCounts& counts, std::size_t& left) {
    if (grid) return false;
    if (cells) return cells->ask(batch, image, counts, left);
    firstAnswer = batch.places.size();
    if (!first) return false;
    const bool known = settings.remember && last.size() == points.size();
    for (std::size_t k = 0; k < points.size(); ++k)
        batch.ask(glm::dvec3(place * glm::dvec4(glm::dvec3(points[k]), 1)),
                  known ? last[k] : glm::dvec3(NAN));
    return !points.empty();
}

void VirtualObject::take(SearchBatch& batch, VirtualCounts& counts) {
    if (grid) return;
    if (cells) {
        cells->take(batch, image, counts);
        return;
    }
    last.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
        const ReflectionPoint& r = batch.answers[firstAnswer + k];
        counts.add(r);
        image[k] = {imageOf(r, eyeAt, batch.places[firstAnswer + k]), r.status};
        last[k] = r.status == ReflectionStatus::hidden ? glm::dvec3(NAN) : r.point;
    }
}

void VirtualObject::spend(std::span<Placed> objects, std::size_t reserve, std::size_t& left) {
    struct Candidate {
        float urgency;
        std::size_t object, at;
        bool wasIn;
    };
    std::vector<Candidate> candidates;
    std::vector<std::vector<std::uint8_t>> kept(objects.size());
    for (std::size_t o = 0; o < objects.size(); ++o) {
        if (!objects[o].object->cells) continue;
        const CellImage& image = *objects[o].object->cells;
        kept[o].assign(image.pending().size(), 0);
        for (std::size_t k = 0; k < image.pending().size(); ++k) {
            const PendingCell& cell = image.pending()[k];
            const bool wasIn = image.wasIn(cell);
            candidates.push_back({wasIn ? stays * cell.error : cell.error, o, k, wasIn});
        }
    }
    // Of equal ones in their order, so that the result is one.
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.urgency > b.urgency; });
    const std::size_t most = std::max(left / 2, fewestInRound);
    std::size_t spent = 0;
    for (const Candidate& c : candidates) {
        if (spent >= most) {
            kept[c.object][c.at] = 1;
            continue;
        }
        CellImage& image = *objects[c.object].object->cells;
        const PendingCell cell = image.pending()[c.at];
        const std::optional<std::size_t> searches =
            image.refine(cell, c.wasIn ? left : left - std::min(left, reserve));
        if (!searches) {
            image.giveUp(cell);
            continue;
        }
        spent += *searches;
        left -= *searches;
    }
    for (std::size_t o = 0; o < objects.size(); ++o)
        if (objects[o].object->cells) objects[o].object->cells->keepPending(kept[o]);
}

void VirtualObject::tell(const VirtualOptions& options) {
    settings = options;
    if (cells) cells->tell(options);
}

void VirtualObject::update(const ReflectorMap& map, const glm::dvec3& eye, std::span<Placed> objects,
                           double part) {
    VirtualOptions how;
    double budget = 0;
    std::size_t begun = 0;
    bool remembers = false, bounded = true;
    for (Placed& p : objects) {
        VirtualObject& o = *p.object;
        p.counts = {};
        p.counts.vertices = o.points.size();
        o.place = p.reflectorFromMesh;
        o.eyeAt = eye;
        o.waits = true;
        if (o.grid) o.onGrid(map, eye, p.reflectorFromMesh, p.counts);
        if (o.cells) budget += o.settings.share * static_cast<double>(o.points.size());
        bounded = bounded && o.settings.bounded;
        how = o.settings;
        remembers = remembers || o.settings.remember;
    }
    constexpr std::size_t unbounded = SIZE_MAX / 2;
    const std::size_t most = bounded ? static_cast<std::size_t>(std::max(part * budget, 0.0)) : unbounded;
    for (Placed& p : objects) {
        if (!p.object->cells) continue;
        std::size_t searches = p.object->cells->begin(map, eye, p.reflectorFromMesh);
        if (begun + searches > most) searches = p.object->cells->forget();
        begun += searches;
    }
    std::size_t left = most - std::min(most, begun);
    SearchBatch batch;
    for (bool first = true, any = true; any; first = false) {
        batch.places.clear();
        batch.guesses.clear();
        batch.pathPlaces.clear();
        batch.pathFrom.clear();
        any = false;
        for (Placed& p : objects) {
            p.object->waits = p.object->waits && p.object->ask(batch, first, p.counts, left);
            any = any || p.object->waits;
        }
        batch.answers.resize(batch.places.size());
        findReflectionPoints(map, eye, batch.places, batch.answers, how, batch.guesses);
        for (Placed& p : objects)
            if (p.object->waits) p.object->take(batch, p.counts);
        batch.paths.resize(batch.pathPlaces.size());
        perturbPaths(map, eye, glm::dmat3(1), batch.pathPlaces, batch.pathFrom, batch.paths);
        for (Placed& p : objects)
            if (p.object->waits && p.object->cells) p.object->cells->takePaths(batch);
        spend(objects, remembers ? most / keptShare : 0, left);
    }
    for (Placed& p : objects)
        for (const std::uint32_t k : p.object->broken) p.object->image[k] = {};
}

VirtualCounts VirtualObject::update(const ReflectorMap& map, const glm::dvec3& eye,
                                    const glm::dmat4& reflectorFromMesh) {
    Placed one{this, reflectorFromMesh, {}};
    update(map, eye, std::span(&one, 1));
    return one.counts;
}

}  // namespace reflection
