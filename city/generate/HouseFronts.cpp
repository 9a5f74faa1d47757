#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/HouseParts.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

/// One street side of a house: s runs along it, t outwards.
struct Front {
    glm::vec2 origin, along;
    float length = 0, bay = 0;
    int bays = 0;
    float base = 0, floor = 0, eaves = 0;  ///< world z of the foot, of the first floor, of the eaves

    glm::vec3 at(float s, float t, float z) const {
        return {origin + s * along + t * glm::vec2(along.y, -along.x), z};
    }
    void box(Mesh& mesh, const BoxExtent& e, std::uint32_t material,
             unsigned faces = boxAll & ~(boxBottom | boxBack)) const {
        addBox(mesh, origin, along, e, material, faces);
    }
};

void addBalcony(const Front& front, float s, float z, float halfWidth, std::uint32_t slab, std::uint32_t rail,
                Mesh& mesh) {
    constexpr float depth = 0.95f, height = 1.0f, thin = 0.05f;
    front.box(mesh, {s - halfWidth, s + halfWidth, 0, depth, z - 0.18f, z}, slab, boxAll & ~boxBack);
    const unsigned sheet = boxAll & ~boxBottom;
    front.box(mesh, {s - halfWidth, s + halfWidth, depth - thin, depth - 0.01f, z, z + height}, rail, sheet);
    const unsigned side = boxLeft | boxRight | boxTop;
    front.box(mesh, {s - halfWidth + 0.01f, s - halfWidth + thin, 0, depth - thin, z, z + height}, rail,
              side);
    front.box(mesh, {s + halfWidth - thin, s + halfWidth - 0.01f, 0, depth - thin, z, z + height}, rail,
              side);
}

void addAwning(const Front& front, float s0, float s1, float z, std::uint32_t material, Mesh& mesh) {
    constexpr float reach = 1.5f, drop = 0.75f, valance = 0.22f, gap = 0.23f;  // clear of the sign's board
    const glm::vec3 a = front.at(s0, reach, z - drop), b = front.at(s1, reach, z - drop);
    const glm::vec3 c = front.at(s1, gap, z), d = front.at(s0, gap, z);
    const glm::vec3 down(0, 0, -valance);
    addPanel(mesh, a, b, c, d, material, (s1 - s0), 1.6f);
    addPanel(mesh, a + down, b + down, b, a, material, (s1 - s0), valance);
    addFacet(mesh, front.at(s0, gap, z - drop), a, d, material);
    addFacet(mesh, b, front.at(s1, gap, z - drop), c, material);
}

void addShops(const Front& front, const HouseDesign& design, const Palette& palette, Random& random,
              Mesh& mesh) {
    const int shops = front.length > 15 ? 2 : 1;
    const float width = front.length / static_cast<float>(shops);
    for (int k = 0; k < shops; ++k) {
        const float s0 = static_cast<float>(k) * width + 0.35f,
                    s1 = static_cast<float>(k + 1) * width - 0.35f;
        if (s1 - s0 < 1.5f) continue;
        const std::uint32_t sign = palette.signs[random.index(palette.signs.size())];
        front.box(mesh, {s0, s1, 0, 0.2f, front.floor - 0.85f, front.floor - 0.2f}, sign, boxAll & ~boxBack);
        if (design.awnings && random.chance(0.7)) {
            addAwning(front, s0 + 0.2f, s1 - 0.2f, front.floor - 0.9f,
                      palette.awnings[random.index(palette.awnings.size())], mesh);
        } else if (random.chance(0.35)) {
            // A sign that hangs out over the pavement.
            const float s = s0 + 0.3f;
            front.box(mesh, {s, s + 0.12f, 0.3f, 1.1f, front.floor - 0.1f, front.floor + 0.9f}, sign, boxAll);
        }
    }
    front.box(mesh, {0, front.length, 0, 0.14f, front.floor - 0.15f, front.floor + 0.12f}, design.style.trim,
              boxFront | boxTop | boxBottom);
}

void addEntrance(const Front& front, const HouseDesign& design, const Palette& palette, Random& random,
                 HouseMeshes& meshes) {
    front.box(meshes.details, {0, front.length, 0, 0.07f, front.base, front.base + 0.7f}, palette.granite,
              boxFront | boxTop);
    const float s = (static_cast<float>(random.integer(0, front.bays - 1)) + 0.5f) * front.bay;
    front.box(meshes.details, {s - 0.95f, s + 0.95f, 0, 0.12f, front.base, front.base + 3.0f},
              design.style.trim);
    const std::uint32_t door = random.chance(0.6) ? palette.wood : palette.metalDark;
    front.box(meshes.details, {s - 0.7f, s + 0.7f, 0.12f, 0.16f, front.base, front.base + 2.7f}, door,
              boxFront);
    front.box(meshes.details, {0, front.length, 0, 0.12f, front.floor - 0.15f, front.floor + 0.1f},
              design.style.trim, boxFront | boxTop | boxBottom);
}

