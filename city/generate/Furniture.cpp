#include "city/generate/Furniture.h"

#include <array>

#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

// Front towards +x: a box frame whose `along` is +y has its right-hand side, the outside, towards +x.
constexpr glm::vec2 frameAlong{0, 1};

Prototype single(const char* name, Mesh mesh, bool inHeightfield = false) {
    Prototype p;
    p.name = name;
    p.levels.push_back({std::move(mesh), 0});
    p.inHeightfield = inHeightfield;
    return p;
}

/// Box between two corners in the prototype's frame.
void box(Mesh& mesh, glm::vec3 low, glm::vec3 high, std::uint32_t material, unsigned faces = boxAll) {
    addBox(mesh, {0, 0}, frameAlong, {low.y, high.y, low.x, high.x, low.z, high.z}, material, faces);
}

}  // namespace

Prototype makeStreetLamp(const Palette& p) {
    Mesh m;
    addTube(m, {0, 0, 0}, {0, 0, 0.9f}, 0.11f, 0.09f, 8, p.metalDark);
    addTube(m, {0, 0, 0.9f}, {0, 0, 7.2f}, 0.075f, 0.045f, 8, p.metalDark);
    addTube(m, {0, 0, 7.2f}, {0.6f, 0, 7.75f}, 0.045f, 0.04f, 6, p.metalDark);
    addTube(m, {0.6f, 0, 7.75f}, {1.5f, 0, 7.85f}, 0.04f, 0.035f, 6, p.metalDark);
    box(m, {1.3f, -0.16f, 7.78f}, {2.1f, 0.16f, 7.92f}, p.metalDark);
    box(m, {1.32f, -0.14f, 7.74f}, {2.08f, 0.14f, 7.78f}, p.lampGlass, boxAll & ~boxTop);
    Prototype lamp = single("street lamp", std::move(m));
    Mesh far;
    addTube(far, {0, 0, 0}, {0, 0, 7.75f}, 0.09f, 0.05f, 4, p.metalDark);
    box(far, {0, -0.1f, 7.78f}, {2.1f, 0.1f, 7.9f}, p.metalDark);
    // What shines is seen from afar, and as long glows on wet streets.
    box(far, {1.32f, -0.14f, 7.74f}, {2.08f, 0.14f, 7.78f}, p.lampGlass, boxAll & ~boxTop);
    lamp.levels.push_back({std::move(far), 0.3f});
    return lamp;
}

Prototype makeSquareLamp(const Palette& p) {
    Mesh m;
    const std::array<glm::vec2, 6> post{
        {{0.16f, 0}, {0.16f, 0.3f}, {0.07f, 0.5f}, {0.05f, 3.2f}, {0.12f, 3.3f}, {0.14f, 3.35f}}};
    addLathe(m, {0, 0, 0}, post, 8, p.metalDark);
    const std::array<glm::vec2, 2> glass{{{0.14f, 3.35f}, {0.22f, 3.85f}}};
    addLathe(m, {0, 0, 0}, glass, 8, p.lampGlass);
    const std::array<glm::vec2, 3> cap{{{0.27f, 3.85f}, {0.12f, 4.05f}, {0, 4.2f}}};
    addLathe(m, {0, 0, 0}, cap, 8, p.metalDark);
    return single("square lamp", std::move(m));
}

Prototype makeSignalPole(const Palette& p) {
    Mesh m;
    addTube(m, {0, 0, 0}, {0, 0, 3.35f}, 0.06f, 0.06f, 8, p.metalLight);
    box(m, {0.04f, -0.17f, 2.25f}, {0.1f, 0.17f, 3.25f}, p.metalDark);
    return single("signal pole", std::move(m));
}

Prototype makeBench(const Palette& p) {
    Mesh m;
    for (int k = 0; k < 3; ++k) {
        const float x = 0.02f + 0.15f * static_cast<float>(k);
        box(m, {x, -0.9f, 0.42f}, {x + 0.12f, 0.9f, 0.46f}, p.wood);
    }
    for (int k = 0; k < 2; ++k) {
        const float z = 0.56f + 0.17f * static_cast<float>(k);
        box(m, {-0.06f, -0.9f, z}, {-0.02f, 0.9f, z + 0.12f}, p.wood);
    }
    for (const float y : {-0.75f, 0.69f}) {
        box(m, {0, y, 0}, {0.44f, y + 0.06f, 0.42f}, p.metalDark, boxAll & ~boxBottom);
        box(m, {-0.02f, y, 0.3f}, {0.03f, y + 0.06f, 0.85f}, p.metalDark);
    }
    return single("bench", std::move(m));
}

