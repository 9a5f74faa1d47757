#include "reflection/chrome/VirtualMesh.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "reflection/chrome/BuildReflectorMap.h"
#include "tests/reflection/chrome/Shapes.h"

namespace reflection {
namespace {

/// The directions between which a drawn edge stays, against those in which its middle is really seen.
double worstBend(const VirtualMesh& mesh, const std::vector<glm::dvec3>& places, const ReflectorMap& map,
                 const glm::dvec3& eye) {
    double worst = 0;
    for (std::size_t k = 0; k + 2 < mesh.indices().size(); k += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = mesh.indices()[k + i], b = mesh.indices()[k + (i + 1) % 3];
            const glm::dvec3 middle = 0.5 * (places[a] + places[b]);
            ReflectionPoint r;
            findReflectionPoints(map, eye, std::span(&middle, 1), std::span(&r, 1));
            if (r.status != ReflectionStatus::found) continue;
            // At the outline images move infinitely fast: there the last halving decides.
            if (glm::dot(r.normal, glm::normalize(eye - r.point)) < 0.2) continue;
            const glm::dvec3 exact = glm::normalize(r.point - eye);
            const glm::dvec3 flat = glm::normalize(glm::dvec3(mesh.vertices()[a].fromEye) +
                                                   glm::dvec3(mesh.vertices()[b].fromEye));
            worst = std::max(worst, glm::length(exact - flat));
        }
    return worst;
}

std::vector<glm::dvec3> placesOf(const VirtualMesh& mesh, const std::vector<glm::vec3>& positions) {
    std::vector<glm::dvec3> places(positions.begin(), positions.end());
    for (const MiddleVertex& m : mesh.middles())
        places.push_back(places[m.a] + static_cast<double>(m.share) * (places[m.b] - places[m.a]));
    return places;
}

/// A floor of two triangles under a ball.
const std::vector<glm::vec3> floorCorners{{-2, -2, -.5f}, {2, -2, -.5f}, {2, 2, -.5f}, {-2, 2, -.5f}};
const std::vector<std::uint32_t> floorTriangles{0, 1, 2, 0, 2, 3};

TEST(VirtualMesh, BendsTheReflectedEdgesOfBigTrianglesWithinTheTolerance) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({.4, .4, .4}), 100), {0, 0, 0}, Bend::convex).map;
    const glm::dvec3 eye(0, -3, 1);
    for (const double tolerance : {4e-3, 1e-3, 4e-4}) {
        VirtualMeshOptions options;
        options.vertices.bounded = false;
        options.tolerance = tolerance;
        options.mostHalvings = 9;
        VirtualMesh mesh(floorCorners, floorTriangles, options);
        mesh.update(map, eye, glm::dmat4(1), options);
        EXPECT_GT(mesh.middles().size(), 20U);
        // Edges that run into the outline are given up after the last halving, and with them a few that were
        // made then.
        EXPECT_LT(worstBend(mesh, placesOf(mesh, floorCorners), map, eye), 1.5 * tolerance);
    }
    VirtualMeshOptions stiff;
    stiff.vertices.bounded = false;
    stiff.mostHalvings = 0;
    VirtualMesh mesh(floorCorners, floorTriangles, stiff);
    mesh.update(map, eye, glm::dmat4(1), stiff);
    EXPECT_TRUE(mesh.middles().empty());
    EXPECT_GT(worstBend(mesh, placesOf(mesh, floorCorners), map, eye), 1e-2);
}

TEST(VirtualMesh, AFlatMirrorAsksForNoMiddles) {
    const ReflectorMap map = buildReflectorMap(plate(1), {0, 0, -.5}, Bend::convex).map;
    const std::vector<glm::vec3> box{{-.2f, 0, .3f}, {.3f, 0, .4f}, {0, .3f, .8f}};
    const VirtualMeshOptions options;
    VirtualMesh mesh(box, {0, 1, 2}, options);
    mesh.update(map, {0, -1, 1}, glm::dmat4(1), options);
    EXPECT_TRUE(mesh.middles().empty());
    EXPECT_EQ(mesh.indices().size(), 3U);
}

