#include "reflection/chrome/VirtualObject.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reflection/chrome/BuildReflectorMap.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

std::vector<glm::vec3> positionsOf(const city::Mesh& mesh) {
    std::vector<glm::vec3> positions;
    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
    return positions;
}

TEST(BoundingGrid, KeepsItsBudgetAndPlacesEveryVertex) {
    const std::vector<glm::vec3> positions = positionsOf(meshOf(roundedBox({2, .5, .1}, 4), 40));
    for (const std::size_t most : {8U, 20U, 100U, 500U, 2000U}) {
        const BoundingGrid grid(positions, most);
        EXPECT_LE(grid.nodes().size(), most);
        EXPECT_GE(grid.nodes().size(), most / 4);
        ASSERT_EQ(grid.places().size(), positions.size());
        for (std::size_t k = 0; k < positions.size(); ++k) {
            const BoundingGrid::Place& place = grid.places()[k];
            const BoundingGrid::Cell& cell = grid.cells()[place.cell];
            const glm::vec3 low = grid.nodes()[cell.nodes[0]], high = grid.nodes()[cell.nodes[7]];
            EXPECT_LT(glm::length(low + place.within * (high - low) - positions[k]), 1e-5f);
        }
    }
}

TEST(BoundingGrid, InterpolationIsExactForWhatIsLinear) {
    const std::vector<glm::vec3> positions = positionsOf(meshOf(roundedBox({1, 2, 3}, 4), 30));
    const BoundingGrid grid(positions, 200);
    const auto value = [](const glm::vec3& p) {
        return glm::vec4(1 + p.x - 2 * p.y, p.z, 3 * p.x + p.y * 0.5f - p.z, 7);
    };
    std::vector<glm::vec4> nodes, out(positions.size());
    for (const glm::vec3& p : grid.nodes()) nodes.push_back(value(p));
    grid.interpolate(nodes, out);
    for (std::size_t k = 0; k < positions.size(); ++k)
        EXPECT_LT(glm::length(out[k] - value(positions[k])), 1e-4f);
}

TEST(BoundingGrid, TakesDegenerateMeshes) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(BoundingGrid({}, 10).cells().empty());
    const std::vector<glm::vec3> odd{{nan, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 5}};
    const BoundingGrid grid(odd, 8);
    ASSERT_EQ(grid.places().size(), 4U);
    for (const BoundingGrid::Place& p : grid.places())
        EXPECT_TRUE(p.within.x >= 0 && p.within.y >= 0 && p.within.z >= 0);
}

/// A kettle's belly with a mug beside it.
struct Table {
    ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({.12, .12, .15}), 100), {0, 0, 0}, Bend::convex).map;
    std::vector<glm::vec3> mug = positionsOf(meshOf(roundedBox({.06, .06, .08}, 4), 60));
    glm::dvec3 eye{.3, -.9, .4};
    glm::dmat4 at(const glm::dvec3& place) const {
        glm::dmat4 m(1);
        m[3] = glm::dvec4(place, 1);
        return m;
    }
};

/// Pixels between two directions for the textbook's 60 degrees over 720 rows.
double pixelsApart(const glm::vec3& a, const glm::vec3& b) {
    return glm::length(glm::normalize(glm::dvec3(a)) - glm::normalize(glm::dvec3(b))) * 720 / 1.155;
}

/// Worst distance in pixels over vertices that both find; counts those that only `all` finds.
double worstApart(const VirtualObject& all, const VirtualObject& some, std::size_t& lost) {
    double worst = 0;
    for (std::size_t k = 0; k < all.vertices().size(); ++k) {
        if (all.vertices()[k].status != ReflectionStatus::found) continue;
        if (some.vertices()[k].status != ReflectionStatus::found) {
            ++lost;
            continue;
        }
        worst = std::max(worst, pixelsApart(all.vertices()[k].fromEye, some.vertices()[k].fromEye));
    }
    return worst;
}

TEST(VirtualObject, AFewSearchesPlaceTheMeshWithinAPixelWhereverItStands) {
    const Table table;
    // Beside, close, behind so that the outline crosses it, and far behind so that most is hidden.
    for (const glm::dvec3& place : {glm::dvec3(.23, -.1, 0), glm::dvec3(.19, -.1, 0),
                                    glm::dvec3(.03, .35, .1), glm::dvec3(-.2, .6, -.1)}) {
        VirtualObject all(table.mug, {.share = 1}), some(table.mug, {.share = 0.096});
        const VirtualCounts exact = all.update(table.map, table.eye, table.at(place));
        EXPECT_EQ(exact.searched, table.mug.size());
        EXPECT_EQ(exact.found + exact.hidden + exact.unreflected, exact.searched);
        const VirtualCounts counts = some.update(table.map, table.eye, table.at(place));
        EXPECT_LT(counts.searched, table.mug.size() / 10) << place.x;
        std::size_t lost = 0;
        EXPECT_LT(worstApart(all, some, lost), 1.0) << place.x;
        EXPECT_EQ(lost, 0U) << place.x;
        for (std::size_t k = 0; k < table.mug.size(); ++k)
            EXPECT_EQ(all.vertices()[k].status, some.vertices()[k].status) << place.x << ' ' << k;
    }
}

