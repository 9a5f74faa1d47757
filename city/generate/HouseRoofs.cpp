#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "city/generate/HouseParts.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

struct ProfilePoint {
    float across;  ///< 0 at the street eaves, 1 at the rear eaves
    float rise;    ///< of the roof's height
};
constexpr std::array<ProfilePoint, 3> gabledProfile{{{0, 0}, {0.5f, 1}, {1, 0}}};
constexpr std::array<ProfilePoint, 5> mansardProfile{
    {{0, 0}, {0.11f, 0.72f}, {0.5f, 1}, {0.89f, 0.72f}, {1, 0}}};

/// Texture along the eaves and up the slope, in metres.
void addSlope(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
              std::uint32_t material) {
    constexpr float repeat = 2;  // metres, of roof tile patterns
    addPanel(mesh, a, b, c, d, material, glm::length(b - a) / repeat, glm::length(d - a) / repeat);
}

/// Sides from ring `low` up to ring `high` of as many corners.
void addFrustum(Mesh& mesh, const std::vector<glm::vec3>& low, const std::vector<glm::vec3>& high,
                std::uint32_t material) {
    for (std::size_t i = 0; i < low.size(); ++i) {
        const std::size_t j = (i + 1) % low.size();
        addSlope(mesh, low[i], low[j], high[j], high[i], material);
    }
}

void addPoint(Mesh& mesh, const std::vector<glm::vec3>& ring, const glm::vec3& apex, std::uint32_t material) {
    for (std::size_t i = 0; i < ring.size(); ++i)
        addFacet(mesh, ring[i], ring[(i + 1) % ring.size()], apex, material, 2);
}

std::vector<glm::vec3> shrunk(const Lot& lot, float factor, float z) {
    const glm::vec2 centre = lot.centre();
    std::vector<glm::vec3> ring;
    for (const Lot::Corner& corner : lot.corners)
        ring.emplace_back(centre + factor * (corner.position - centre), z);
    return ring;
}

}  // namespace

void appendParapet(const Lot& lot, const HouseDesign& design, const Palette& palette, float eaves,
                   float height, Mesh& mesh) {
    constexpr float thickness = 0.02f;  // of the lot's size: about 0.3 m
    const std::vector<glm::vec3> outer = shrunk(lot, 1, eaves), inner = shrunk(lot, 1 - 2 * thickness, eaves);
    const glm::vec3 up(0, 0, height);
    std::vector<glm::vec2> deck;
    for (std::size_t i = 0; i < outer.size(); ++i) {
        const std::size_t j = (i + 1) % outer.size();
        deck.emplace_back(inner[i]);
        const glm::vec2 a(outer[i]), b(outer[j]);
        addWall(mesh, a, b, eaves, eaves + height, design.style.blank, glm::length(b - a) / 3, height / 3);
        addWall(mesh, glm::vec2(inner[j]), glm::vec2(inner[i]), eaves, eaves + height, design.style.blank,
                glm::length(b - a) / 3, height / 3);
        addPanel(mesh, outer[i] + up, outer[j] + up, inner[j] + up, inner[i] + up, design.style.trim);
    }
    addDeck(mesh, deck, eaves, palette.roofFlat, palette.repeat(palette.roofFlat));
}

void appendRoof(const Lot& lot, const HouseDesign& design, float eaves, Mesh& mesh) {
    const float top = eaves + design.roofHeight;
    const bool alongStreet = lot.corners.size() == 4 && design.roof != HouseRoof::tent;
    if (!alongStreet) {
        const glm::vec3 apex(lot.centre(), top);
        const std::vector<glm::vec3> low = shrunk(lot, 1, eaves);
        if (design.roof == HouseRoof::tent) {
            addPoint(mesh, low, apex, design.roofMaterial);
            return;
        }
        const std::vector<glm::vec3> knee = shrunk(lot, 0.8f, eaves + 0.72f * design.roofHeight);
        addFrustum(mesh, low, knee, design.roofMaterial);
        addPoint(mesh, knee, apex, design.roofMaterial);
        return;
    }
    // Ridge parallel to side 0: the profile runs from the left and right ends of the street eaves to the rear
    // ones.
    const std::span<const ProfilePoint> profile = design.roof == HouseRoof::mansard
                                                      ? std::span<const ProfilePoint>(mansardProfile)
                                                      : std::span<const ProfilePoint>(gabledProfile);
    std::vector<glm::vec3> left, right;
    for (const ProfilePoint& p : profile) {
        const float z = eaves + p.rise * design.roofHeight;
        const auto mix = [&](std::size_t from, std::size_t to) {
            return glm::vec3(lot.corners[from].position +
                                 p.across * (lot.corners[to].position - lot.corners[from].position),
                             z);
        };
        left.push_back(mix(0, 3));
        right.push_back(mix(1, 2));
    }
    for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
        // Behind the ridge the slope is seen from the rear: its eaves run the other way.
        if (profile[k].rise < profile[k + 1].rise) {
            addSlope(mesh, left[k], right[k], right[k + 1], left[k + 1], design.roofMaterial);
        } else {
            addSlope(mesh, right[k + 1], left[k + 1], left[k], right[k], design.roofMaterial);
        }
    }
    for (std::size_t k = 1; k + 1 < profile.size(); ++k) {
        addFacet(mesh, right[0], right[k + 1], right[k], design.style.blank, 3);
        addFacet(mesh, left[0], left[k], left[k + 1], design.style.blank, 3);
    }
}

void appendChimney(glm::vec2 centre, glm::vec2 along, float z0, float z1, std::uint32_t material,
                   Mesh& mesh) {
    addBox(mesh, centre, along, {-0.3f, 0.3f, -0.6f, 0.6f, z0, z1}, material, boxAll & ~boxBottom, 1);
}

}  // namespace city