TEST(VirtualMesh, LeavesNoCracksAndCoversTheMesh) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({.4, .3, .4}), 100), {0, 0, 0}, Bend::convex).map;
    const VirtualMeshOptions options{.vertices = {.bounded = false}};
    VirtualMesh mesh(floorCorners, floorTriangles, options);
    mesh.update(map, {0, -3, 3}, glm::dmat4(1), options);
    const std::vector<glm::dvec3> places = placesOf(mesh, floorCorners);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double area = 0;
    for (std::size_t k = 0; k + 2 < mesh.indices().size(); k += 3) {
        const auto v = [&](std::size_t i) { return mesh.indices()[k + i]; };
        for (std::size_t i = 0; i < 3; ++i) ++edges[{v(i), v((i + 1) % 3)}];
        area += glm::cross(places[v(1)] - places[v(0)], places[v(2)] - places[v(0)]).z / 2;
    }
    int open = 0;
    for (const auto& [ends, uses] : edges) {
        EXPECT_EQ(uses, 1);
        if (edges.count({ends.second, ends.first}) > 0) continue;
        ++open;
        // Only the floor's own border, or what lies hidden behind the ball, has triangles on one side alone.
        const glm::dvec3 middle = 0.5 * (places[ends.first] + places[ends.second]);
        const bool border = std::max(std::abs(middle.x), std::abs(middle.y)) > 1.999;
        const bool behind = mesh.vertices()[ends.first].status == ReflectionStatus::hidden &&
                            mesh.vertices()[ends.second].status == ReflectionStatus::hidden;
        EXPECT_TRUE(border || behind) << middle.x << ' ' << middle.y;
    }
    EXPECT_GT(open, 4);
    EXPECT_GT(area, 14);
    EXPECT_LE(area, 16.0001);
}

TEST(VirtualMesh, BigTrianglesWithHiddenCornersCoverOnlyWhatTheyReach) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({.4, .4, .4}), 100), {0, 0, 0}, Bend::convex).map;
    const glm::dvec3 eye(0, -3, .6);
    // One corner is seen, two are hidden behind the ball; and the other way round.
    const std::vector<glm::vec3> corners{{1.5f, -.5f, -.6f}, {.2f, 3, -.6f}, {-.2f, 2, -.6f}, {2, 3, -.6f}};
    const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 3, 1};
    VirtualMeshOptions options;
    options.vertices.bounded = false;
    options.mostHalvings = 8;
    VirtualMesh mesh(corners, triangles, options);
    mesh.update(map, eye, glm::dmat4(1), options);
    EXPECT_EQ(mesh.vertices()[0].status, ReflectionStatus::found);
    EXPECT_EQ(mesh.vertices()[1].status, ReflectionStatus::hidden);
    EXPECT_EQ(mesh.vertices()[2].status, ReflectionStatus::hidden);
    EXPECT_EQ(mesh.vertices()[3].status, ReflectionStatus::found);
    const std::vector<glm::dvec3> places = placesOf(mesh, corners);
    const double outline = std::asin(.4 / glm::length(eye));
    ASSERT_GT(mesh.indices().size(), 30U);
    for (std::size_t k = 0; k + 2 < mesh.indices().size(); k += 3) {
        glm::dvec3 place(0), drawn(0);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = mesh.indices()[k + i];
            place += places[v] / 3.0;
            drawn += glm::dvec3(mesh.vertices()[v].fromEye) / 3.0;
            const glm::dvec3 sight = glm::normalize(glm::dvec3(mesh.vertices()[v].fromEye));
            EXPECT_LT(std::acos(glm::dot(sight, glm::normalize(-eye))), outline + 2 * options.tolerance);
        }
        ReflectionPoint r;
        findReflectionPoints(map, eye, std::span(&place, 1), std::span(&r, 1));
        if (r.status != ReflectionStatus::found) continue;
        EXPECT_LT(glm::length(glm::normalize(drawn) - glm::normalize(r.point - eye)), 4 * options.tolerance);
    }
}

/// Eight by eight squares in a plane of constant y, from a corner on.
struct Panel {
    Panel(const glm::vec3& corner, float side) {
        for (int j = 0; j <= 8; ++j)
            for (int i = 0; i <= 8; ++i) corners.push_back(corner + side * glm::vec3(float(i), 0, float(j)));
        for (std::uint32_t j = 0; j < 8; ++j)
            for (std::uint32_t i = 0; i < 8; ++i) {
                const std::uint32_t a = j * 9 + i;
                triangles.insert(triangles.end(), {a, a + 1, a + 10, a, a + 10, a + 9});
            }
    }
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> triangles;
};