void addDormers(const Front& front, const HouseDesign& design, const Palette& palette, Mesh& mesh) {
    const float height = std::min(1.9f, 0.62f * design.roofHeight);
    for (int k = 0; k < front.bays; k += 2) {
        const float s = (static_cast<float>(k) + 0.5f + (front.bays % 2 == 0 ? 0.5f : 0.0f)) * front.bay;
        if (s + 0.8f > front.length) break;
        const BoxExtent e{s - 0.75f, s + 0.75f,          -2.6f,
                          -0.35f,    front.eaves + 0.1f, front.eaves + 0.1f + height};
        front.box(mesh, e, palette.zinc, boxLeft | boxRight | boxTop);
        addPanel(mesh, front.at(e.s0, e.t1, e.z0), front.at(e.s1, e.t1, e.z0), front.at(e.s1, e.t1, e.z1),
                 front.at(e.s0, e.t1, e.z1), design.style.facade);
    }
}

}  // namespace

void appendFrontDetails(const Lot& lot, std::size_t side, const HouseDesign& design, const Palette& palette,
                        float base, Random& random, HouseMeshes& meshes) {
    Front front;
    front.origin = lot.corners[side].position;
    front.length = lot.length(side);
    front.along = (lot.corners[(side + 1) % lot.corners.size()].position - front.origin) / front.length;
    front.bays = std::max(1, static_cast<int>(std::round(front.length / design.bayWidth)));
    front.bay = front.length / static_cast<float>(front.bays);
    front.base = base;
    front.floor = base + design.groundFloorHeight;
    front.eaves = base + design.eaves();
    const int upper = design.storeys - 1;

    if (design.cornice) {
        const float jut = design.style.glass ? 0.15f : 0.42f;
        front.box(meshes.details, {0, front.length, 0, jut, front.eaves - 0.4f, front.eaves + 0.02f},
                  design.style.trim, boxAll & ~boxBack);
    }
    if (front.length > 4) {
        if (design.shops) {
            addShops(front, design, palette, random, meshes.details);
        } else if (design.cornice) {
            addEntrance(front, design, palette, random, meshes);
        }
    }
    if (design.bayWindow && front.bays >= 3 && upper >= 3) {
        const int middleBay = front.bays / 2;
        const float s0 = static_cast<float>(middleBay) * front.bay, s1 = s0 + front.bay;
        const float z1 = front.floor + static_cast<float>(upper - 1) * design.storeyHeight;
        front.box(meshes.details, {s0, s1, 0, 0.9f, front.floor, z1}, design.style.blank, boxLeft | boxRight);
        front.box(meshes.details, {s0 - 0.06f, s1 + 0.06f, 0, 0.98f, z1, z1 + 0.2f}, design.style.trim,
                  boxAll & ~boxBack);
        front.box(meshes.details, {s0 - 0.06f, s1 + 0.06f, 0, 0.98f, front.floor - 0.25f, front.floor},
                  design.style.trim, boxAll & ~boxBack);
        addPanel(meshes.details, front.at(s0, 0.9f, front.floor), front.at(s1, 0.9f, front.floor),
                 front.at(s1, 0.9f, z1), front.at(s0, 0.9f, z1), design.style.facade, 1,
                 static_cast<float>(upper - 1));
    }
    if (design.balconies && upper >= 2) {
        const std::uint32_t rail = design.style.glass   ? palette.shelterGlass
                                   : random.chance(0.6) ? palette.metalDark
                                                        : design.style.trim;
        const int step = random.integer(2, 3), first = random.integer(0, 1);
        for (int storey = 1; storey < upper; ++storey) {
            for (int bay = first; bay < front.bays; bay += step) {
                if (design.bayWindow && bay == front.bays / 2) continue;
                const float s = (static_cast<float>(bay) + 0.5f) * front.bay;
                addBalcony(front, s, front.floor + static_cast<float>(storey) * design.storeyHeight,
                           0.42f * front.bay, design.style.trim, rail, meshes.details);
            }
        }
    }
    if (design.dormers && side == 0 &&
        (design.roof == HouseRoof::mansard || design.roof == HouseRoof::gabled)) {
        addDormers(front, design, palette, meshes.solid);
    }
}

}  // namespace city