TEST(VirtualObject, ThePublishedGridIsOffWhereCellsAreLarge) {
    const Table table;
    const std::vector<glm::vec3> coarse = positionsOf(meshOf(roundedBox({.06, .06, .08}, 4), 12));
    VirtualObject all(coarse, {.share = 1}), some(coarse, {.share = 0.096}),
        plain(coarse, {.share = 0.096, .plainGrid = true});
    for (VirtualObject* o : {&all, &some, &plain}) o->update(table.map, table.eye, table.at({.19, -.1, 0}));
    std::size_t lost = 0;
    EXPECT_LT(worstApart(all, some, lost), 1.0);
    EXPECT_EQ(lost, 0U);
    EXPECT_GT(worstApart(all, plain, lost), 2.0);
}

TEST(VirtualObject, SeveralTogetherAreAsEachAlone) {
    const Table table;
    const glm::dmat4 beside = table.at({.23, -.1, 0}), behind = table.at({.03, .35, .1});
    VirtualObject a(table.mug, {}), b(table.mug, {}), c(table.mug, {.share = 1}), alone(table.mug, {});
    std::vector<VirtualObject::Placed> placed{{&a, beside, {}}, {&b, behind, {}}, {&c, beside, {}}};
    VirtualObject::update(table.map, table.eye, placed);
    const VirtualCounts counts = alone.update(table.map, table.eye, behind);
    EXPECT_EQ(counts.searched, placed[1].counts.searched);
    for (std::size_t k = 0; k < table.mug.size(); ++k) {
        EXPECT_EQ(alone.vertices()[k].status, b.vertices()[k].status);
        EXPECT_LT(pixelsApart(alone.vertices()[k].fromEye, b.vertices()[k].fromEye), 1e-3);
        EXPECT_LT(pixelsApart(a.vertices()[k].fromEye, c.vertices()[k].fromEye), 1.0);
    }
}

TEST(VirtualObject, SearchesNoMoreThanItsShareAndIsFartherOffTheSmallerThatIs) {
    Table table;
    // A wall across the outline and one close to the mirror, where few searches are too few.
    const std::vector<glm::vec3> wall = positionsOf(meshOf(roundedBox({.6, .02, .4}, 4), 40));
    const std::vector<glm::dmat4> places{table.at({.1, .4, .1}), table.at({.1, -.25, 0})};
    std::vector<VirtualObject> all(places.size(), VirtualObject(wall, {.share = 1}));
    std::vector<double> worst;
    for (const double share : {.002, .01, .02, .041, .055, .096, .143, .5, .99}) {
        std::vector<VirtualObject> some(places.size(), VirtualObject(wall, {.share = share}));
        const double most =
            share * static_cast<double>(places.size() * wall.size()) + 8.0 * double(places.size());
        std::size_t lost = 0;
        double here = 0;
        // Moving, so that what is remembered is spent from the same budget.
        for (int step = 0; step < 20; ++step) {
            table.eye = glm::dvec3(.3, -.9, .4) + double(step % 10) * glm::dvec3(8e-3, 2e-3, 1e-3);
            std::vector<VirtualObject::Placed> placed;
            for (std::size_t k = 0; k < places.size(); ++k) placed.push_back({&some[k], places[k], {}});
            VirtualObject::update(table.map, table.eye, placed);
            std::size_t searched = 0;
            for (const VirtualObject::Placed& p : placed) searched += p.counts.searched;
            EXPECT_LE(static_cast<double>(searched), most) << share << ' ' << step;
            if (step != 0) continue;
            for (std::size_t k = 0; k < places.size(); ++k) {
                all[k].update(table.map, table.eye, places[k]);
                here = std::max(here, worstApart(all[k], some[k], lost));
            }
        }
        for (const VirtualObject& o : some)
            for (const VirtualVertex& v : o.vertices())
                ASSERT_TRUE(std::isfinite(v.fromEye.x + v.fromEye.y + v.fromEye.z)) << share;
        // Shares that are enough end at the tolerance, all alike.
        EXPECT_LE(here, worst.empty() ? INFINITY : std::max(worst.back(), 1.0)) << share;
        worst.push_back(here);
        EXPECT_TRUE(lost == 0 || share < .096) << share;
    }
    EXPECT_GT(worst.front(), 10.0);
    EXPECT_LT(worst.back(), 1.0);
}