/// A ball, and a wall of fine squares of which the outline hides a part, each with corners of its own.
struct Checkered {
    ReflectorMap map = buildReflectorMap(meshOf(ellipsoid({.4, .4, .4}), 100), {0, 0, 0}, Bend::convex).map;
    glm::dvec3 eye{0, -3, .6};
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> triangles;

    Checkered() {
        constexpr int across = 48;
        constexpr float side = .05f;
        for (int j = 0; j < across; ++j)
            for (int i = 0; i < across; ++i) {
                const auto first = static_cast<std::uint32_t>(corners.size());
                for (int k = 0; k < 4; ++k)
                    corners.push_back(side *
                                      glm::vec3(float(i + (k & 1)), 0, float(j + (k >> 1)) - .5f * across));
                triangles.insert(triangles.end(), {first, first + 1, first + 3, first, first + 3, first + 2});
            }
    }
    glm::dmat4 at(const glm::dvec3& place) const {
        glm::dmat4 m(1);
        m[3] = glm::dvec4(place, 1);
        return m;
    }
};

TEST(VirtualMesh, AllThatAPieceShowsHasOneBudgetAndKeepsToIt) {
    const Checkered wall;
    const std::vector<glm::dmat4> places{wall.at({.2, 1, 0}), wall.at({.5, -.2, 0}), wall.at({-2.9, .3, 0})};
    for (const double share : {.02, .041, .096, .143, .5}) {
        VirtualMeshOptions options;
        options.vertices.share = share;
        std::vector<VirtualMesh> meshes(places.size(), VirtualMesh(wall.corners, wall.triangles, options));
        meshes.emplace_back(floorCorners, floorTriangles, options);
        std::vector<VirtualMesh::Placed> placed;
        for (std::size_t k = 0; k < meshes.size(); ++k)
            placed.push_back({&meshes[k], k < places.size() ? places[k] : glm::dmat4(1), options, {}});
        VirtualMesh::update(wall.map, wall.eye, placed);
        std::size_t searched = 0, drawn = 0;
        for (const VirtualMesh::Placed& p : placed) {
            searched += p.counts.searched;
            drawn += p.counts.vertices + p.mesh->middles().size();
            ASSERT_GT(p.mesh->indices().size(), 0U);
            for (const VirtualVertex& v : p.mesh->vertices())
                ASSERT_TRUE(std::isfinite(v.fromEye.x + v.fromEye.y + v.fromEye.z));
        }
        EXPECT_LE(double(searched), share * double(drawn) + 8.0 * double(meshes.size())) << share;
    }
}

TEST(VirtualMesh, PlacesOnEdgesFollowFromCellsAsIfTheyWereSearchedFor) {
    const Checkered wall;
    const glm::dmat4 place = wall.at({.2, 1, 0});
    VirtualMeshOptions some, all;
    some.vertices.bounded = false;
    all.vertices.share = 1;
    VirtualMesh few(wall.corners, wall.triangles, some), whole(wall.corners, wall.triangles, all);
    const VirtualCounts searched = few.update(wall.map, wall.eye, place, some),
                        everywhere = whole.update(wall.map, wall.eye, place, all);
    EXPECT_GT(whole.middles().size(), 50U);
    EXPECT_LT(searched.searched, everywhere.searched / 5);
    // Corners of one place are searched for once.
    EXPECT_EQ(everywhere.vertices, 49U * 49U);
    EXPECT_NEAR(double(few.indices().size()), double(whole.indices().size()),
                .01 * double(whole.indices().size()));
    // Each place on an edge is where it is truly seen, or past the outline by the tolerance.
    std::vector<glm::dvec3> places = placesOf(few, wall.corners);
    std::size_t seen = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const glm::dvec3 at(place * glm::dvec4(places[k], 1));
        ReflectionPoint r;
        findReflectionPoints(wall.map, wall.eye, std::span(&at, 1), std::span(&r, 1));
        const VirtualVertex& v = few.vertices()[k];
        if (r.status != ReflectionStatus::found || v.status == ReflectionStatus::hidden) continue;
        ++seen;
        EXPECT_LT(glm::length(glm::normalize(r.point - wall.eye) - glm::normalize(glm::dvec3(v.fromEye))),
                  2 * some.tolerance);
    }
    EXPECT_GT(seen, wall.corners.size() / 4);
}

