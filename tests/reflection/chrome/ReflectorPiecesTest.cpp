#include "reflection/chrome/ReflectorPieces.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/reflection/chrome/Shapes.h"
#include "vehicles/models/Fleet.h"
#include "vehicles/models/VehicleModel.h"

namespace reflection {
namespace {

void expectWholePieces(const city::Mesh& mesh, const Reflector& reflector) {
    std::size_t triangles = 0;
    for (const ReflectorPiece& piece : reflector.pieces) {
        triangles += piece.mesh.triangleCount();
        // A single triangle may be too small for its map.
        if (piece.mesh.triangleCount() < 2) continue;
        EXPECT_EQ(piece.built.status, ReflectorMapStatus::built);
        EXPECT_GE(piece.margin, 0.1);
        EXPECT_GE(piece.built.report.coveredShare, 0.01);
        // Seen from the centre every triangle faces the same way.
        EXPECT_EQ(piece.built.report.skipped, 0U);
    }
    EXPECT_EQ(triangles + reflector.skipped, mesh.triangleCount());
}

TEST(ReflectorPieces, KeepAConvexBodyWhole) {
    for (const glm::dvec3 radii :
         {glm::dvec3(1, 1, 1), glm::dvec3(1, .05, .1), glm::dvec3(.001, .002, .001)}) {
        const city::Mesh mesh = meshOf(ellipsoid(radii), 24);
        const Reflector reflector = makeReflector(mesh);
        ASSERT_EQ(reflector.pieces.size(), 1U);
        EXPECT_EQ(reflector.pieces[0].bend, Bend::convex);
        EXPECT_DOUBLE_EQ(reflector.pieces[0].built.report.coveredShare, 1.0);
    }
}

TEST(ReflectorPieces, KeepABowlWholeAndConcave) {
    const city::Mesh bowl = meshOf(ellipsoid({.3, .3, .2}), 24, 1.7, glm::pi<double>(), true);
    const Reflector reflector = makeReflector(bowl);
    ASSERT_EQ(reflector.pieces.size(), 1U);
    EXPECT_EQ(reflector.pieces[0].bend, Bend::concave);
    expectWholePieces(bowl, reflector);
}

TEST(ReflectorPieces, CutRingsInsteadOfFailing) {
    for (const double tube : {0.3, 0.05}) {
        const city::Mesh ring = torus(1, tube, 48, 16);
        const Reflector reflector = makeReflector(ring);
        expectWholePieces(ring, reflector);
        EXPECT_GE(reflector.pieces.size(), 2U);
        // Most of the area is in a few pieces.
        std::size_t inLargest = 0;
        for (std::size_t k = 0; k < std::min<std::size_t>(12, reflector.pieces.size()); ++k)
            inLargest += reflector.pieces[k].mesh.triangleCount();
        EXPECT_GT(inLargest, ring.triangleCount() * 8 / 10);
    }
}

TEST(ReflectorPieces, OfTwoBodiesAreTwo) {
    city::Mesh two = meshOf(ellipsoid({1, 1, 1}), 16);
    city::Mesh other = meshOf(ellipsoid({1, 1, 1}), 16);
    for (city::Vertex& v : other.vertices) v.position.x += 5;
    two.append(other);
    EXPECT_EQ(makeReflector(two).pieces.size(), 2U);
}

TEST(ReflectorPieces, CoverTheChromeOfEveryVehicle) {
    for (const vehicles::VehicleModel& model : vehicles::builtInFleet()) {
        SCOPED_TRACE(model.name);
        city::Mesh chrome;
        const city::Mesh& body = model.levels[0].body;
        for (std::size_t k = 0; k + 2 < body.indices.size(); k += 3) {
            const auto corner = [&](std::size_t i) { return body.vertices[body.indices[k + i]]; };
            if (corner(0).material == static_cast<std::uint32_t>(vehicles::Surface::chrome))
                chrome.addTriangle(corner(0), corner(1), corner(2));
        }
        const Reflector reflector = makeReflector(chrome);
        expectWholePieces(chrome, reflector);
        EXPECT_LE(reflector.pieces.size(), 24U);
    }
}

TEST(ReflectorPieces, SurviveMeshesThatAreNotManifold) {
    city::Mesh mesh = meshOf(ellipsoid({1, 1, 1}), 12);
    // A fin on an edge, the same triangle twice, one turned round, one without area, one that is not finite.
    const auto v = [&](std::size_t k) { return mesh.vertices[k]; };
    city::Vertex out = v(30);
    out.position *= 2.0f;
    mesh.addTriangle(v(30), v(31), out);
    mesh.addTriangle(v(60), v(61), v(90));
    mesh.addTriangle(v(60), v(61), v(90));
    mesh.addTriangle(v(61), v(60), v(90));
    mesh.addTriangle(v(70), v(70), v(71));
    out.position.x = std::numeric_limits<float>::infinity();
    mesh.addTriangle(v(1), v(2), out);
    const Reflector reflector = makeReflector(mesh);
    std::size_t triangles = 0;
    for (const ReflectorPiece& piece : reflector.pieces) triangles += piece.mesh.triangleCount();
    EXPECT_EQ(triangles + reflector.skipped, mesh.triangleCount());
    EXPECT_GT(reflector.skipped, 1U);
    EXPECT_TRUE(makeReflector({}).pieces.empty());
}

}  // namespace
}  // namespace reflection