TEST(VirtualObject, WhatIsReflectedPastTheRimTakesNothingFromTheRest) {
    // The lower part of a ball, as a bowl's outside: a mug above its rim shows nowhere in it, one beside it
    // does.
    Table table;
    table.map =
        buildReflectorMap(meshOf(ellipsoid({.12, .12, .12}), 100, 1.6), {0, 0, -.04}, Bend::convex).map;
    ASSERT_FALSE(table.map.closed());
    const std::vector<glm::dmat4> places{table.at({.1, -.25, -.2}), table.at({.1, .1, .3}),
                                         table.at({-.3, 0, .3}), table.at({.2, .2, .35})};
    std::vector<VirtualObject> all(places.size(), VirtualObject(table.mug, {.share = 1})),
        some(places.size(), VirtualObject(table.mug, {.share = 0.096}));
    std::vector<VirtualObject::Placed> placed;
    std::size_t lost = 0, found = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        placed.push_back({&some[k], places[k], {}});
        found += all[k].update(table.map, table.eye, places[k]).found;
    }
    VirtualObject::update(table.map, table.eye, placed);
    ASSERT_GT(found, 1000U);
    for (std::size_t k = 0; k < places.size(); ++k) EXPECT_LT(worstApart(all[k], some[k], lost), 1.0) << k;
    EXPECT_EQ(lost, 0U);
    // Without telling them apart they would take as many as what is seen does.
    for (std::size_t k = 1; k < places.size(); ++k)
        EXPECT_LT(placed[k].counts.searched, table.mug.size() / 50) << k;
}

TEST(VirtualObject, CellsAtTheEndOfItsBudgetDoNotComeAndGo) {
    Table table;
    const std::vector<glm::vec3> wall = positionsOf(meshOf(roundedBox({.6, .02, .4}, 4), 40));
    const glm::dmat4 close = table.at({.1, .4, .1});
    VirtualObject some(wall, {.share = 0.041});
    some.update(table.map, table.eye, close);
    std::vector<VirtualVertex> before(some.vertices().begin(), some.vertices().end());
    double worst = 0;
    for (int step = 0; step < 200; ++step) {
        table.eye += glm::dvec3(2e-4, 1e-4, 5e-5);
        some.update(table.map, table.eye, close);
        double here = 0;
        for (std::size_t k = 0; k < before.size(); ++k)
            if (before[k].status == ReflectionStatus::found &&
                some.vertices()[k].status == ReflectionStatus::found)
                here = std::max(here, pixelsApart(before[k].fromEye, some.vertices()[k].fromEye));
        worst = std::max(worst, here);
        before.assign(some.vertices().begin(), some.vertices().end());
    }
    // Cells that came and went would jump by what they are off: tens of pixels here.
    EXPECT_LT(worst, 2.0);
}

TEST(VirtualObject, WhatItRemembersIsAGuessAndNoMore) {
    Table table;
    const glm::dmat4 behind = table.at({.03, .35, .1});
    VirtualObject one(table.mug, {}), full(table.mug, {.share = 1});
    std::size_t first = 0, later = 0, firstOfAll = 0;
    for (int step = 0; step < 12; ++step) {
        table.eye += glm::dvec3(3e-3, 1e-3, 5e-4);
        later = one.update(table.map, table.eye, behind).lookups;
        const std::size_t ofAll = full.update(table.map, table.eye, behind).lookups;
        if (step == 0) first = later, firstOfAll = ofAll;
        EXPECT_LE(ofAll, firstOfAll);
    }
    EXPECT_LT(later, first);
    VirtualObject fresh(table.mug, {.share = 1});
    fresh.update(table.map, table.eye, behind);
    std::size_t lost = 0;
    EXPECT_LT(worstApart(fresh, one, lost), 1.0);
    EXPECT_LT(worstApart(fresh, full, lost), 1e-3);
    EXPECT_EQ(lost, 0U);
}

TEST(VirtualObject, DoesNotFlickerAsTheEyeMoves) {
    // A thousand small steps; a vertex that jumped between two solutions would move by many pixels.
    Table table;
    VirtualObject some(table.mug, {.share = 0.096});
    const glm::dmat4 beside = table.at({.23, -.1, 0});
    some.update(table.map, table.eye, beside);
    std::vector<VirtualVertex> before(some.vertices().begin(), some.vertices().end());
    double worst = 0;
    for (int step = 0; step < 1000; ++step) {
        table.eye += glm::dvec3(2e-4, 1e-4, 5e-5);
        some.update(table.map, table.eye, beside);
        for (std::size_t k = 0; k < before.size(); ++k) {
            const double moved = pixelsApart(before[k].fromEye, some.vertices()[k].fromEye);
            worst = std::max(worst, moved);
            before[k] = some.vertices()[k];
        }
    }
    // The eye moves by 0.23 mm a step at 1 m: 0.15 pixels for what stands behind the mirror.
    EXPECT_LT(worst, 0.3);
}

TEST(VirtualObject, PassesOnWhatIsNotFinite) {
    const Table table;
    std::vector<glm::vec3> broken = table.mug;
    broken[17].y = std::numeric_limits<float>::quiet_NaN();
    for (const double share : {1.0, 0.1}) {
        VirtualObject object(broken, {.share = share});
        object.update(table.map, table.eye, table.at({.23, -.1, 0}));
        for (const VirtualVertex& v : object.vertices())
            EXPECT_TRUE(std::isfinite(v.fromEye.x + v.fromEye.y + v.fromEye.z));
        EXPECT_EQ(object.vertices()[17].status, ReflectionStatus::invalid);
    }
}

}  // namespace
}  // namespace reflection
