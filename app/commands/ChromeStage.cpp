#include "app/commands/ChromeStage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>

#include "app/mirrors/LitShapes.h"

namespace app {

namespace {

/// Vertices that are looked at in a concave reflector.
constexpr std::size_t mostOnConcave = 3000;

}  // namespace

CloseMesh welded(const LitMesh& mesh) {
    CloseMesh out;
    std::map<std::array<float, 3>, std::uint32_t> known;
    std::vector<std::uint32_t> ids;
    for (const LitMesh::Corner& c : mesh.corners) {
        const auto [at, added] = known.try_emplace({c.position.x, c.position.y, c.position.z},
                                                   static_cast<std::uint32_t>(out.positions.size()));
        if (added) out.positions.push_back(c.position);
        ids.push_back(at->second);
    }
    for (const std::uint32_t i : mesh.indices) out.indices.push_back(ids[i]);
    return out;
}

ChromeStage::ChromeStage(const MirrorWorld& scene, double reach) : world(scene) {
    for (const MirrorWorld::Curved& c : world.curved) {
        StagedChrome part;
        part.mirror = &c;
        part.reflector = reflection::makeReflector(withoutLight(c.finest()));
        const bool concave =
            !part.reflector.pieces.empty() && part.reflector.pieces.front().bend == reflection::Bend::concave;
        part.name = std::to_string(parts.size() + 1) + (concave ? ", concave" : ", convex");
        for (const LitMesh& m : world.objects) {
            const city::Aabb box = m.bounds();
            const glm::vec3 centre(c.reflector.centre);
            const float away = glm::distance(glm::clamp(centre, box.min, box.max), centre);
            if (static_cast<double>(away) > reach * c.reflector.radius) continue;
            part.close.push_back(welded(m));
            part.close.back().distance = away;
        }
        std::stable_sort(part.close.begin(), part.close.end(),
                         [](const CloseMesh& a, const CloseMesh& b) { return a.distance < b.distance; });
        if (part.concave()) {
            // The nearest things are enough to see how it does.
            std::size_t left = mostOnConcave;
            std::erase_if(part.close, [&left](const CloseMesh& m) {
                if (m.positions.size() > left) return true;
                left -= m.positions.size();
                return false;
            });
        }
        parts.push_back(std::move(part));
    }
}

glm::dvec2 PixelPlace::of(const glm::dvec3& fromEye) const {
    const glm::dvec3 seen = view_.view.viewFromWorld * fromEye;
    const glm::dvec4 clip = view_.view.clipFromView * glm::dvec4(seen, 1);
    if (!(clip.w > 0)) return {-1e6, -1e6};
    return {(0.5 + 0.5 * clip.x / clip.w) * view_.size.x, (0.5 - 0.5 * clip.y / clip.w) * view_.size.y};
}

bool PixelPlace::inside(const glm::dvec2& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < view_.size.x && pixel.y < view_.size.y;
}

Spread spreadOf(std::vector<double> values) {
    Spread s;
    s.n = values.size();
    if (values.empty()) return s;
    std::sort(values.begin(), values.end());
    for (const double v : values) s.mean += v / static_cast<double>(s.n);
    s.p99 = values[(s.n - 1) * 99 / 100];
    s.worst = values.back();
    return s;
}

nlohmann::ordered_json toJson(const Spread& s) {
    return {{"n", s.n}, {"mean", s.mean}, {"p99", s.p99}, {"worst", s.worst}};
}

}  // namespace app
