#include "reflection/chrome/CellImage.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace reflection {

namespace {

/// Cells of no more vertices are searched for vertex by vertex instead of being cut.
constexpr std::uint32_t fewestInCell = 8;

/// Of the third-order part of a value along an edge, at most: what cubics leave out where slopes at its ends
/// are off by as much (bilinear normals, two halves of a surface).
constexpr float leftOut = 0.1f;

/// A cell that covers more of the picture than this share of the reflector's radius there is not judged by
/// its corners, whatever they say.
constexpr double widestCell = 0.5;

/// Every so many updates a cell that was cut is judged anew: as a picture gets smaller it needs fewer.
constexpr std::uint32_t rejudged = 16;
/// Every so many updates a cell that was smooth and still is by its corners is checked again.
constexpr std::uint32_t rechecked = 8;

/// Cosines nearer to zero than this are not told apart: images there lie within a millionth of the
/// reflector's radius of its outline.
constexpr float leastDoubt = 1e-5f;

}  // namespace

CellImage::CellImage(std::span<const glm::vec3> positions, const VirtualOptions& options)
    : settings(options),
      tree(positions, fewestInCell),
      nodes(tree.nodes().size()),
      images(tree.nodes().size()),
      wasCut(tree.cells().size(), 0),
      wasGood(tree.cells().size(), 0) {}

void CellImage::begin(const ReflectorMap& map, const glm::dvec3& eye, const glm::dmat4& reflectorFromMesh) {
    ++update;
    interpolated = false;
    const double reach = map.empty() ? 0
                                     : map.frame().scale * map.outerRadius() /
                                           std::max(glm::length(eye - map.frame().centre), 1e-300);
    const double outline = std::asin(std::min(reach, 1.0));
    scene.map = &map;
    scene.eye = eye;
    scene.reflectorFromMesh = reflectorFromMesh;
    scene.convex = map.bend() == Bend::convex;
    // Images bend about as the reflector's outline does, as in VirtualMesh.
    scene.unbent = static_cast<float>(settings.cellTolerance * outline);
    scene.widest = static_cast<float>(widestCell * widestCell * outline * outline);
    smooth.clear();
    checked.clear();
    exact.clear();
    exactGuesses.clear();
    next.clear();
    if (tree.cells().empty()) return;
    // Cells that were cut the last time are cut again without being looked at, but for every 16th.
    next.push_back(0);
    for (std::size_t k = 0; k < next.size();) {
        const CellTree::Cell& cell = tree.cells()[next[k]];
        std::uint8_t& cut = wasCut[next[k]];
        if (!settings.remember || (cut != 0 && (next[k] + update) % rejudged == 0)) cut = 0;
        if (cut == 0 || cell.count == 0) {
            ++k;
            continue;
        }
        next[k] = cell.children;
        for (std::uint32_t c = 1; c < cell.count; ++c) next.push_back(cell.children + c);
    }
}

bool CellImage::ask(SearchBatch& batch, std::span<VirtualVertex> image, VirtualCounts& counts) {
    firstAnswer = batch.places.size();
    open.swap(next);
    next.clear();
    askedNodes.clear();
    for (const std::uint32_t id : open)
        for (const std::uint32_t n : tree.cells()[id].nodes)
            if (nodes[n].known != update) {
                nodes[n].known = update;
                askedNodes.push_back(n);
                batch.ask(scene.place(tree.nodes()[n]), settings.remember ? nodes[n].point : glm::dvec3(NAN));
            }
    askedChecks.swap(checked);
    checked.clear();
    for (const SmoothCell& s : askedChecks) {
        const CellTree::Cell& cell = tree.cells()[s.cell];
        batch.ask(scene.place(position(cell.probe)), guessIn(cell, cell.probe));
    }
    if (open.empty() && askedChecks.empty() && !interpolated) {
        interpolated = true;
        doubtful.clear();
        interpolateCells(tree, images, smooth, image, doubtful);
        counts.atOutlines += doubtful.size();
        exact.insert(exact.end(), doubtful.begin(), doubtful.end());
        exactGuesses.resize(exact.size(), glm::dvec3(NAN));
    }
    // Vertices that are searched for themselves come last, so that nothing else has to wait for them.
    askedExact.clear();
    if (interpolated) {
        askedExact.swap(exact);
        for (std::size_t k = 0; k < askedExact.size(); ++k)
            batch.ask(scene.place(position(askedExact[k])), exactGuesses[k]);
    }
    return batch.places.size() > firstAnswer || !open.empty();
}

