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

/// A cell's reflection points lie no farther from the middle of its corners' than these do, times this.
constexpr double beyondCorners = 1.5;

/// Share of the tolerance by which slopes at corners may disagree in a cell that needs no check.
constexpr float surelySmooth = 0.3f;

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
      wasGood(tree.cells().size(), 0),
      wasRefined(tree.cells().size(), 0),
      leaves(tree.cells().size()) {}

void CellImage::tell(const VirtualOptions& options) {
    settings = options;
}

std::size_t CellImage::begin(const ReflectorMap& map, const glm::dvec3& eye,
                             const glm::dmat4& reflectorFromMesh) {
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
    scene.outline = static_cast<float>(outline);
    scene.widest = static_cast<float>(widestCell * widestCell * outline * outline);
    smooth.clear();
    checked.clear();
    exact.clear();
    exactGuesses.clear();
    next.clear();
    waiting.clear();
    if (tree.cells().empty()) return 0;
    // Cells that were cut the last time are cut again without being looked at, but for every 16th.
    next.push_back(0);
    openRemembered(0, true);
    return *charge(next, SIZE_MAX);
}

void CellImage::openRemembered(std::size_t k, bool judgeAnew) {
    while (k < next.size()) {
        const CellTree::Cell& cell = tree.cells()[next[k]];
        std::uint8_t& cut = wasCut[next[k]];
        if (!settings.remember || (judgeAnew && cut != 0 && (next[k] + update) % rejudged == 0)) cut = 0;
        if (cut == 0 || cell.count == 0) {
            ++k;
            continue;
        }
        wasRefined[next[k]] = update;
        next[k] = cell.children;
        for (std::uint32_t c = 1; c < cell.count; ++c) next.push_back(cell.children + c);
    }
}

std::optional<SeenInCell> CellImage::at(const glm::vec3& place) const {
    if (tree.cells().empty()) return std::nullopt;
    const auto within = [&](const CellTree::Cell& cell) {
        const glm::vec3& side = tree.side(cell.level);
        for (int a = 0; a < 3; ++a)
            if (!(place[a] >= cell.low[a] && place[a] <= cell.low[a] + side[a])) return false;
        return true;
    };
    if (!within(tree.cells()[0])) return std::nullopt;
    for (std::uint32_t id = 0;;) {
        const CellTree::Cell& cell = tree.cells()[id];
        if (leaves[id].update == update) {
            const SmoothCell& s = smooth[leaves[id].at];
            // Torn, and interpolated for want of better.
            if (s.straight && s.status == ReflectionStatus::found) return std::nullopt;
            const glm::vec4 v = interpolateIn(tree, images, cell, place);
            ReflectionStatus status = s.status;
            if (status == ReflectionStatus::invalid) {
                if (!(std::abs(v.w) > s.doubt)) return std::nullopt;
                status = v.w > 0 ? ReflectionStatus::found : ReflectionStatus::hidden;
            }
            return SeenInCell{{glm::vec3(v), status}, v.w};
        }
        std::uint32_t child = cell.children;
        const std::uint32_t end = cell.children + cell.count;
        while (child < end && !within(tree.cells()[child])) ++child;
        if (child == end) return std::nullopt;
        id = child;
    }
}

std::size_t CellImage::forget() {
    if (tree.cells().empty()) return 0;
    std::fill(wasCut.begin(), wasCut.end(), std::uint8_t{0});
    for (Node& n : nodes) n.charged = 0;
    next.assign(1, 0);
    return *charge(next, SIZE_MAX);
}

bool CellImage::ask(SearchBatch& batch, std::span<VirtualVertex> image, VirtualCounts& counts,
                    std::size_t& left) {
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
    if (open.empty() && askedChecks.empty() && waiting.empty() && !interpolated) {
        interpolated = true;
        doubtful.clear();
        interpolateCells(tree, images, smooth, image, doubtful);
        for (std::uint32_t k = 0; k < smooth.size(); ++k) leaves[smooth[k].cell] = {update, k};
        counts.atOutlines += doubtful.size();
        // Of those that are left the cosine's sign tells; it is wrong by a hair's breadth on screen.
        doubtful.resize(std::min(doubtful.size(), left));
        left -= doubtful.size();
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
    return batch.places.size() > firstAnswer || !open.empty() || !waiting.empty();
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
        const float off = offBy(s, *r);
        if (off > 0)
            waiting.push_back({off, s, false});
        else
            smooth.push_back(s);
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
            waiting.push_back({j.error, j.cell, false});
            continue;
        }
        const bool again = !settings.remember || wasGood[id] + 1 != update || (id + update) % rechecked == 0;
        wasGood[id] = update;
        if (j.kind == Judgement::Kind::check && again)
            waiting.push_back({j.error, j.cell, true});
        else
            smooth.push_back(j.cell);
    }
}

bool CellImage::wasIn(const PendingCell& p) const {
    return settings.remember && !p.check && wasRefined[p.cell.cell] + 1 == update;
}

