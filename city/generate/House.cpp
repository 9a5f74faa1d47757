#include "city/generate/House.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/HouseParts.h"
#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

constexpr float shortestWindowedSide = 1.8f;  // metres; below it no bay fits
constexpr float parapetHeight = 0.6f;         // metres
constexpr float visibleStep = 0.05f;          // metres of party wall that are worth a quad

float bays(float length, float bayWidth) {
    return std::max(1.0f, std::round(length / bayWidth));
}

void appendWalls(const Lot& lot, const HouseDesign& design, float base, Mesh& mesh) {
    const float eaves = base + design.eaves();
    const auto upper = static_cast<float>(design.storeys - 1);
    for (std::size_t i = 0; i < lot.corners.size(); ++i) {
        const Lot::Corner& corner = lot.corners[i];
        const glm::vec2 a = corner.position, b = lot.corners[(i + 1) % lot.corners.size()].position;
        const float length = glm::length(b - a);
        if (corner.side == Side::party || length < shortestWindowedSide) {
            const float from = corner.side == Side::party ? std::max(base, corner.hiddenBelow) : base;
            if (from + visibleStep < eaves)
                addWall(mesh, a, b, from, eaves, design.style.blank, length / 3, (eaves - from) / 3);
            continue;
        }
        const float across = bays(length, design.bayWidth);
        if (corner.side == Side::court) {
            addWall(mesh, a, b, base, eaves, design.style.facade, across, upper + 1);
            continue;
        }
        const float floor = base + design.groundFloorHeight;
        if (design.shops) {
            addWall(mesh, a, b, base, floor, design.shop, std::max(1.0f, std::round(length / 4)), 1);
        } else {
            addWall(mesh, a, b, base, floor, design.style.facade, across, 1);
        }
        if (upper > 0) addWall(mesh, a, b, floor, eaves, design.style.facade, across, upper);
    }
}

}  // namespace

glm::vec2 Lot::centre() const {
    glm::vec2 sum(0);
    for (const Corner& corner : corners) sum += corner.position;
    return corners.empty() ? sum : sum / static_cast<float>(corners.size());
}

float Lot::length(std::size_t side) const {
    return glm::length(corners[(side + 1) % corners.size()].position - corners[side].position);
}

void appendHouse(const Lot& lot, const HouseDesign& design, const Palette& palette, float base,
                 Random& random, HouseMeshes& meshes) {
    if (lot.corners.size() < 3 || design.storeys < 1) return;
    appendWalls(lot, design, base, meshes.solid);
    if (design.roof == HouseRoof::flat) {
        appendParapet(lot, design, palette, base + design.eaves(), parapetHeight, meshes.solid);
    } else {
        appendRoof(lot, design, base + design.eaves(), meshes.solid);
    }
    for (std::size_t side = 0; side < lot.corners.size(); ++side) {
        if (lot.corners[side].side == Side::street && lot.length(side) >= shortestWindowedSide) {
            appendFrontDetails(lot, side, design, palette, base, random, meshes);
        }
    }
}

}  // namespace city
