#include "reflection/chrome/VirtualMesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace reflection {

namespace {

/// Of the budget of meshes that are drawn; the rest is for what lies on their edges.
constexpr double forVertices = 0.75;

/// Positions, each once.
std::vector<glm::vec3> weld(std::span<const glm::vec3> positions, std::vector<std::uint32_t>& placeOf) {
    std::vector<glm::vec3> out;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
    placeOf.clear();
    for (const glm::vec3& p : positions) {
        // By their bits, so that what is not a number has a place, too; both zeros are one.
        const std::array<std::uint32_t, 3> key{std::bit_cast<std::uint32_t>(p.x + 0.f),
                                               std::bit_cast<std::uint32_t>(p.y + 0.f),
                                               std::bit_cast<std::uint32_t>(p.z + 0.f)};
        const auto [at, added] = known.try_emplace(key, static_cast<std::uint32_t>(out.size()));
        if (added) out.push_back(p);
        placeOf.push_back(at->second);
    }
    return out;
}

/// A mesh of those updated together.
struct Turn {
    VirtualMesh::Placed* placed;
    VirtualEdges* edges;
};

/// Does something for each of several meshes, on all cores where that is asked for.
template <class Do>
void each(std::span<const Turn> turns, bool threads, const Do& what) {
    if (threads)
        tbb::parallel_for(std::size_t{0}, turns.size(), [&](std::size_t k) { what(turns[k]); });
    else
        for (const Turn& t : turns) what(t);
}

/// Searches for what all meshes' edges ask for and no cell has answered, the most urgent first, as far as the
/// budget goes.
class EdgeSearches {
  public:
    void answer(const ReflectorMap& map, const glm::dvec3& eye, std::span<const Turn> turns,
                const VirtualOptions& options, std::size_t& left) {
        wanted.clear();
        for (std::uint32_t m = 0; m < turns.size(); ++m)
            for (EdgeProbe& probe : turns[m].edges->probes())
                if (!probe.answered) wanted.push_back({m, &probe});
        if (wanted.size() > left) {
            // Of equal ones in their order, so that the result is one.
            std::stable_sort(wanted.begin(), wanted.end(), [](const Wanted& a, const Wanted& b) {
                return a.probe->urgency > b.probe->urgency;
            });
            wanted.resize(left);
        }
        left -= wanted.size();
        places.clear();
        for (const Wanted& w : wanted) places.push_back(w.probe->place);
        answers.resize(places.size());
        findReflectionPoints(map, eye, places, answers, options);
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            const ReflectionPoint& r = answers[k];
            EdgeProbe& probe = *wanted[k].probe;
            probe.answered = true;
            probe.seen = {glm::vec3(virtualVertex(r, probe.place) - eye), r.status};
            probe.normal = r.normal;
            const glm::dvec3 toEye = eye - r.point;
            probe.facing = glm::dot(r.normal, toEye) / std::max(glm::length(toEye), 1e-300);
            VirtualCounts& counts = turns[wanted[k].mesh].placed->counts;
            ++counts.searched;
            counts.lookups += r.lookups;
        }
    }

  private:
    struct Wanted {
        std::uint32_t mesh;
        EdgeProbe* probe;
    };
    std::vector<Wanted> wanted;
    std::vector<glm::dvec3> places;
    std::vector<ReflectionPoint> answers;
};

}  // namespace

VirtualMesh::VirtualMesh(std::vector<glm::vec3> points, std::vector<std::uint32_t> indices,
                         const VirtualMeshOptions& options)
    : positions(std::move(points)),
      triangles(std::move(indices)),
      welded(weld(positions, placeOf)),
      object(welded, options.vertices) {}

void VirtualMesh::update(const ReflectorMap& map, const glm::dvec3& eye, std::span<Placed> meshes) {
    std::vector<VirtualObject::Placed> objects;
    std::vector<Turn> turns, open;
    double vertices = 0, share = 1;
    bool bounded = true;
    const VirtualOptions* options = nullptr;
    for (Placed& p : meshes) {
        if (!p.mesh->asOne(map, p.options)) {
            p.counts = p.mesh->updateConcave(map, eye, p.reflectorFromMesh, p.options);
            continue;
        }
        p.mesh->object.tell(p.options.vertices);
        objects.push_back({&p.mesh->object, p.reflectorFromMesh, {}});
        turns.push_back({&p, &p.mesh->edges});
        vertices += static_cast<double>(p.mesh->welded.size());
        share = std::min(share, p.options.vertices.share);
        bounded = bounded && p.options.vertices.bounded;
        options = &p.options.vertices;
    }
    if (turns.empty()) return;
    VirtualObject::update(map, eye, objects, forVertices);
    std::size_t searched = 0;
    for (std::size_t k = 0; k < turns.size(); ++k) {
        turns[k].placed->counts = objects[k].counts;
        searched += objects[k].counts.searched;
    }
    const bool threads = options->threads;
    each(turns, threads, [&](const Turn& t) {
        const VirtualMesh& m = *t.placed->mesh;
        t.edges->begin(map, eye, t.placed->reflectorFromMesh, t.placed->options,
                       {&m.object, m.welded, m.placeOf, m.triangles});
    });
    constexpr std::size_t unbounded = SIZE_MAX / 2;
    EdgeSearches searches;
    for (std::size_t spent = searched;;) {
        open.clear();
        double drawn = vertices;
        for (const Turn& t : turns) {
            if (t.edges->open()) open.push_back(t);
            drawn += static_cast<double>(t.edges->middles());
        }
        if (open.empty()) break;
        const auto most = static_cast<std::size_t>(std::max(share, 0.0) * drawn);
        const std::size_t budget = bounded && share < 1 ? most - std::min(most, spent) : unbounded;
        std::size_t left = budget;
        each(open, threads, [](const Turn& t) { t.edges->askMiddles(); });
        searches.answer(map, eye, open, *options, left);
        each(open, threads, [](const Turn& t) { t.edges->takeMiddles(); });
        std::vector<Turn> cutting = open;
        for (;;) {
            std::vector<std::uint8_t> asks(cutting.size(), 0);
            const Turn* first = cutting.data();
            each(cutting, threads,
                 [&](const Turn& t) { asks[static_cast<std::size_t>(&t - first)] = t.edges->askCuts(); });
            std::size_t to = 0;
            for (std::size_t k = 0; k < cutting.size(); ++k)
                if (asks[k] != 0) cutting[to++] = cutting[k];
            cutting.resize(to);
            if (cutting.empty()) break;
            searches.answer(map, eye, cutting, *options, left);
            each(cutting, threads, [](const Turn& t) { t.edges->takeCuts(); });
        }
        each(open, threads, [](const Turn& t) { t.edges->cutTriangles(); });
        spent += budget - left;
    }
}

float VirtualMesh::away() const {
    // Prime, so that corners of triangles take turns.
    constexpr std::size_t step = 7;
    float sum = 0;
    std::size_t n = 0;
    for (std::size_t k = 0; k < edges.drawn.size(); k += step, ++n)
        sum += glm::length(edges.image[edges.drawn[k]].fromEye);
    return n > 0 ? sum / static_cast<float>(n) : 0;
}

VirtualCounts VirtualMesh::update(const ReflectorMap& map, const glm::dvec3& eye,
                                  const glm::dmat4& reflectorFromMesh, const VirtualMeshOptions& options) {
    Placed one{this, reflectorFromMesh, options, {}};
    update(map, eye, std::span(&one, 1));
    return one.counts;
}

}  // namespace reflection
