#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "vehicles/models/Bodies.h"
#include "vehicles/models/Levels.h"
#include "vehicles/models/Parts.h"

namespace vehicles {
namespace {

constexpr float wheelRadius = 0.34f, axle = 0.51f;
constexpr glm::vec3 bottomBracket{-.06f, 0, .28f}, headLow{.40f, 0, .60f}, headTop{.35f, 0, .84f},
    seat{-.24f, 0, .93f};

/// A round limb, thicker at one end, with round ends.
void addLimb(city::Mesh& mesh, const glm::vec3& from, const glm::vec3& to, float atFrom, float atTo,
             Surface surface, int segments = 12) {
    const glm::vec3 y = glm::normalize(to - from);
    const glm::vec3 x =
        glm::normalize(glm::cross(y, std::abs(y.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0)));
    const glm::vec3 z = glm::cross(x, y);
    const float length = glm::length(to - from);
    std::vector<glm::vec2> profile;
    constexpr int turns = 4;
    for (int i = 0; i <= turns; ++i) {
        const float a = glm::half_pi<float>() * static_cast<float>(i) / turns;
        profile.push_back({length + atTo * std::cos(a), atTo * std::sin(a)});
    }
    for (int i = 0; i <= turns; ++i) {
        const float a = glm::half_pi<float>() * static_cast<float>(i) / turns;
        profile.push_back({-atFrom * std::sin(a), atFrom * std::cos(a)});
    }
    city::Mesh limb;
    addRevolved(limb, profile, segments, surface);
    for (city::Vertex& v : limb.vertices) {
        v.position = from + v.position.x * x + v.position.y * y + v.position.z * z;
        v.normal = v.normal.x * x + v.normal.y * y + v.normal.z * z;
    }
    mesh.append(limb);
}

city::Mesh wheel() {
    city::Mesh mesh;
    constexpr float tyre = 0.018f, ring = wheelRadius - tyre;
    std::vector<glm::vec2> section;
    constexpr int turns = 10;
    for (int i = 0; i <= turns; ++i) {
        const float a = glm::two_pi<float>() * static_cast<float>(i) / turns;
        section.push_back({tyre * std::cos(a), ring + tyre * std::sin(a)});
    }
    addRevolved(mesh, section, 40, Surface::tyre);
    addRevolved(mesh,
                {{.010f, ring - .034f},
                 {.012f, ring - .020f},
                 {.011f, ring - .010f},
                 {-.011f, ring - .010f},
                 {-.012f, ring - .020f},
                 {-.010f, ring - .034f},
                 {.010f, ring - .034f}},
                40, Surface::rim);
    addRevolved(mesh, {{.040f, 0}, {.040f, .016f}, {-.040f, .016f}, {-.040f, 0}}, 14, Surface::chrome);
    constexpr int spokes = 18;
    for (int s = 0; s < spokes; ++s) {
        const float a = glm::two_pi<float>() * static_cast<float>(s) / spokes;
        const glm::vec3 out{std::cos(a), 0, std::sin(a)};
        const float side = s % 2 == 0 ? .032f : -.032f;
        addBar(mesh, .015f * out + glm::vec3(0, side, 0), (ring - .03f) * out, .0016f, 4, Surface::rim);
    }
    return mesh;
}

city::Mesh bicycle() {
    city::Mesh mesh;
    const glm::vec3 hub{-axle, 0, wheelRadius}, front{axle, 0, wheelRadius};
    const auto tube = [&](const glm::vec3& a, const glm::vec3& b, float r, Surface s = Surface::paint) {
        addBar(mesh, a, b, r, 10, s);
    };
    tube(bottomBracket, headLow, .018f);
    tube(bottomBracket, glm::mix(bottomBracket, seat, 0.8f), .016f);
    tube(glm::mix(bottomBracket, seat, 0.74f), headTop, .015f);
    tube(headLow - glm::vec3(-.01f, 0, .05f), headTop + glm::vec3(-.01f, 0, .04f), .019f);
    for (const float y : {.055f, -.055f}) {
        const glm::vec3 out{0, y, 0};
        tube(bottomBracket + 0.4f * out, hub + out, .009f);
        tube(glm::mix(bottomBracket, seat, 0.74f) + 0.3f * out, hub + out, .008f);
        tube(headLow + glm::vec3(.01f, y, -.04f), front + out, .010f, Surface::chrome);
    }
    tube(headLow + glm::vec3(.01f, -.055f, -.04f), headLow + glm::vec3(.01f, .055f, -.04f), .012f,
         Surface::chrome);
    tube(glm::mix(bottomBracket, seat, 0.78f), seat, .012f, Surface::chrome);
    addRounded(mesh, seat + glm::vec3(-.02f, 0, .02f), {.135f, .07f, .025f}, 2.5f, 14, Surface::trim);
    // Handlebar, grips, lamps.
    const glm::vec3 stem = headTop + glm::vec3(.05f, 0, .16f);
    tube(headTop, stem, .013f, Surface::chrome);
    for (const float side : {1.0f, -1.0f}) {
        tube(stem, stem + glm::vec3(-.02f, .19f * side, .01f), .011f, Surface::chrome);
        tube(stem + glm::vec3(-.02f, .19f * side, .01f), stem + glm::vec3(-.06f, .29f * side, .01f), .016f,
             Surface::trim);
    }
    addRounded(mesh, headTop + glm::vec3(.10f, 0, .02f), {.035f, .04f, .04f}, 2, 14, Surface::headLamp);
    addRounded(mesh, seat + glm::vec3(-.13f, 0, -.10f), {.015f, .025f, .025f}, 2, 12, Surface::tailLamp);
    // Guards over both wheels.
    for (const float x : {-axle, axle}) {
        constexpr int pieces = 14;
        for (int i = 0; i < pieces; ++i) {
            const float from = x < 0 ? 0.1f : 0.55f, to = x < 0 ? 2.9f : 2.4f;
            const auto at = [&](int k) {
                const float a = from + (to - from) * static_cast<float>(k) / pieces;
                return glm::vec3(x, 0, wheelRadius) + 0.365f * glm::vec3(std::cos(a), 0, std::sin(a));
            };
            const glm::vec3 y{0, .022f, 0},
                thick = .003f * glm::normalize(at(i) - glm::vec3(x, 0, wheelRadius));
            addPlate(mesh, at(i) + y + thick, at(i) - y + thick, at(i + 1) - y + thick, at(i + 1) + y + thick,
                     Surface::paint);
            addPlate(mesh, at(i) - y, at(i) + y, at(i + 1) + y, at(i + 1) - y, Surface::trim);
        }
    }
    // Crank, chain wheel, pedals.
    city::Mesh chain;
    addRevolved(chain, {{.004f, .055f}, {.004f, .095f}, {-.004f, .095f}, {-.004f, .055f}, {.004f, .055f}}, 24,
                Surface::rim);
    for (city::Vertex& v : chain.vertices) v.position += bottomBracket + glm::vec3(0, -.045f, 0);
    mesh.append(chain);
    for (const float side : {1.0f, -1.0f}) {
        const glm::vec3 pedal = bottomBracket + glm::vec3(0, .09f * side, -.17f * side);
        tube(bottomBracket + glm::vec3(0, .06f * side, 0), pedal - glm::vec3(0, .03f * side, 0), .010f,
             Surface::rim);
        addBox(mesh, pedal - glm::vec3(.04f, .04f, .01f), pedal + glm::vec3(.04f, .04f, .01f), Surface::trim);
    }
    return mesh;
}

city::Mesh rider() {
    city::Mesh mesh;
    const glm::vec3 hip = seat + glm::vec3(-.02f, 0, .09f), chest{.00f, 0, 1.38f};
    // Trunk: two rounded bodies that meet in the waist.
    const float lean = std::atan2(chest.x - hip.x, chest.z - hip.z);
    const glm::mat3 turn{
        {std::cos(lean), 0, -std::sin(lean)}, {0, 1, 0}, {std::sin(lean), 0, std::cos(lean)}};
    addRounded(mesh, glm::mix(hip, chest, 0.72f), {.115f, .185f, .25f}, 2.4f, 22, Surface::cloth, turn);
    addRounded(mesh, hip + glm::vec3(.02f, 0, .01f), {.125f, .165f, .13f}, 2.3f, 18, Surface::interior, turn);
    addLimb(mesh, chest + glm::vec3(.05f, 0, .08f), chest + glm::vec3(.11f, 0, .17f), .055f, .05f,
            Surface::skin);
    const glm::vec3 head = chest + glm::vec3(.145f, 0, .26f);
    addRounded(mesh, head, {.095f, .078f, .115f}, 2.1f, 20, Surface::skin);
    addRounded(mesh, head + glm::vec3(-.012f, 0, .045f), {.128f, .097f, .088f}, 2.2f, 20, Surface::paint);
    for (const float side : {1.0f, -1.0f}) {
        const auto at = [&](float x, float y, float z) { return glm::vec3(x, side * y, z); };
        const glm::vec3 shoulder = chest + at(.06f, .175f, .09f), elbow = at(.20f, .27f, 1.17f),
                        hand = headTop + at(.01f, .25f, .185f);
        addLimb(mesh, shoulder, elbow, .058f, .046f, Surface::cloth);
        addLimb(mesh, elbow, hand, .042f, .032f, Surface::skin);
        addRounded(mesh, hand, {.045f, .045f, .03f}, 2.2f, 12, Surface::skin);
        // The left pedal is down, the right one up.
        const glm::vec3 ankle = bottomBracket + at(-.05f, .10f, side > 0 ? -.07f : .26f);
        const glm::vec3 thigh = hip + at(.02f, .09f, -.01f);
        const glm::vec3 knee = side > 0 ? at(.06f, .11f, .62f) : at(.19f, .12f, .84f);
        addLimb(mesh, thigh, knee, .085f, .062f, Surface::interior, 14);
        addLimb(mesh, knee, ankle, .062f, .040f, Surface::interior, 14);
        addRounded(mesh, ankle + at(.065f, 0, -.065f), {.13f, .043f, .042f}, 2.6f, 14, Surface::trim);
    }
    return mesh;
}

}  // namespace

VehicleModel cyclist() {
    VehicleModel model;
    model.name = "cyclist";
    model.length = 1.73f;
    model.width = 0.66f;
    model.height = 1.76f;
    model.wheelRadius = wheelRadius;
    model.wheel = wheel();
    model.wheels = {{{axle, 0, wheelRadius}, true, false}, {{-axle, 0, wheelRadius}, false, false}};
    VehicleModel::Level level;
    level.body = bicycle();
    level.body.append(rider());
    model.levels.push_back(std::move(level));
    makeLevels(model);
    return model;
}

}  // namespace vehicles
