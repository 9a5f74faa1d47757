#include "vehicles/models/Wheel.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "vehicles/models/Parts.h"

namespace vehicles {
namespace {

void addSpoke(city::Mesh& mesh, float angle, float inner, float outer, float halfInner, float halfOuter,
              float face, float depth) {
    const glm::vec3 along{std::cos(angle), 0, std::sin(angle)}, across{-std::sin(angle), 0, std::cos(angle)};
    const glm::vec3 axle{0, 1, 0};
    // The face is roof-shaped: a ridge along the middle catches the light.
    const auto at = [&](float r, float w, float y) { return r * along + w * across + y * axle; };
    const float ridge = 0.35f * halfInner;
    const glm::vec3 il = at(inner, halfInner, face - ridge), im = at(inner, 0, face),
                    ir = at(inner, -halfInner, face - ridge);
    const glm::vec3 ol = at(outer, halfOuter, face - ridge), om = at(outer, 0, face),
                    orr = at(outer, -halfOuter, face - ridge);
    addPlate(mesh, im, il, ol, om, Surface::rim);
    addPlate(mesh, ir, im, om, orr, Surface::rim);
    addPlate(mesh, il, il - depth * axle, ol - depth * axle, ol, Surface::rim);
    addPlate(mesh, ir - depth * axle, ir, orr, orr - depth * axle, Surface::rim);
}

/// A domed chrome disc with a round edge, closed behind: a whole convex body without creases, in which each
/// thing around shows once, however close (reflection/chrome).
void addCover(city::Mesh& mesh, float rim, float lip, int segments) {
    constexpr float edge = 0.008f, height = 0.026f;
    const float reach = rim - 0.012f - edge;
    std::vector<glm::vec2> profile;
    constexpr int rings = 14, turns = 10;
    for (int i = 0; i <= rings; ++i) {
        const float t = static_cast<float>(i) / rings;
        profile.push_back({lip + height * (1 - t * t), t * reach});
    }
    // The dome meets the edge at this slope.
    const float start = std::atan2(2 * height, reach);
    for (int i = 1; i <= turns; ++i) {
        const float angle = start + (glm::pi<float>() - start) * static_cast<float>(i) / turns;
        profile.push_back({lip + edge * (std::cos(angle) - std::cos(start)),
                           reach + edge * (std::sin(angle) - std::sin(start))});
    }
    profile.push_back({profile.back().x, 0});
    addRevolved(mesh, profile, segments, Surface::chrome);
}

}  // namespace

city::Mesh wheelMesh(const WheelShape& shape) {
    city::Mesh mesh;
    const float r = shape.radius, w = shape.width / 2, rim = shape.rimRadius;
    constexpr int segments = 40;
    if (!shape.tyre) {
        addRevolved(mesh,
                    {{w, 0},
                     {w, 0.25f * r},
                     {0.5f * w, 0.4f * r},
                     {0.5f * w, 0.8f * r},
                     {w, 0.85f * r},
                     {w, r},
                     {-w, r},
                     {-w, 0}},
                    segments, Surface::rim);
        return mesh;
    }
    const float wall = r - rim, groove = 0.008f;
    addRevolved(mesh,
                {{0.74f * w, rim - 0.004f},
                 {0.90f * w, rim + 0.06f * wall},
                 {w, rim + 0.40f * wall},
                 {0.99f * w, rim + 0.62f * wall},
                 {0.93f * w, rim + 0.84f * wall},
                 {0.78f * w, r - 0.004f},
                 {0.42f * w, r},
                 {0.38f * w, r - groove},
                 {0.28f * w, r - groove},
                 {0.24f * w, r},
                 {-0.24f * w, r},
                 {-0.28f * w, r - groove},
                 {-0.38f * w, r - groove},
                 {-0.42f * w, r},
                 {-0.78f * w, r - 0.004f},
                 {-0.93f * w, rim + 0.84f * wall},
                 {-w, rim + 0.4f * wall},
                 {-0.8f * w, rim}},
                segments, Surface::tyre);
    const float lip = 0.80f * w;
    if (shape.cover || shape.spokes > 0)
        addRevolved(mesh,
                    {{-0.5f * w, rim - 0.03f},
                     {lip - 0.02f, rim - 0.022f},
                     {lip, rim - 0.014f},
                     {lip, rim - 0.004f},
                     {0.74f * w, rim}},
                    segments, Surface::rim);
    if (shape.cover) {
        addCover(mesh, rim, lip, segments);
    } else if (shape.spokes > 0) {
        // The well behind the spokes, then the brake that fills the sight through them.
        addRevolved(mesh, {{0.0f, 0.3f * rim}, {0.0f, 0.80f * rim}, {-0.02f, 0.80f * rim}}, segments,
                    Surface::rim);
        addRevolved(mesh, {{-0.03f, 0}, {-0.03f, rim - 0.02f}}, segments, Surface::interior);
        const float step = glm::two_pi<float>() / static_cast<float>(shape.spokes);
        for (int s = 0; s < shape.spokes; ++s)
            for (const float twin : {-0.16f, 0.16f})
                addSpoke(mesh, step * (static_cast<float>(s) + twin) + 0.5f * glm::pi<float>(), 0.2f * rim,
                         rim - 0.014f, 0.085f * rim, 0.055f * rim, lip - 0.012f, 0.05f);
        addRevolved(mesh,
                    {{lip - 0.004f, 0},
                     {lip - 0.004f, 0.13f * rim},
                     {lip - 0.012f, 0.27f * rim},
                     {lip - 0.05f, 0.3f * rim}},
                    24, Surface::rim);
        addRevolved(mesh, {{lip, 0}, {lip, 0.11f * rim}, {lip - 0.004f, 0.13f * rim}}, 20, Surface::chrome);
    } else {
        addRevolved(mesh,
                    {{w, 0},
                     {w, 0.22f * rim},
                     {0.95f * w, 0.30f * rim},
                     {0.5f * w, 0.36f * rim},
                     {0.45f * w, 0.5f * rim},
                     {0.2f * w, 0.62f * rim},
                     {0.3f * w, rim - 0.04f},
                     {lip, rim - 0.02f},
                     {lip, rim - 0.004f},
                     {0.74f * w, rim}},
                    segments, Surface::rim);
    }
    addRevolved(mesh, {{-0.8f * w, rim}, {-0.8f * w, 0}}, 24, Surface::interior);
    return mesh;
}

city::Mesh plainWheelMesh(const WheelShape& shape, int segments, bool rim) {
    city::Mesh mesh;
    const float r = shape.radius, w = shape.width / 2, inner = rim ? shape.rimRadius : 0;
    const Surface outer = shape.tyre ? Surface::tyre : Surface::rim;
    if (rim) addRevolved(mesh, {{w, 0}, {w, inner}}, segments, shape.cover ? Surface::chrome : Surface::rim);
    addRevolved(mesh, {{w, inner}, {w, r}, {-w, r}}, segments, outer);
    return mesh;
}

}  // namespace vehicles
