// The governor against a simulated machine.
#include "app/frame/Governor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/reflection/tracing/SeededRandom.h"

namespace app {
namespace {

using reflection::SeededRandom;

DetailLadder ladder() {
    std::vector<Rung> rungs;
    Rung rung;
    rung.detail.reflection = detailOf(Quality::high);
    rung.drawingMs = 20;
    rung.reflectionMs = 8;
    rung.error = 0.03;
    rungs.push_back(rung);
    rung.detail.reflection = detailOf(Quality::medium);
    rung.reflectionMs = 4;
    rung.error = 0.04;
    rungs.push_back(rung);
    rung.detail.reflection = detailOf(Quality::low);
    rung.reflectionMs = 1.5;
    rung.error = 0.05;
    rungs.push_back(rung);
    for (const double scale : {0.8, 0.6, 0.4}) {
        rung.detail.drawing.scale = scale;
        rung.drawingMs = 5 + 15 * scale * scale;
        rung.pictureError = 0.1 * (1 - scale);
        rungs.push_back(rung);
    }
    return DetailLadder(rungs);
}

/// What a machine takes for a detail under a load; not quite what the ladder says.
struct Machine {
    double load = 1;
    double reflectionLoad = 1;
    double bend = 1;  ///< 1: as the ladder says; else drawing follows another power of the scale