std::optional<std::size_t> CellImage::refine(const PendingCell& p, std::size_t left) {
    if (left == 0) return std::nullopt;
    const std::uint32_t id = p.cell.cell;
    if (p.check) {
        checked.push_back(p.cell);
        return 1;
    }
    const CellTree::Cell& cell = tree.cells()[id];
    std::size_t searches = cell.vertices();
    if (cell.count == 0 || cell.vertices() <= 2 * newNodes(cell)) {
        if (searches > left) return std::nullopt;
        for (std::uint32_t v = cell.first; v < cell.last; ++v) {
            exact.push_back(v);
            exactGuesses.push_back(guessIn(cell, v));
        }
    } else {
        const std::size_t first = next.size();
        for (std::uint32_t c = 0; c < cell.count; ++c) next.push_back(cell.children + c);
        // Bent as before: what it was cut into need not be found anew.
        if (wasIn(p)) openRemembered(first, false);
        const std::optional<std::size_t> charged = charge(std::span(next).subspan(first), left);
        if (!charged) {
            next.resize(first);
            return std::nullopt;
        }
        searches = *charged;
        wasCut[id] = 1;
    }
    wasGood[id] = 0;
    wasRefined[id] = update;
    return searches;
}

void CellImage::giveUp(const PendingCell& p) {
    // So that it is looked at again.
    wasGood[p.cell.cell] = 0;
    smooth.push_back(p.cell);
}

void CellImage::keepPending(std::span<const std::uint8_t> kept) {
    std::size_t to = 0;
    for (std::size_t k = 0; k < waiting.size(); ++k)
        if (kept[k] != 0) waiting[to++] = waiting[k];
    waiting.resize(to);
}

std::optional<std::size_t> CellImage::charge(std::span<const std::uint32_t> cells, std::size_t left) {
    justCharged.clear();
    for (const std::uint32_t id : cells)
        for (const std::uint32_t n : tree.cells()[id].nodes)
            if (nodes[n].charged != update) {
                nodes[n].charged = update;
                justCharged.push_back(n);
            }
    if (justCharged.size() <= left) return justCharged.size();
    for (const std::uint32_t n : justCharged) nodes[n].charged = 0;
    return std::nullopt;
}

float CellImage::extentOf(const CellTree::Cell& cell) const {
    float widest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 a(images[cell.nodes[i]].image), b(images[cell.nodes[7 - i]].image);
        const float apart = glm::length(glm::normalize(a) - glm::normalize(b));
        if (!(apart <= widest)) widest = apart;
    }
    return widest <= 2 * scene.outline ? widest : 2 * scene.outline;
}

std::size_t CellImage::newNodes(const CellTree::Cell& cell) const {
    std::size_t n = 0;
    for (std::uint32_t c = cell.children; c < cell.children + cell.count; ++c)
        for (const std::uint32_t node : tree.cells()[c].nodes) n += nodes[node].charged != update;
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

bool CellImage::clearOfPart(const CellTree::Cell& cell) const {
    const ReflectorMap& map = *scene.map;
    if (map.closed()) return false;
    std::array<glm::dvec3, 8> at;
    glm::dvec3 middle(0);
    for (std::size_t k = 0; k < 8; ++k) {
        at[k] = map.frame().toMap(nodes[cell.nodes[k]].point);
        if (map.covered(at[k])) return false;
        middle += at[k] / 8.0;
    }
    double farthest = 0;
    for (const glm::dvec3& p : at) {
        const double d = glm::length((p - middle) / map.frame().stretch);
        if (!(d <= farthest)) farthest = d;
    }
    // What is not a number is not clear of anything.
    return beyondCorners * farthest < map.fromRim(middle);
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
        if (clearOfPart(cell)) return j;
        const float extent = extentOf(cell), chord = extent * extent;
        j.error = leftOut * extent;
        j.kind = chord <= scene.unbent ? Kind::smooth : (chord <= scene.widest ? Kind::check : Kind::bent);
        return j;
    }
    const bool mixed = hidden > 0;
    // Torn, and if it stays: seen as if any corner is. What hides the others is drawn in front.
    j.cell.straight = true;
    j.error = extentOf(cell);
    if (mixed ? !scene.convex || found + hidden < 8 : found < 8) return j;
    if (turn != 8 && turn != -8) return j;
    j.cell.straight = false;
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
    j.error = leftOut * (std::sqrt(worst[0]) + std::sqrt(worst[1]) + std::sqrt(worst[2]));
    j.cell.doubt = 3 * leftOut * cosines + leastDoubt;
    // Written so that what is not a number is bent.
    if (!(widest <= scene.widest) || !(j.error <= static_cast<float>(settings.cellTolerance))) {
        j.kind = Kind::bent;
        if (!(widest <= scene.widest) || !(j.error >= 0)) j.error = leftOut * extentOf(cell);
    } else
        j.kind = widest > scene.unbent &&
                         (mixed || j.error > surelySmooth * static_cast<float>(settings.cellTolerance))
                     ? Kind::check
                     : Kind::smooth;
    return j;
}

float CellImage::offBy(const SmoothCell& s, const ReflectionPoint& r) const {
    const CellTree::Cell& cell = tree.cells()[s.cell];
    const glm::vec4 expected = interpolateIn(tree, images, cell, position(cell.probe));
    if (s.straight) return r.status != ReflectionStatus::found ? 0 : extentOf(cell);
    ReflectionStatus status = s.status;
    if (status == ReflectionStatus::invalid)
        status = std::abs(expected.w) <= s.doubt
                     ? r.status
                     : (expected.w > 0 ? ReflectionStatus::found : ReflectionStatus::hidden);
    if (status != r.status) return extentOf(cell);
    if (status != ReflectionStatus::found) return 0;
    const glm::vec3 exactly(virtualVertex(r, scene.place(position(cell.probe))) - scene.eye);
    const float off = glm::length(glm::normalize(glm::vec3(expected)) - glm::normalize(exactly));
    if (off <= static_cast<float>(settings.cellTolerance)) return 0;
    return off <= 2 * scene.outline ? off : 2 * scene.outline;
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
