#include "app/panel/MapView.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace app {
namespace {

TEST(MapViewTest, facesLieRoundTheHorizonInTheirCells) {
    const std::vector<glm::ivec2> cells{{2, 1}, {0, 1}, {1, 1}, {3, 1}, {1, 0}, {1, 2}};
    for (int face = 0; face < 6; ++face) {
        const glm::vec2 middle = unfolded(face, 0.5, 0.5) * glm::vec2(mapViewFaces);
        EXPECT_LT(glm::distance(middle, glm::vec2(cells[static_cast<std::size_t>(face)]) + 0.5f), 1e-5f)
            << face;
        // The corners of a face are the corners of its cell.
        for (const double s : {0.0, 1.0})
            for (const double t : {0.0, 1.0}) {
                const glm::vec2 corner = unfolded(face, s, t) * glm::vec2(mapViewFaces) - middle;
                EXPECT_NEAR(std::abs(corner.x), 0.5, 1e-5);
                EXPECT_NEAR(std::abs(corner.y), 0.5, 1e-5);
            }
    }
}

TEST(MapViewTest, facesThatTouchInTheWorldTouchInThePicture) {
    // East's edge to the north: face +X has sc = -z, tc = -y, so north is t = 0 there; face +Y has sc = x:
    // east is s = 1.
    for (const double z : {-0.8, 0.0, 0.6}) {
        const glm::vec2 onEast = unfolded(0, 0.5 - 0.5 * z, 0);
        const glm::vec2 onNorth = unfolded(2, 1, 0.5 + 0.5 * z);
        EXPECT_LT(glm::distance(onEast, onNorth), 1e-5f) << z;
    }
    // What is higher in the world is higher in the picture.
    EXPECT_LT(unfolded(0, 0.5 - 0.5 * 0.9, 0.5).y, unfolded(0, 0.5 + 0.5 * 0.9, 0.5).y);
    // Up's edge towards north meets north's upper edge: +Z has tc = -y.
    EXPECT_LT(glm::distance(unfolded(4, 0.3, 0), unfolded(2, 0.3, 1)), 1e-5f);
}

TEST(MapViewTest, aMeshOfOneQuadIsTheFacesBorder) {
    reflection::LocalMapMesh::Quad quad{};
    quad.size = 8;
    const auto lines = unfoldedMesh(2, std::vector{quad}, 8);
    EXPECT_EQ(lines.size(), 4u);
    EXPECT_TRUE(unfoldedMesh(2, std::vector{quad}, 0).empty());
}

}  // namespace
}  // namespace app