    FrameCost run(const Governor& governor) const {
        const Rung rung = governor.ladder().at(governor.position());
        FrameCost cost;
        cost.reflectionMs = reflectionLoad * rung.reflectionMs;
        cost.frameMs = load * 20 * std::pow(rung.drawingMs / 20, bend) + cost.reflectionMs;
        cost.reflecting = 20;
        return cost;
    }
};

/// Runs so many seconds of frames; the times of all.
std::vector<double> run(Governor& governor, const Machine& machine, double seconds) {
    std::vector<double> times;
    for (double t = 0; t < seconds;) {
        const FrameCost cost = machine.run(governor);
        governor.observe(cost);
        times.push_back(cost.frameMs);
        t += cost.frameMs / 1000;
    }
    return times;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

TEST(GovernorTest, meetsTheBudgetWithinASecondOfALoadStepWhateverTheMachinesBend) {
    for (const double bend : {0.6, 1.0, 1.6})
        for (const double budget : {16.0, 20.0, 24.0}) {
            Governor governor(ladder(), budget);
            Machine machine{0.9, 0.5, bend};
            run(governor, machine, 6);
            EXPECT_NEAR(machine.run(governor).frameMs, budget, 0.1 * budget) << bend << " " << budget;
            machine = {1.3, 1.5, bend};  // more cars
            run(governor, machine, 1);
            EXPECT_NEAR(machine.run(governor).frameMs, budget, 0.1 * budget) << bend << " " << budget;
            machine = {0.9, 0.5, bend};  // and gone again: the way back may take longer
            run(governor, machine, 6);
            EXPECT_NEAR(machine.run(governor).frameMs, budget, 0.1 * budget) << bend << " " << budget;
        }
}

TEST(GovernorTest, followsAClockThatGoesDown) {
    Governor governor(ladder(), 24);
    run(governor, {1, 1, 1}, 3);
    run(governor, {1.6, 1.6, 1}, 1);
    const std::vector<double> times = run(governor, {1.6, 1.6, 1}, 2);
    EXPECT_NEAR(median(times), 24, 0.05 * 24);
}

TEST(GovernorTest, staysWhereItIsUnderNoise) {
    SeededRandom random(7);
    Governor governor(ladder(), 20);
    run(governor, {1, 1, 1}, 4);
    const double settled = governor.position();
    double farthest = 0;
    std::vector<double> times;
    for (int i = 0; i < 2000; ++i) {
        FrameCost cost = Machine{}.run(governor);
        const double noise = random.between(0.96, 1.04);
        cost.frameMs *= noise;
        cost.reflectionMs *= noise;
        governor.observe(cost);
        times.push_back(cost.frameMs);
        farthest = std::max(farthest, std::abs(governor.position() - settled));
    }
    EXPECT_LT(farthest, 0.3);
    EXPECT_NEAR(median(times), 20, 0.05 * 20);
}

TEST(GovernorTest, aSlowFrameMovesNothing) {
    Governor governor(ladder(), 20);
    run(governor, {1, 1, 1}, 4);
    const double settled = governor.position();
    for (int i = 0; i < 300; ++i) {
        FrameCost cost = Machine{}.run(governor);
        if (i % 5 == 1 || i % 5 == 2) cost.frameMs *= 8;  // two of five
        governor.observe(cost);
        EXPECT_EQ(governor.position(), settled) << i;
    }
}

TEST(GovernorTest, noFrameIsMuchCheaperOrDearerThanTheOneBefore) {
    Governor governor(ladder(), 16);
    Machine machine;
    double before = machine.run(governor).frameMs;
    for (int i = 0; i < 600; ++i) {
        machine.load = (i / 150) % 2 == 0 ? 0.8 : 1.4;
        const FrameCost cost = machine.run(governor);
        // Down by 2.5 in logarithm a second, in a step of 0.05 s at most.
        if (i % 150 != 0) {
            EXPECT_GT(cost.frameMs, before * 0.85) << i;
            EXPECT_LT(cost.frameMs, before * 1.05) << i;
        }
        before = cost.frameMs;
        governor.observe(cost);
    }
}

TEST(GovernorTest, saysOnceWhatItCannotDo) {
    Governor tight(ladder(), 4);
    EXPECT_FALSE(tight.news());
    run(tight, {1, 1, 1}, 3);
    EXPECT_EQ(tight.position(), tight.ladder().last());
    const auto dear = tight.news();
    ASSERT_TRUE(dear);
    EXPECT_NE(dear->find("more than the budget of 4.0 ms"), std::string::npos) << *dear;
    run(tight, {1, 1, 1}, 3);
    EXPECT_FALSE(tight.news());

    Governor wide(ladder(), 100);
    run(wide, {1, 1, 1}, 3);
    EXPECT_EQ(wide.position(), 0);
    EXPECT_EQ(wide.givenUp(), "");
    ASSERT_TRUE(wide.news());
    EXPECT_FALSE(wide.news());
}

TEST(GovernorTest, whereNothingReflectsTheBudgetGoesToTheDrawing) {
    Governor governor(ladder(), 19.5);
    for (int i = 0; i < 400; ++i) {
        FrameCost cost = Machine{}.run(governor);
        cost.frameMs -= cost.reflectionMs;
        cost.reflectionMs = 0;
        cost.reflecting = 0;
        governor.observe(cost);
    }
    EXPECT_NEAR(governor.predictedMs(), 19.5, 2);
    EXPECT_GT(governor.detail().drawing.scale, 0.85);
}

TEST(GovernorTest, oddCostsAndBudgetsDoNoHarm) {
    for (const double budget : {0.0, -1.0, 1e9}) {
        Governor governor(ladder(), budget);
        for (const double ms : {std::nan(""), -1.0, 0.0, 1e300, 1e-300, 20.0})
            governor.observe({ms, ms / 2, 3});
        EXPECT_TRUE(std::isfinite(governor.position()));
        EXPECT_GE(governor.position(), 0);
        EXPECT_LE(governor.position(), governor.ladder().last());
        EXPECT_GT(governor.detail().drawing.scale, 0);
    }
}

TEST(DetailLadderTest, keepsTheFrontAlone) {
    SeededRandom random(3);
    for (int round = 0; round < 50; ++round) {
        std::vector<Rung> measured(30);
        for (Rung& rung : measured) {
            rung.drawingMs = random.between(5, 30);
            rung.error = random.between(0, 0.1);
            rung.pictureError = random.between(0, 0.1);
        }
        measured[7].error = std::nan("");
        const DetailLadder found(measured);
        ASSERT_FALSE(found.empty());
        // The slow way: nobody on the front is beaten, everybody off it is.
        std::size_t unbeaten = 0;
        for (const Rung& rung : measured) {
            if (std::isnan(rung.error)) continue;
            unbeaten += std::none_of(measured.begin(), measured.end(), [&](const Rung& other) {
                return other.loss() <= rung.loss() && other.ms() <= rung.ms() &&
                       (other.loss() < rung.loss() || other.ms() < rung.ms());
            });
        }
        EXPECT_EQ(found.rungs().size(), unbeaten);
        for (std::size_t i = 1; i < found.rungs().size(); ++i) {
            EXPECT_LT(found.rungs()[i].ms(), found.rungs()[i - 1].ms());
            EXPECT_GT(found.rungs()[i].loss(), found.rungs()[i - 1].loss());
        }
    }
}

TEST(DetailLadderTest, anErrorAskedForIsMetByTheCheapest) {
    const DetailLadder steps = ladder();
    EXPECT_EQ(steps.positionForError(0.02), 0);  // none is that good
    EXPECT_NEAR(steps.at(steps.positionForError(0.035)).error, 0.035, 1e-12);
    EXPECT_EQ(steps.positionForError(1), steps.last());
    EXPECT_NEAR(steps.at(steps.positionForMs(22)).ms(), 22, 1e-9);
    EXPECT_EQ(steps.positionForMs(1), steps.last());
    EXPECT_EQ(steps.positionForMs(100), 0);
}

TEST(DetailLadderTest, whatLosesLeastForAMillisecondIsGivenUpFirst) {
    const std::vector<Trial> trials{{Knob::scale, 0.8, 6, 0.06},         {Knob::scale, 0.5, 12, 0.18},
                                    {Knob::texelBudget, 80e3, 2, 0.002}, {Knob::texelBudget, 20e3, 3, 0.1},
                                    {Knob::lookups, 2, 0.01, 0},         {Knob::antialiasing, 0, 2, 0.01}};
    const std::vector<Detail> order = orderOfGivingUp({}, trials, 0.1);
    ASSERT_EQ(order.size(), 6u);  // the lookups save nothing
    EXPECT_EQ(order[1].reflection.texelBudget, 80e3);
    EXPECT_EQ(order[2].drawing.antialiasing, 0);
    EXPECT_EQ(order[3].drawing.scale, 0.8);
    EXPECT_EQ(order[4].drawing.scale, 0.5);
    EXPECT_EQ(order[5].reflection.texelBudget, 20e3);
    for (const Detail& detail : order) EXPECT_EQ(detail.reflection.lookups, Detail{}.reflection.lookups);
}

TEST(DetailTest, blendsExactlyAtItsEndsAndInBetweenOtherwise) {
    const Detail a{detailOf(Quality::high), {}}, b{detailOf(Quality::low), {0.5, 0, 10}};
    EXPECT_EQ(blend(a, b, 0), a);
    EXPECT_EQ(blend(a, b, 1), b);
    const Detail half = blend(a, b, 0.5);
    EXPECT_NEAR(half.reflection.texelBudget, std::sqrt(500e3 * 60e3), 1e-3);
    EXPECT_NEAR(half.drawing.scale, 0.75, 1e-12);
    EXPECT_EQ(givenUp(a, a), "");
    EXPECT_NE(givenUp(a, b).find("drawn at 50%"), std::string::npos);
}

}  // namespace
}  // namespace app
