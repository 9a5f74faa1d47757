#include "app/commands/Calibration.h"

#include <gtest/gtest.h>

namespace app {
namespace {

DetailLadder ladder() {
    Rung fine, cheap;
    fine.detail.reflection = detailOf(Quality::high);
    fine.drawingMs = 20.25;
    fine.reflectionMs = 1.0 / 3;
    fine.error = 0.031;
    cheap = fine;
    cheap.detail.drawing = {0.35, 0, 10};
    cheap.drawingMs = 5;
    cheap.error = 0.2;
    cheap.pictureError = 0.06;
    cheap.jump = 0.04;
    return DetailLadder({fine, cheap}, {12.5, 0.02});
}

TEST(CalibrationTest, comesBackFromItsFileAsItWas) {
    const DetailLadder was = ladder();
    const auto is = ladderFromText(ladderToText(was, "this machine"), "this machine");
    ASSERT_TRUE(is);
    ASSERT_EQ(is->rungs().size(), 2u);
    EXPECT_EQ(is->vehicles(), was.vehicles());
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(is->rungs()[i].detail, was.rungs()[i].detail);
        EXPECT_EQ(is->rungs()[i].ms(), was.rungs()[i].ms());
        EXPECT_EQ(is->rungs()[i].error, was.rungs()[i].error);
        EXPECT_EQ(is->rungs()[i].pictureError, was.rungs()[i].pictureError);
        EXPECT_EQ(is->rungs()[i].jump, was.rungs()[i].jump);
    }
}

TEST(CalibrationTest, anotherMachinesOrADamagedOneIsNotTaken) {
    const std::string text = ladderToText(ladder(), "this machine");
    EXPECT_FALSE(ladderFromText(text, "another machine"));
    for (std::size_t length = 0; length + 3 < text.size(); length += 7)
        EXPECT_FALSE(ladderFromText(text.substr(0, length), "this machine")) << length;
    std::string odd = text;
    odd.replace(odd.find("20.25"), 5, "\"x\"  ");
    EXPECT_FALSE(ladderFromText(odd, "this machine"));
    odd = text;
    odd.replace(odd.find("500000.0"), 8, "-50000.0");
    EXPECT_FALSE(ladderFromText(odd, "this machine"));
    EXPECT_FALSE(ladderFromText(ladderToText(DetailLadder(), "this machine"), "this machine"));
}

}  // namespace
}  // namespace app