void CellImage::take(SearchBatch& batch, std::span<VirtualVertex> image, VirtualCounts& counts) {
    const ReflectionPoint* r = batch.answers.data() + firstAnswer;
    const glm::dvec3* place = batch.places.data() + firstAnswer;
    firstPath = batch.pathPlaces.size();
    askedPaths.clear();
    counts.nodes += askedNodes.size();
    for (const std::uint32_t n : askedNodes) {
        counts.add(*r);
        nodes[n].status = r->status;
        nodes[n].point = r->point;
        images[n] = {glm::vec4(virtualVertex(*r, *place) - scene.eye, 0), {}, 0};
        if (r->status != ReflectionStatus::hidden) {
            askedPaths.push_back(n);
            batch.pathPlaces.push_back(*place);
            batch.pathFrom.push_back(r->point);
        }
        ++r, ++place;
    }
    counts.inBentCells += askedChecks.size() + askedExact.size();
    for (const SmoothCell& s : askedChecks) {
        counts.add(*r);
        if (confirms(s, *r))
            smooth.push_back(s);
        else
            fail(s.cell);
        ++r, ++place;
    }
    for (const std::uint32_t v : askedExact) {
        counts.add(*r);
        image[tree.order()[v]] = {glm::vec3(virtualVertex(*r, *place) - scene.eye), r->status};
        ++r, ++place;
    }
    if (scene.convex) continueHidden(batch);
}

void CellImage::takePaths(const SearchBatch& batch) {
    for (std::size_t k = 0; k < askedPaths.size(); ++k) {
        const PathImage& made = batch.paths[firstPath + k];
        if (made.turn == 0) continue;
        PathImage& image = images[askedPaths[k]];
        image.image = made.image;
        image.turn = made.turn;
        // Slopes come along the reflector's axes.
        for (int a = 0; a < 3; ++a) {
            const glm::vec3 along(scene.reflectorFromMesh[a]);
            image.by[static_cast<std::size_t>(a)] =
                along.x * made.by[0] + along.y * made.by[1] + along.z * made.by[2];
        }
    }
    for (const std::uint32_t id : open) {
        const Judgement j = judge(id);
        if (j.kind == Judgement::Kind::torn || j.kind == Judgement::Kind::bent) {
            fail(id);
            continue;
        }
        const bool again = !settings.remember || wasGood[id] + 1 != update || (id + update) % rechecked == 0;
        wasGood[id] = update;
        (j.kind == Judgement::Kind::check && again ? checked : smooth).push_back(j.cell);
    }
}

void CellImage::fail(std::uint32_t id) {
    const CellTree::Cell& cell = tree.cells()[id];
    wasGood[id] = 0;
    if (cell.count == 0 || cell.vertices() <= 2 * newNodes(cell)) {
        for (std::uint32_t v = cell.first; v < cell.last; ++v) {
            exact.push_back(v);
            exactGuesses.push_back(guessIn(cell, v));
        }
        return;
    }
    wasCut[id] = 1;
    for (std::uint32_t c = 0; c < cell.count; ++c) next.push_back(cell.children + c);
}

std::size_t CellImage::newNodes(const CellTree::Cell& cell) const {
    std::size_t n = 0;
    for (std::uint32_t c = cell.children; c < cell.children + cell.count; ++c)
        for (const std::uint32_t node : tree.cells()[c].nodes) n += nodes[node].known != update;
    // Nodes that children share are counted once for each: about half are.
    return n / 2;
}

glm::dvec3 CellImage::guessIn(const CellTree::Cell& cell, std::uint32_t place) const {
    const glm::vec3& side = tree.side(cell.level);
    glm::dvec3 sum(0);
    double weights = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        const Node& node = nodes[cell.nodes[i]];
        if (node.status == ReflectionStatus::hidden) continue;
        float w = 1;
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = static_cast<int>(a);
            const float u = side[axis] > 0 ? (tree.along(axis)[place] - cell.low[axis]) / side[axis] : 0.f;
            w *= ((i >> a) & 1) != 0 ? u : 1 - u;
        }
        sum += static_cast<double>(w) * node.point;
        weights += static_cast<double>(w);
    }
    return weights > 1e-3 ? sum / weights : glm::dvec3(NAN);
}

