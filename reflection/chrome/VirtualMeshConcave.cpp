#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "reflection/chrome/ConcaveImages.h"
#include "reflection/chrome/VirtualMesh.h"
#include "reflection/chrome/VirtualTriangles.h"

namespace reflection {

namespace {

/// Something of an edge that its middle's images tell.
struct EdgeCheck {
    std::uint32_t a, b;
    bool ends;  ///< an image of one end has none at the other
};

/// A pair of images at an edge's ends of which no middle lies between.
std::uint64_t tornKey(std::uint32_t a, std::uint32_t b) {
    return edgeKey(a, b);
}

}  // namespace

VirtualCounts VirtualMesh::updateConcave(const ReflectorMap& map, const glm::dvec3& eye,
                                         const glm::dmat4& reflectorFromMesh,
                                         const VirtualMeshOptions& options) {
    VirtualCounts counts;
    counts.vertices = positions.size();
    std::vector<VirtualVertex>& image = edges.image;
    std::vector<MiddleVertex>& added = edges.added;
    std::vector<std::uint32_t>& drawn = edges.drawn;
    added.clear();
    drawn.clear();
    image.assign(positions.size(), {});
    std::vector<glm::dvec3> places;
    places.reserve(positions.size());
    for (const glm::vec3& p : positions)
        places.push_back(glm::dvec3(reflectorFromMesh * glm::dvec4(glm::dvec3(p), 1)));
    if (map.empty() || !std::isfinite(eye.x + eye.y + eye.z)) return counts;
    const ConcaveImages search(map, eye, options.vertices.search);
    std::vector<std::vector<PlaceImage>> images = search.ofMesh(places, triangles, options.vertices.share);

    /// The vertex that stands for a place itself, whose values others of its images share.
    std::vector<std::uint32_t> base(places.size());
    const auto enter = [&](std::uint32_t place) {
        for (std::size_t k = 0; k < images[place].size(); ++k) {
            PlaceImage& i = images[place][k];
            const VirtualVertex seen{i.fromEye,
                                     i.onPart ? ReflectionStatus::found : ReflectionStatus::unreflected};
            i.vertex = base[place];
            if (k == 0) {
                image[base[place]] = seen;
                continue;
            }
            i.vertex = static_cast<std::uint32_t>(image.size());
            added.push_back({base[place], base[place], 0});
            image.push_back(seen);
        }
    };
    for (std::uint32_t k = 0; k < places.size(); ++k) base[k] = k;
    for (std::uint32_t k = 0; k < places.size(); ++k) {
        enter(k);
        counts.found += !images[k].empty() && images[k].front().onPart;
        counts.unreflected += images[k].empty() || !images[k].front().onPart;
    }

    const double cone = options.coneCosine > -1 ? std::acos(std::min(options.coneCosine, 1.0)) : -1;
    const double unbent = cone >= 0 ? std::sqrt(options.tolerance * cone) : 0.25 * options.tolerance;
    const auto outside = [&](const PlaceImage& a, const PlaceImage& b, double length) {
        return cone >= 0 && angleToArc(options.towards, glm::dvec3(a.fromEye), glm::dvec3(b.fromEye)) >
                                cone + 0.5 * length;
    };
    std::vector<VirtualTriangle> open, next;
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
        open.push_back({triangles[k], triangles[k + 1], triangles[k + 2]});
    std::unordered_map<std::uint64_t, std::uint32_t> halved;
    std::unordered_map<std::uint64_t, char> torn;
    std::vector<EdgeCheck> asked;
    for (int depth = 0; !open.empty(); ++depth) {
        const bool last = depth >= options.mostHalvings;
        asked.clear();
        for (const VirtualTriangle& t : open)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                if ((images[a].empty() && images[b].empty()) ||
                    !halved.try_emplace(edgeKey(a, b), straightEdge).second)
                    continue;
                const std::vector<std::uint32_t> there = matches(images[a], images[b]);
                std::size_t pairs = 0;
                bool longer = false, seen = false;
                for (std::size_t i = 0; i < there.size(); ++i) {
                    if (there[i] == PlaceImage::none) continue;
                    ++pairs;
                    const PlaceImage &u = images[a][i], &v = images[b][there[i]];
                    const double length = apartOf(u.fromEye, v.fromEye);
                    if (outside(u, v, length)) continue;
                    seen = true;
                    longer = longer || length > unbent;
                }
                const bool ends = pairs < std::max(images[a].size(), images[b].size());
                const double size = glm::distance(places[a], places[b]);
                // Smaller than what can be seen, wherever it shows.
                const bool tiny = size <= options.tolerance * glm::distance(places[a], eye);
                if ((ends && !tiny) || (seen && longer)) asked.push_back({a, b, ends && !tiny});
            }
        for (const EdgeCheck& edge : asked) {
            const std::uint32_t a = edge.a, b = edge.b;
            const glm::dvec3 middle = 0.5 * (places[a] + places[b]);
            std::vector<PlaceImage> between;
            search.follow(middle, images[a], between);
            search.follow(middle, images[b], between);
            counts.searched += images[a].size() + images[b].size();
            bool halve = edge.ends;
            const std::vector<std::uint32_t> there = matches(images[a], images[b]);
            for (std::size_t i = 0; i < there.size(); ++i) {
                if (there[i] == PlaceImage::none) continue;
                const PlaceImage &u = images[a][i], &v = images[b][there[i]];
                const glm::vec3 straight = 0.5f * (u.fromEye + v.fromEye);
                double off = 2;
                for (const PlaceImage& m : between) off = std::min(off, apartOf(m.fromEye, straight));
                halve = halve || off > options.tolerance;
                if (last && off > tornShare * apartOf(u.fromEye, v.fromEye) && off > options.tolerance)
                    torn[tornKey(u.vertex, v.vertex)] = 1;
            }
            if (!halve || last) continue;
            const auto place = static_cast<std::uint32_t>(places.size());
            places.push_back(middle);
            base.push_back(static_cast<std::uint32_t>(image.size()));
            added.push_back({base[a], base[b], 0.5f});
            image.emplace_back();
            images.push_back(std::move(between));
            enter(place);
            halved[edgeKey(a, b)] = place;
        }
        next.clear();
        for (const VirtualTriangle& t : open) {
            VirtualTriangle middle{straightEdge, straightEdge, straightEdge};
            bool whole = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto entry = halved.find(edgeKey(t[k], t[(k + 1) % 3]));
                if (entry != halved.end()) middle[k] = entry->second;
                whole = whole && middle[k] == straightEdge;
            }
            if (!whole) {
                cutTriangle(t, middle, next);
                continue;
            }
            // Each image goes round the triangle, or ends in it.
            const std::vector<std::uint32_t> ab = matches(images[t[0]], images[t[1]]),
                                             bc = matches(images[t[1]], images[t[2]]),
                                             ca = matches(images[t[2]], images[t[0]]);
            for (std::uint32_t i = 0; i < ab.size(); ++i) {
                const std::uint32_t j = ab[i], k = j == PlaceImage::none ? j : bc[j];
                if (k == PlaceImage::none || ca[k] != i) continue;
                const PlaceImage &u = images[t[0]][i], &v = images[t[1]][j], &w = images[t[2]][k];
                if (!(u.onPart || v.onPart || w.onPart)) continue;
                if (torn.contains(tornKey(u.vertex, v.vertex)) ||
                    torn.contains(tornKey(v.vertex, w.vertex)) || torn.contains(tornKey(w.vertex, u.vertex)))
                    continue;
                drawn.insert(drawn.end(), {u.vertex, v.vertex, w.vertex});
            }
        }
        open.swap(next);
    }
    counts.searched += search.searched();
    return counts;
}

}  // namespace reflection
