#include "city/generate/PerimeterBlock.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "city/generate/Random.h"
#include "city/generate/Shapes.h"

namespace city {

namespace {

constexpr float smallestCourt = 7;    // metres across; below it a court would be a shaft
constexpr float shallowestHouse = 6;  // metres
constexpr double stoneShare = 0.2;    // of shops with polished stone and frosted glass
constexpr std::uint64_t stoneFronts = 0x570e;

float cross(glm::vec2 a, glm::vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Widths of the lots that fill `length`, none narrower than it must.
std::vector<float> divide(float length, float low, float high, Random& random) {
    std::vector<float> widths;
    float left = length;
    while (left > high) {
        float width = random.range(low, high);
        if (left - width < low) width = 0.5f * left;
        widths.push_back(width);
        left -= width;
    }
    if (left > 0) widths.push_back(left);
    return widths;
}

}  // namespace

std::vector<glm::vec2> insetRing(const std::vector<glm::vec2>& ring, std::span<const float> distances) {
    const std::size_t n = ring.size();
    std::vector<glm::vec2> inner;
    for (std::size_t i = 0; i < n; ++i) {
        const glm::vec2 before = ring[(i + n - 1) % n], at = ring[i], after = ring[(i + 1) % n];
        const glm::vec2 d0 = glm::normalize(at - before), d1 = glm::normalize(after - at);
        const glm::vec2 p0 = at - distances[(i + n - 1) % n] * outward(before, at);
        const glm::vec2 p1 = at - distances[i] * outward(at, after);
        const float sine = cross(d0, d1);
        inner.push_back(std::abs(sine) < 1e-3f ? p0 : p0 + d0 * (cross(p1 - p0, d1) / sine));
    }
    // A side that turned round has been eaten up.
    for (std::size_t i = 0; i < n; ++i) {
        if (glm::dot(inner[(i + 1) % n] - inner[i], ring[(i + 1) % n] - ring[i]) <= 0) return {};
    }
    return inner;
}

std::vector<glm::vec2> insetRing(const std::vector<glm::vec2>& ring, float distance) {
    return insetRing(ring, std::vector<float>(ring.size(), distance));
}

HouseDesign drawHouse(const BlockSide& side, double glass, const Palette& palette, Random& random) {
    HouseDesign d;
    const bool modern = random.chance(glass);
    d.style = modern ? palette.glassFacade(random) : palette.oldFacade(random);
    d.storeys = random.integer(side.storeysLow, side.storeysHigh);
    d.storeyHeight = modern ? 3.4f : random.range(3.05f, 3.4f);
    d.groundFloorHeight = random.range(4.0f, 4.5f);
    d.bayWidth = modern ? 3.0f : random.range(2.6f, 3.2f);
    d.shops = random.chance(side.shops);
    d.shop = palette.shops[random.index(palette.shops.size())];
    if (!palette.stoneShops.empty()) {
        // A stream of its own: all else stays as it is without them.
        Random stone = random.fork(stoneFronts);
        if (stone.chance(stoneShare)) d.shop = palette.stoneShops[stone.index(palette.stoneShops.size())];
    }
    d.awnings = d.shops && random.chance(0.65);
    d.roofMaterial = palette.roofTiles[random.index(palette.roofTiles.size())];
    const double roof = random.uniform();
    d.roof = modern || roof < 0.15 ? HouseRoof::flat : roof < 0.6 ? HouseRoof::mansard : HouseRoof::gabled;
    if (d.roof == HouseRoof::mansard && random.chance(0.5)) d.roofMaterial = palette.zinc;
    d.roofHeight = d.roof == HouseRoof::mansard ? random.range(4.2f, 5.2f) : random.range(3.6f, 4.8f);
    d.balconies = random.chance(0.6 * side.ornament);
    d.bayWindow = !modern && random.chance(0.5 * side.ornament);
    d.dormers = d.roof == HouseRoof::mansard && random.chance(0.4 + 0.6 * side.ornament);
    return d;
}

PlannedBlock planPerimeterBlock(const BlockPlan& plan, const Palette& palette, float base, Random& random) {
    PlannedBlock block;
    const std::size_t n = plan.boundary.size();
    if (n < 3 || plan.sides.size() != n) return block;

    float depth = plan.depth;
    std::vector<glm::vec2> inner;
    while (depth >= shallowestHouse) {
        inner = insetRing(plan.boundary, depth);
        if (!inner.empty() && !insetRing(inner, 0.5f * smallestCourt).empty()) break;
        inner.clear();
        depth -= 1;
    }
    if (inner.empty()) return block;

    for (std::size_t k = 0; k < n; ++k) {
        const glm::vec2 a = plan.boundary[k], b = plan.boundary[(k + 1) % n];
        const glm::vec2 before = plan.boundary[(k + n - 1) % n];
        const glm::vec2 along = glm::normalize(b - a), in = -outward(a, b);
        const glm::vec2 back = glm::normalize(before - a);
        // The corner house reaches as far along both streets as the court's corner.
        const glm::vec2 courtCorner = inner[k];
        const glm::vec2 onNext = a + along * glm::dot(courtCorner - a, along);
        const glm::vec2 onLast = a + back * glm::dot(courtCorner - a, back);
        PlannedHouse corner;
        const BlockSide &last = plan.sides[(k + n - 1) % n], &next = plan.sides[k];
        const BlockSide& grander = last.storeysHigh > next.storeysHigh ? last : next;
        corner.design = drawHouse(grander, plan.glass, palette, random);
        corner.design.storeys = grander.storeysHigh;
        corner.lot.corners.push_back({onLast, Side::street, 0});
        const float reach = std::min(glm::length(onNext - a), glm::length(onLast - a));
        const float cut = std::min(plan.chamfer, reach - 2);
        if (cut > 0.5f) {
            corner.lot.corners.push_back({a + back * cut, Side::street, 0});
            corner.lot.corners.push_back({a + along * cut, Side::street, 0});
        } else {
            corner.lot.corners.push_back({a, Side::street, 0});
        }
        corner.lot.corners.push_back({onNext, Side::party, 0});
        corner.lot.corners.push_back({courtCorner, Side::party, 0});
        // A ridge needs an eaves on the far side too; a corner house has none.
        if (corner.design.roof != HouseRoof::flat) corner.design.roof = HouseRoof::tent;
        corner.design.roofHeight = random.range(4.5f, 7.5f);
        corner.design.dormers = false;
        corner.design.bayWindow = false;
        block.houses.push_back(std::move(corner));

        const glm::vec2 end = b + along * glm::dot(inner[(k + 1) % n] - b, along);
        float s = 0;
        for (const float width : divide(glm::length(end - onNext), plan.frontLow, plan.frontHigh, random)) {
            PlannedHouse house;
            house.design = drawHouse(next, plan.glass, palette, random);
            const glm::vec2 p = onNext + s * along, q = onNext + (s + width) * along;
            house.lot.corners = {{p, Side::street, 0},
                                 {q, Side::party, 0},
                                 {q + depth * in, Side::court, 0},
                                 {p + depth * in, Side::party, 0}};
            block.houses.push_back(std::move(house));
            s += width;
        }
    }

    // Each house hides its neighbours' walls up to its own eaves. Party sides: corner houses have the next
    // one on the side before the last and the previous one on the last; the others on sides 1 and 3.
    const std::size_t count = block.houses.size();
    for (std::size_t i = 0; i < count; ++i) {
        Lot& lot = block.houses[i].lot;
        const std::size_t m = lot.corners.size();
        const float nextEaves = base + block.houses[(i + 1) % count].design.eaves();
        const float lastEaves = base + block.houses[(i + count - 1) % count].design.eaves();
        const bool corner = lot.corners[m - 2].side == Side::party;
        lot.corners[corner ? m - 2 : 1].hiddenBelow = nextEaves;
        lot.corners[corner ? m - 1 : 3].hiddenBelow = lastEaves;
    }
    block.court = inner;
    return block;
}

}  // namespace city