CellImage::Judgement CellImage::judge(std::uint32_t id) const {
    const CellTree::Cell& cell = tree.cells()[id];
    const std::array<std::uint32_t, 8>& n = cell.nodes;
    int found = 0, hidden = 0, turn = 0;
    for (const std::uint32_t k : n) {
        found += nodes[k].status == ReflectionStatus::found;
        hidden += nodes[k].status == ReflectionStatus::hidden;
        turn += images[k].turn;
    }
    Judgement j;
    j.cell.cell = id;
    using Kind = Judgement::Kind;
    if (found == 0) {
        // Drawn at borders at most. What a convex body hides is convex; past the part's rim the closing
        // surface may have creases, and what is past some of it is taken for hidden.
        j.cell.status = hidden > 0 ? ReflectionStatus::hidden : ReflectionStatus::unreflected;
        j.cell.straight = true;
        j.kind = Kind::smooth;
        if (hidden == 8 && scene.convex) return j;
        float chord = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::vec3 a(images[n[i]].image), b(images[n[7 - i]].image);
            const glm::vec3 d = glm::normalize(a) - glm::normalize(b);
            chord = std::max(chord, glm::dot(d, d));
        }
        j.kind = chord <= scene.unbent ? Kind::smooth : (chord <= scene.widest ? Kind::check : Kind::bent);
        return j;
    }
    const bool mixed = hidden > 0;
    if (mixed ? !scene.convex || found + hidden < 8 : found < 8) return j;
    if (turn != 8 && turn != -8) return j;
    j.cell.status = mixed ? ReflectionStatus::invalid : ReflectionStatus::found;
    const glm::vec3& side = tree.side(cell.level);
    float worst[3] = {0, 0, 0}, cosines = 0, widest = 0;
    for (std::uint32_t a = 0; a < 3; ++a) {
        const float s = side[static_cast<int>(a)];
        if (!(s > 0)) continue;
        for (std::uint32_t i = 0; i < 8; ++i) {
            if (((i >> a) & 1) != 0) continue;
            const PathImage &from = images[n[i]], &to = images[n[i + (1U << a)]];
            const glm::vec4 chord = to.image - from.image;
            const glm::vec4 r = chord - 0.5f * s * (from.by[a] + to.by[a]);
            const glm::vec3 f(from.image), across(r), along(chord);
            const float perSquare = 1 / glm::dot(f, f);
            const float rf = glm::dot(across, f), cf = glm::dot(along, f);
            const float off = (glm::dot(across, across) - rf * rf * perSquare) * perSquare;
            const float wide = (glm::dot(along, along) - cf * cf * perSquare) * perSquare;
            worst[a] = std::max(worst[a], off);
            widest = std::max(widest, wide);
            cosines = std::max(cosines, std::abs(r.w));
        }
    }
    const float error = leftOut * (std::sqrt(worst[0]) + std::sqrt(worst[1]) + std::sqrt(worst[2]));
    j.cell.doubt = 3 * leftOut * cosines + leastDoubt;
    // Written so that what is not a number is bent.
    if (!(widest <= scene.widest) || !(error <= static_cast<float>(settings.cellTolerance)))
        j.kind = Kind::bent;
    else
        j.kind = widest > scene.unbent ? Kind::check : Kind::smooth;
    return j;
}

bool CellImage::confirms(const SmoothCell& s, const ReflectionPoint& r) const {
    const CellTree::Cell& cell = tree.cells()[s.cell];
    const glm::vec4 expected = interpolateIn(tree, images, cell, cell.probe);
    if (s.straight) return r.status != ReflectionStatus::found;
    ReflectionStatus status = s.status;
    if (status == ReflectionStatus::invalid)
        status = std::abs(expected.w) <= s.doubt
                     ? r.status
                     : (expected.w > 0 ? ReflectionStatus::found : ReflectionStatus::hidden);
    if (status != r.status) return false;
    if (status != ReflectionStatus::found) return true;
    const glm::vec3 exactly(virtualVertex(r, scene.place(position(cell.probe))) - scene.eye);
    return glm::length(glm::normalize(glm::vec3(expected)) - glm::normalize(exactly)) <=
           static_cast<float>(settings.cellTolerance);
}

void CellImage::continueHidden(SearchBatch& batch) {
    for (const std::uint32_t id : open) {
        const std::array<std::uint32_t, 8>& n = tree.cells()[id].nodes;
        int found = 0, hidden = 0;
        for (const std::uint32_t k : n) {
            found += nodes[k].status == ReflectionStatus::found;
            hidden += nodes[k].status == ReflectionStatus::hidden;
        }
        if (found == 0 || found + hidden < 8 || hidden == 0) continue;
        for (std::uint32_t i = 0; i < 8; ++i) {
            Node& node = nodes[n[i]];
            if (node.status != ReflectionStatus::hidden || node.continued == update) continue;
            node.continued = update;
            // From where the nearest corner that is seen has its point: fewest edges away.
            std::uint32_t best = 0;
            int least = 4;
            for (std::uint32_t k = 0; k < 8; ++k) {
                const int edges = std::popcount(i ^ k);
                if (nodes[n[k]].status == ReflectionStatus::found && edges < least) least = edges, best = k;
            }
            askedPaths.push_back(n[i]);
            batch.pathPlaces.push_back(scene.place(tree.nodes()[n[i]]));
            batch.pathFrom.push_back(nodes[n[best]].point);
        }
    }
}

}  // namespace reflection