Prototype makeBollard(const Palette& p) {
    Mesh m;
    const std::array<glm::vec2, 5> profile{
        {{0.085f, 0}, {0.075f, 0.7f}, {0.1f, 0.74f}, {0.09f, 0.86f}, {0, 0.93f}}};
    addLathe(m, {0, 0, 0}, profile, 6, p.metalDark);
    return single("bollard", std::move(m));
}

Prototype makeLitterBin(const Palette& p) {
    Mesh m;
    const std::array<glm::vec2, 4> profile{{{0.2f, 0.1f}, {0.25f, 0.85f}, {0.19f, 0.85f}, {0.17f, 0.7f}}};
    addLathe(m, {0, 0, 0}, profile, 10, p.metalDark);
    const std::array<glm::vec2, 2> bottom{{{0.17f, 0.7f}, {0, 0.7f}}};
    addLathe(m, {0, 0, 0}, bottom, 10, p.metalDark);
    return single("litter bin", std::move(m));
}

Prototype makeTramShelter(const Palette& p) {
    Mesh m;
    for (const float y : {-4.2f, -1.4f, 1.4f, 4.2f})
        box(m, {-0.75f, y - 0.05f, 0}, {-0.65f, y + 0.05f, 2.5f}, p.metalDark, boxAll & ~boxBottom);
    addPanel(m, {-0.7f, -4.15f, 0.25f}, {-0.7f, 4.15f, 0.25f}, {-0.7f, 4.15f, 2.3f}, {-0.7f, -4.15f, 2.3f},
             p.shelterGlass);
    box(m, {-0.9f, -4.5f, 2.5f}, {0.75f, 4.5f, 2.62f}, p.metalLight);
    box(m, {-0.6f, -2.5f, 0.42f}, {-0.2f, 2.5f, 0.48f}, p.wood);
    box(m, {-0.45f, -2.2f, 0}, {-0.35f, -2.1f, 0.42f}, p.metalDark, boxAll & ~(boxBottom | boxTop));
    box(m, {-0.45f, 2.1f, 0}, {-0.35f, 2.2f, 0.42f}, p.metalDark, boxAll & ~(boxBottom | boxTop));
    return single("tram shelter", std::move(m));
}

Prototype makeCatenaryMast(const Palette& p) {
    Mesh m;
    addTube(m, {0, 0, 0}, {0, 0, 6.7f}, 0.11f, 0.08f, 8, p.metalDark);
    addTube(m, {0, -2.4f, 6.3f}, {0, 2.4f, 6.3f}, 0.035f, 0.035f, 4, p.metalDark);
    addTube(m, {0, -1.9f, 6.3f}, {0, 0, 6.65f}, 0.02f, 0.02f, 3, p.metalDark);
    addTube(m, {0, 1.9f, 6.3f}, {0, 0, 6.65f}, 0.02f, 0.02f, 3, p.metalDark);
    return single("catenary mast", std::move(m));
}

Prototype makeAdvertColumn(const Palette& p, std::size_t poster) {
    Mesh m;
    const std::array<glm::vec2, 3> foot{{{0.78f, 0}, {0.78f, 0.35f}, {0.68f, 0.42f}}};
    addLathe(m, {0, 0, 0}, foot, 16, p.granite);
    const std::array<glm::vec2, 2> drum{{{0.68f, 0.42f}, {0.68f, 2.7f}}};
    addLathe(m, {0, 0, 0}, drum, 16, p.signs[poster % p.signs.size()]);
    const std::array<glm::vec2, 4> cap{{{0.68f, 2.7f}, {0.85f, 2.75f}, {0.8f, 2.95f}, {0, 3.5f}}};
    addLathe(m, {0, 0, 0}, cap, 16, p.copper);
    return single("advert column", std::move(m), true);
}

Prototype makeKiosk(const Palette& p) {
    Mesh m;
    box(m, {-1.3f, -2, 0}, {1.3f, 2, 2.7f}, p.awnings[1], boxAll & ~boxBottom);
    addPanel(m, {1.34f, -1.8f, 0.9f}, {1.34f, 1.8f, 0.9f}, {1.34f, 1.8f, 2.3f}, {1.34f, -1.8f, 2.3f},
             p.shops[0], 1, 1);
    addPanel(m, {1.95f, -1.9f, 2.3f}, {1.95f, 1.9f, 2.3f}, {1.32f, 1.9f, 2.65f}, {1.32f, -1.9f, 2.65f},
             p.awnings[3], 3.8f, 1);
    const std::array<glm::vec3, 4> eaves{
        {{1.55f, -2.25f, 2.7f}, {1.55f, 2.25f, 2.7f}, {-1.55f, 2.25f, 2.7f}, {-1.55f, -2.25f, 2.7f}}};
    for (std::size_t k = 0; k < 4; ++k) addFacet(m, eaves[k], eaves[(k + 1) % 4], {0, 0, 3.6f}, p.copper);
    addPanel(m, eaves[3], eaves[2], eaves[1], eaves[0], p.metalDark);
    return single("kiosk", std::move(m), true);
}