TEST(VirtualMesh, LeavesOutWhatIsTornBetweenTwoPointsOfABowl) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 100, 2.0, glm::pi<double>(), true), {0, 0, 0},
                          Bend::concave)
            .map;
    // A panel through the region where the bowl shows things several times.
    const Panel panel({-.8f, .3f, -.7f}, .2f);
    VirtualMeshOptions options;
    options.vertices.bounded = false;
    options.mostHalvings = 3;
    VirtualMesh mesh(panel.corners, panel.triangles, options);
    const glm::dvec3 eye(.1, -.5, 1.5);
    mesh.update(map, eye, glm::dmat4(1), options);
    for (std::size_t k = 0; k + 2 < mesh.indices().size(); k += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const VirtualVertex& a = mesh.vertices()[mesh.indices()[k + i]];
            const VirtualVertex& b = mesh.vertices()[mesh.indices()[k + (i + 1) % 3]];
            if (a.status != ReflectionStatus::found || b.status != ReflectionStatus::found) continue;
            EXPECT_LT(glm::length(glm::normalize(a.fromEye) - glm::normalize(b.fromEye)), 0.2);
        }
}

TEST(VirtualMesh, ShowsEveryImageInABowlWhereItIs) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({1, 1, 1}), 100, 2.0, glm::pi<double>(), true), {0, 0, 0},
                          Bend::concave)
            .map;
    const Panel panel({-.6f, .3f, -.6f}, .15f);
    // Followed from a few places that are searched everywhere, as from all of them.
    for (const double share : {1.0, 0.1}) {
        VirtualMeshOptions options;
        options.vertices.bounded = false;
        options.vertices.share = share;
        VirtualMesh mesh(panel.corners, panel.triangles, options);
        const glm::dvec3 eye(.1, -.5, 1.5);
        mesh.update(map, eye, glm::dmat4(1), options);
        std::vector<glm::dvec3> places(panel.corners.begin(), panel.corners.end());
        for (const MiddleVertex& m : mesh.middles())
            places.push_back(places[m.a] + double(m.share) * (places[m.b] - places[m.a]));
        ASSERT_EQ(places.size(), mesh.vertices().size());
        Scatter random(5);
        int images = 0, several = 0, shown = 0;
        for (int k = 0; k < 400; ++k) {
            const glm::dvec3 vertex(random.between(-.55, .55), .3, random.between(-.55, .55));
            const std::vector<ReflectionPoint> all = findAllReflectionPoints(map, eye, vertex);
            several += all.size() > 1;
            for (const ReflectionPoint& r : all) {
                ++images;
                const glm::dvec3 sight = glm::normalize(virtualVertex(r, vertex) - eye);
                bool covered = false;
                for (std::size_t t = 0; t + 2 < mesh.indices().size() && !covered; t += 3) {
                    glm::dmat3 corners, at;
                    for (int i = 0; i < 3; ++i) {
                        const std::uint32_t v = mesh.indices()[t + static_cast<std::size_t>(i)];
                        corners[i] = glm::dvec3(mesh.vertices()[v].fromEye);
                        at[i] = places[v];
                    }
                    const glm::dvec3 w = glm::inverse(corners) * sight;
                    if (!(std::min({w.x, w.y, w.z}) >= -1e-6 * glm::length(w))) continue;
                    covered = glm::distance(at * w / (w.x + w.y + w.z), vertex) < 0.01;
                    if (!covered) continue;
                    EXPECT_NEAR(glm::length(corners * w / (w.x + w.y + w.z)), r.path, 0.01 * r.path);
                }
                shown += covered;
            }
        }
        EXPECT_GT(several, 20) << "else there is nothing to tell apart";
        EXPECT_GT(shown, 0.98 * images) << "of " << images;
    }
}

TEST(VirtualMesh, OutsideItsConeEdgesStayAsTheyAre) {
    const ReflectorMap map =
        buildReflectorMap(meshOf(ellipsoid({.4, .4, .4}), 60), {0, 0, 0}, Bend::convex).map;
    VirtualMeshOptions options;
    options.vertices.bounded = false;
    options.towards = {0, 0, 1};
    options.coneCosine = 0.9;
    VirtualMesh mesh(floorCorners, floorTriangles, options);
    mesh.update(map, {0, -3, 1}, glm::dmat4(1), options);
    EXPECT_TRUE(mesh.middles().empty());
}

}  // namespace
}  // namespace reflection
