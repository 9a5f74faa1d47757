#include "app/commands/HollowImages.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "app/mirrors/TrueReflection.h"

namespace app {

using reflection::PlaceImage;

HollowImages hollowImages(const reflection::ReflectorMap& map, const glm::dvec3& eye,
                          std::span<const CloseMesh> meshes, double share,
                          const reflection::SearchOptions& search) {
    HollowImages out;
    const reflection::ConcaveImages images(map, eye, search);
    for (const CloseMesh& m : meshes) {
        const std::vector<glm::dvec3> places(m.positions.begin(), m.positions.end());
        out.meshes.push_back(images.ofMesh(places, m.indices, share));
    }
    out.searched = images.searched();
    return out;
}

HollowTruth hollowTruth(const StagedChrome& part, const glm::dvec3& eye, const PixelPlace& place,
                        const HollowImages& found) {
    HollowTruth out;
    const reflection::MapFrame& frame = part.reflector.pieces.front().built.map.frame();
    const TrueReflection truth(*part.mirror);
    for (const CloseMesh& m : part.close) {
        std::vector<std::vector<glm::dvec2>>& seen = out.emplace_back(m.positions.size());
        tbb::parallel_for(std::size_t{0}, m.positions.size(), [&](std::size_t k) {
            std::vector<glm::dvec3> besides;
            for (const PlaceImage& i : found.meshes[out.size() - 1][k])
                if (i.onPart) besides.push_back(frame.fromMap(i.point));
            for (const TruePoint& t : truth.all(eye, glm::dvec3(m.positions[k]), besides))
                seen[k].push_back(place.of(t.position - eye));
        });
    }
    return out;
}

HollowErrors hollowErrors(const HollowImages& full, const HollowImages& some, const HollowTruth& truth,
                          const PixelPlace& place) {
    HollowErrors out;
    for (std::size_t m = 0; m < full.meshes.size(); ++m)
        for (std::size_t k = 0; k < full.meshes[m].size(); ++k) {
            const std::vector<PlaceImage>&all = full.meshes[m][k], &here = some.meshes[m][k];
            const std::vector<std::uint32_t> same = reflection::matches(all, here);
            for (std::size_t i = 0; i < all.size(); ++i) {
                const glm::dvec2 at = place.of(glm::dvec3(all[i].fromEye));
                if (!all[i].onPart || !place.inside(at)) continue;
                if (same[i] == PlaceImage::none) {
                    ++out.lost;
                    continue;
                }
                const glm::dvec2 seen = place.of(glm::dvec3(here[same[i]].fromEye));
                out.fromFull.push_back(glm::distance(at, seen));
                double nearest = INFINITY;
                for (const glm::dvec2& t : truth[m][k]) nearest = std::min(nearest, glm::distance(t, seen));
                if (std::isfinite(nearest))
                    out.fromTruth.push_back(nearest);
                else
                    ++out.untrue;
            }
        }
    return out;
}

void HollowFollower::step(const HollowImages& now, double floorPixels, const Told& told) {
    std::vector<std::vector<std::vector<Move>>> moved(now.meshes.size());
    const auto pixel = [&](const PlaceImage& i) { return place_.of(glm::dvec3(i.fromEye)); };
    const auto shown = [&](const PlaceImage& i) { return i.onPart && place_.inside(pixel(i)); };
    const bool first = before_.meshes.empty();
    for (std::size_t m = 0; m < now.meshes.size() && !first; ++m) {
        moved[m].resize(now.meshes[m].size());
        for (std::size_t k = 0; k < now.meshes[m].size(); ++k) {
            const std::vector<PlaceImage>&then = before_.meshes[m][k], &here = now.meshes[m][k];
            const std::vector<std::uint32_t> from = reflection::matches(here, then),
                                             to = reflection::matches(then, here);
            moved[m][k].resize(here.size());
            for (std::size_t i = 0; i < then.size(); ++i) goes += shown(then[i]) && to[i] == PlaceImage::none;
            for (std::size_t i = 0; i < here.size(); ++i) {
                if (!shown(here[i])) continue;
                if (from[i] == PlaceImage::none) {
                    ++comes;
                    continue;
                }
                if (!shown(then[from[i]])) continue;
                Move& move = moved[m][k][i];
                move = {true, pixel(here[i]) - pixel(then[from[i]])};
                if (told) told(m, k, pixel(then[from[i]]), pixel(here[i]));
                if (!last_.empty() && !last_[m].empty() && last_[m][k][from[i]].known)
                    own = std::max(own, glm::distance(move.by, last_[m][k][from[i]].by));
            }
        }
    }
    for (std::size_t m = 0; m < now.meshes.size() && !first; ++m) {
        // Largest move among an image's own in neighbours; below 0: none.
        std::vector<std::vector<double>> around(moved[m].size());
        for (std::size_t k = 0; k < moved[m].size(); ++k) around[k].assign(moved[m][k].size(), -1);
        const std::vector<std::uint32_t>& indices = meshes_[m].indices;
        for (std::size_t t = 0; t + 2 < indices.size(); t += 3)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t a = indices[t + c], b = indices[t + (c + 1) % 3];
                const std::vector<std::uint32_t> same =
                    reflection::matches(now.meshes[m][a], now.meshes[m][b]);
                for (std::size_t i = 0; i < same.size(); ++i) {
                    if (same[i] == PlaceImage::none) continue;
                    const Move &u = moved[m][a][i], &v = moved[m][b][same[i]];
                    if (v.known) around[a][i] = std::max(around[a][i], glm::length(v.by));
                    if (u.known) around[b][same[i]] = std::max(around[b][same[i]], glm::length(u.by));
                }
            }
        for (std::size_t k = 0; k < moved[m].size(); ++k)
            for (std::size_t i = 0; i < moved[m][k].size(); ++i) {
                if (!moved[m][k][i].known || around[k][i] < 0) continue;
                ++moves;
                const double length = glm::length(moved[m][k][i].by);
                const double of = std::max(length, floorPixels) / std::max(around[k][i], floorPixels);
                jumps += of > 2;
                if (of > ratio) ratio = of, at = length;
            }
    }
    before_ = now;
    last_ = std::move(moved);
}

}  // namespace app
