#include "vehicles/import/SurfaceGuess.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>

namespace vehicles {
namespace {

bool names(const std::string& text, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* w) { return text.find(w) != std::string::npos; });
}

/// `rear`: whether the triangle lies in the vehicle's rear half.
std::optional<Surface> byName(const std::string& name, bool rear) {
    if (names(name, {"glass", "window", "windshield", "windscreen"})) return Surface::glass;
    if (names(name,
              {"taillight", "tail_light", "taillamp", "brake", "rearlight", "rear_light", "tail light"}) &&
        !names(name, {"disc", "disk", "caliper"}))
        return Surface::tailLamp;
    if (names(name, {"headlight", "head_light", "headlamp"})) return Surface::headLamp;
    if (names(name, {"light", "lamp"}) && !names(name, {"lightgr", "light_gr"}))
        return rear ? Surface::tailLamp : Surface::headLamp;
    if (names(name, {"tire", "tyre", "rubber"})) return Surface::tyre;
    if (names(name, {"rim", "alloy", "hubcap"}) && !names(name, {"trim"})) return Surface::rim;
    if (names(name, {"chrome", "mirror"})) return Surface::chrome;
    if (names(name, {"interior", "seat", "dashboard", "steering"})) return Surface::interior;
    if (names(name, {"trim", "plastic", "grill", "underbody", "chassis", "black"})) return Surface::trim;
    if (names(name, {"paint", "body", "carpaint"})) return Surface::paint;
    return std::nullopt;
}

int paletteKey(const glm::vec4& c) {
    const auto step = [](float v) {
        return static_cast<int>(std::lround(std::sqrt(std::clamp(v, 0.0f, 1.0f)) * 15));
    };
    return step(c.x) << 8 | step(c.y) << 4 | step(c.z);
}

float luminance(const glm::vec4& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

}  // namespace

std::vector<Surface> guessSurfaces(const GltfScene& scene) {
    float low = std::numeric_limits<float>::max(), high = -low, floor = low, top = -low, total = 0,
          paleGlass = 0;
    std::map<int, float> share;  // area of each colour on the body
    const auto areaOf = [](const GltfTriangle& t) {
        return 0.5f * glm::length(glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]));
    };
    const auto onWheel = [&](const GltfTriangle& t) {
        return scene.parts[static_cast<std::size_t>(t.part)].wheelNode >= 0;
    };
    for (const GltfTriangle& t : scene.triangles) {
        for (const glm::vec3& p : t.position) {
            low = std::min(low, p.z);
            high = std::max(high, p.z);
            floor = std::min(floor, p.y);
            top = std::max(top, p.y);
        }
    }
    const auto heightOf = [&](const GltfTriangle& t) {
        return ((t.position[0].y + t.position[1].y + t.position[2].y) / 3 - floor) /
               std::max(top - floor, 1e-6f);
    };
    // Windows lie in the upper part; a palette draws them pale blue or dark blue, and the pale kind leaves no
    // doubt.
    const auto paleBlue = [&](const GltfTriangle& t) {
        return t.colour.z > 0.9f && t.colour.z > 1.1f * t.colour.x && luminance(t.colour) > 0.6f &&
               heightOf(t) > 0.5f;
    };
    for (const GltfTriangle& t : scene.triangles) {
        if (onWheel(t)) continue;
        if (paleBlue(t)) paleGlass += areaOf(t);
        share[paletteKey(t.colour)] += areaOf(t);
        total += areaOf(t);
    }
    const float length = std::max(high - low, 1e-6f);
    std::vector<Surface> out;
    out.reserve(scene.triangles.size());
    for (const GltfTriangle& t : scene.triangles) {
        const float along = ((t.position[0].z + t.position[1].z + t.position[2].z) / 3 - low) /
                            length;  // 0 the rear, 1 the front
        const GltfMaterial none;
        const GltfMaterial& m =
            t.material >= 0 ? scene.materials[static_cast<std::size_t>(t.material)] : none;
        std::optional<Surface> surface = byName(m.name, along < 0.5f);
        if (!surface && (m.blended || t.colour.w < 0.9f)) surface = Surface::glass;
        const glm::vec4& c = t.colour;
        const float light = luminance(c), most = std::max({c.x, c.y, c.z}), least = std::min({c.x, c.y, c.z});
        const bool grey = most - least < 0.25f * most + 0.01f;
        if (onWheel(t)) {
            if (!surface || surface == Surface::paint || surface == Surface::trim)
                surface = (light < 0.12f) ? Surface::tyre : Surface::rim;
        } else if (!surface && t.material >= 0 && m.metallic > 0.8f && m.roughness < 0.35f && grey &&
                   light > 0.3f) {
            surface = Surface::chrome;
        }
        if (!surface) {
            const float part = total > 0 ? share[paletteKey(c)] / total : 0;
            const bool upper = heightOf(t) > 0.55f,
                       pale = paleGlass > 0.01f * total && paleGlass < 0.35f * total;
            const bool slate = light < 0.30f && c.z > 1.02f * c.y && most - least < 0.5f * most;
            if ((pale && paleBlue(t)) || (!pale && upper && slate && c.z > 1.1f * c.x && part < 0.45f))
                surface = Surface::glass;
            else if ((light < 0.10f && grey && part < 0.45f) ||
                     (slate && heightOf(t) < 0.62f && part < 0.45f))
                surface = Surface::trim;
            else if (part < 0.06f && along > 0.9f && light > 0.45f)
                surface = Surface::headLamp;
            else if (part < 0.06f && along < 0.1f && c.x > 0.3f && c.x > 2.5f * c.y && c.x > 2.5f * c.z)
                surface = Surface::tailLamp;
            else
                surface = Surface::paint;
        }
        out.push_back(*surface);
    }
    return out;
}

}  // namespace vehicles