Prototype makeFountain(const Palette& p) {
    Mesh m;
    const std::array<glm::vec2, 6> basin{
        {{7.3f, 0}, {7.3f, 0.2f}, {7, 0.2f}, {6.9f, 0.65f}, {6.4f, 0.65f}, {6.35f, 0.3f}}};
    addLathe(m, {0, 0, 0}, basin, 32, p.granite, 2);
    const std::array<glm::vec2, 2> water{{{6.4f, 0.45f}, {0, 0.45f}}};
    addLathe(m, {0, 0, 0}, water, 32, p.water, 4);
    const std::array<glm::vec2, 8> lower{{{1.1f, 0.3f},
                                          {0.7f, 0.9f},
                                          {0.5f, 1.6f},
                                          {0.6f, 1.9f},
                                          {2.3f, 2.4f},
                                          {2.45f, 2.6f},
                                          {2.3f, 2.6f},
                                          {2.3f, 2.5f}}};
    addLathe(m, {0, 0, 0}, lower, 24, p.granite, 2);
    const std::array<glm::vec2, 2> lowerWater{{{2.3f, 2.55f}, {0, 2.55f}}};
    addLathe(m, {0, 0, 0}, lowerWater, 24, p.water, 4);
    const std::array<glm::vec2, 7> upper{{{0.4f, 2.5f},
                                          {0.25f, 3.3f},
                                          {0.35f, 3.5f},
                                          {1.2f, 3.8f},
                                          {1.3f, 3.95f},
                                          {1.2f, 3.95f},
                                          {1.2f, 3.85f}}};
    addLathe(m, {0, 0, 0}, upper, 16, p.granite, 2);
    const std::array<glm::vec2, 5> crest{
        {{1.2f, 3.92f}, {0.25f, 3.92f}, {0.2f, 4.6f}, {0.32f, 4.8f}, {0, 5.1f}}};
    addLathe(m, {0, 0, 0}, crest, 16, p.bronze, 2);
    return single("fountain", std::move(m), true);
}

Prototype makeMonument(const Palette& p) {
    Mesh m;
    for (int k = 0; k < 3; ++k) {
        const float r = 3.2f - 0.6f * static_cast<float>(k), z = 0.25f * static_cast<float>(k);
        box(m, {-r, -r, z}, {r, r, z + 0.25f}, p.granite, boxAll & ~boxBottom);
    }
    box(m, {-1.3f, -1.3f, 0.75f}, {1.3f, 1.3f, 3.4f}, p.granite, boxAll & ~boxBottom);
    const std::array<glm::vec2, 8> column{{{1.05f, 3.4f},
                                           {1.05f, 3.6f},
                                           {0.75f, 3.9f},
                                           {0.62f, 12.2f},
                                           {0.95f, 12.7f},
                                           {1.1f, 12.9f},
                                           {1.1f, 13.2f},
                                           {0, 13.2f}}};
    addLathe(m, {0, 0, 0}, column, 20, p.granite, 2);
    const std::array<glm::vec2, 9> figure{{{0.5f, 13.2f},
                                           {0.42f, 14.2f},
                                           {0.34f, 14.9f},
                                           {0.42f, 15.4f},
                                           {0.36f, 15.75f},
                                           {0.13f, 15.9f},
                                           {0.19f, 16.1f},
                                           {0.15f, 16.35f},
                                           {0, 16.45f}}};
    addLathe(m, {0, 0, 0}, figure, 12, p.bronze);
    addTube(m, {0.1f, 0.3f, 15.4f}, {0.7f, 0.6f, 16.7f}, 0.1f, 0.06f, 6, p.bronze);
    return single("monument", std::move(m), true);
}

glm::mat4 standing(const glm::vec3& foot, const glm::vec2& front, float scale) {
    glm::mat4 m(1);
    m[0] = glm::vec4(scale * front.x, scale * front.y, 0, 0);
    m[1] = glm::vec4(-scale * front.y, scale * front.x, 0, 0);
    m[2] = glm::vec4(0, 0, scale, 0);
    m[3] = glm::vec4(foot, 1);
    return m;
}

}  // namespace city
