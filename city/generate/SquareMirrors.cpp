#include "city/generate/SquareMirrors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "city/generate/OpenSpaces.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

constexpr float plinthHalf = 1;                                                  // metres
constexpr float plinthHeight = 0.36f;                                            // metres
constexpr float sphereRadius = 1.1f, pillarRadius = 0.55f, pillarHeight = 4.2f;  // metres
/// Metres between a plinth's middle and the border, the axis of the walk, what stands beside it, and the eye.
constexpr float fromBorder = 3, fromWalk = 5, fromThings = 1.8f, fromEye = 2.6f;
/// What hangs higher than the things on the plinths does not stand in their way, metres.
constexpr float clearHeight = 3;

struct Obstacle {
    glm::vec2 at{0};
    float radius = 0;
};

/// What stands in a model, as circles around the parts below `clearHeight`.
std::vector<Obstacle> obstaclesIn(const CityModel& model) {
    std::vector<float> radii;
    for (const Prototype& prototype : model.prototypes) {
        float most = 0;
        if (!prototype.levels.empty())
            for (const Vertex& v : prototype.levels.front().mesh.vertices)
                if (v.position.z < clearHeight) most = std::max(most, glm::length(glm::vec2(v.position)));
        radii.push_back(most);
    }
    std::vector<Obstacle> found;
    for (const Placement& placement : model.placements) {
        const glm::mat4& m = placement.worldFromPrototype;
        found.push_back({glm::vec2(m[3]), radii[placement.prototype] * glm::length(glm::vec3(m[0]))});
    }
    return found;
}

float distanceToSegment(glm::vec3 p, glm::vec3 a, glm::vec3 b) {
    const glm::vec3 d = b - a;
    const float squared = glm::dot(d, d);
    const float t = squared > 0 ? std::clamp(glm::dot(p - a, d) / squared, 0.0f, 1.0f) : 0.0f;
    return glm::length(a + t * d - p);
}

bool freeAt(glm::vec2 p, float height, const std::vector<glm::vec2>& ring, std::span<const TourStop> tour,
            const std::vector<Obstacle>& obstacles) {
    for (std::size_t i = 0; i < ring.size(); ++i)
        if (glm::dot(p - ring[i], outward(ring[i], ring[(i + 1) % ring.size()])) > -fromBorder) return false;
    for (const Obstacle& o : obstacles)
        if (glm::length(p - o.at) < o.radius + fromThings) return false;
    for (std::size_t i = 0; i + 1 < tour.size(); ++i)
        for (const float z : {0.2f, 0.5f, 0.8f})
            if (distanceToSegment({p, innerGround + z * height}, tour[i].eye, tour[i + 1].eye) < fromEye)
                return false;
    return true;
}

/// The slab and, for a sphere, a collar in which it rests: `collar` metres high.
void addPlinth(glm::vec2 p, float collar, const Palette& palette, ChunkCollector& chunks) {
    const std::array ring{p + glm::vec2(-plinthHalf, -plinthHalf), p + glm::vec2(plinthHalf, -plinthHalf),
                          p + glm::vec2(plinthHalf, plinthHalf), p + glm::vec2(-plinthHalf, plinthHalf)};
    addPrism(chunks.at(ChunkKind::building, p.x, p.y), ring, innerGround, innerGround + plinthHeight,
             palette.granite, palette.granite, 2);
    if (collar <= 0) return;
    const std::array<glm::vec2, 4> profile{
        {{0.52f, 0}, {0.44f, 0.7f * collar}, {0.44f, collar}, {0.3f, collar - 0.05f}}};
    addLathe(chunks.at(ChunkKind::furniture, p.x, p.y), {p, innerGround + plinthHeight}, profile, 24,
             palette.metalDark, 1);
}

}  // namespace

void addSquareMirrors(const std::vector<glm::vec2>& ring, std::span<const TourStop> tour,
                      const Palette& palette, Random& random, CityModel& model, ChunkCollector& chunks) {
    if (ring.size() < 3) return;
    const std::vector<Obstacle> obstacles = obstaclesIn(model);
    const float side = random.chance(0.5) ? 1.0f : -1.0f;
    // The first side of the ring is the avenue's; the walk goes in from its middle.
    const glm::vec2 gate = 0.5f * (ring[0] + ring[1]), out = outward(ring[0], ring[1]);
    const glm::vec2 along(-out.y, out.x);
    const auto place = [&](float hand, float height) -> std::optional<glm::vec2> {
        for (int attempt = 0; attempt < 400; ++attempt) {
            // The first tries are for the front, where what drives by is mirrored largest.
            const float deepest = fromBorder + 5 + 0.05f * static_cast<float>(attempt);
            const glm::vec2 p = glm::round(gate + hand * random.range(fromWalk, fromWalk + 5) * along -
                                           random.range(fromBorder, deepest) * out);
            if (hand * glm::dot(p - gate, along) >= fromWalk && freeAt(p, height, ring, tour, obstacles))
                return p;
        }
        return std::nullopt;
    };
    const float top = innerGround + plinthHeight;
    if (const auto p = place(side, top + 2 * sphereRadius)) {
        // The collar's rim meets the sphere where it is 0.44 m wide.
        const float rim = sphereRadius - std::sqrt(sphereRadius * sphereRadius - 0.44f * 0.44f);
        constexpr float lifted = 0.16f;
        addPlinth(*p, lifted + rim, palette, chunks);
        model.reflectors.push_back({"sphere",
                                    StandingReflector::Shape::sphere,
                                    StandingReflector::Stuff::chrome,
                                    {*p, top + lifted},
                                    sphereRadius,
                                    2 * sphereRadius});
    }
    if (const auto p = place(-side, top + pillarHeight)) {
        addPlinth(*p, 0, palette, chunks);
        model.reflectors.push_back(
            {"pillar",
             StandingReflector::Shape::pillar,
             random.chance(0.6) ? StandingReflector::Stuff::chrome : StandingReflector::Stuff::granite,
             {*p, top},
             pillarRadius,
             pillarHeight});
    }
}

}  // namespace city
