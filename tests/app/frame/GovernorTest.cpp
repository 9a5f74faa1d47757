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

constexpr double vehicleMs = 0.03;
constexpr std::size_t fewVehicles = 20;

DetailLadder ladder(VehicleCost vehicles = {fewVehicles, vehicleMs}) {
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
    rung.jump = 0.0003;
    rungs.push_back(rung);
    rung.detail.reflection = detailOf(Quality::low);
    rung.reflectionMs = 1.5;
    rung.error = 0.05;
    rungs.push_back(rung);
    rung.detail.drawing.antialiasing = 0;
    rung.drawingMs = 15;
    rung.pictureError = 0.01;
    rung.jump = 0.008;
    rungs.push_back(rung);
    for (const double scale : {0.9, 0.8, 0.7, 0.6, 0.5, 0.4}) {
        rung.detail.drawing.scale = scale;
        rung.drawingMs = 4 + 11 * scale * scale;
        rung.pictureError = 0.01 + 0.1 * (1 - scale);
        rung.jump = 0.03;
        rungs.push_back(rung);
    }
    return DetailLadder(rungs, vehicles);
}

/// What a machine takes for a detail under a load; not quite what the ladder says.
struct Machine {
    double load = 1;
    double reflectionLoad = 1;
    double bend = 1;  ///< 1: as the ladder says; else drawing follows another power of the scale
    std::size_t vehicles = fewVehicles;

    FrameCost run(const Governor& governor) const {
        const Rung rung = governor.ladder().at(governor.position());
        const double more = (static_cast<double>(vehicles) - fewVehicles) * vehicleMs;
        FrameCost cost;
        cost.reflectionMs = reflectionLoad * rung.reflectionMs;
        cost.frameMs = load * std::pow(rung.drawingMs / 20, bend) * (20 + more) + cost.reflectionMs;
        cost.reflecting = vehicles;
        return cost;
    }
};

/// Runs so many seconds of frames; the times of all.
std::vector<double> run(Governor& governor, const Machine& machine, double seconds, bool still = true) {
    std::vector<double> times;
    for (double t = 0; t < seconds;) {
        governor.expect({machine.vehicles, still});
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

bool restsAtOneSize(const Governor& governor) {
    const double p = governor.position();
    const auto lower = static_cast<std::size_t>(p);
    return p == std::floor(p) || !governor.ladder().resizes(lower);
}

TEST(GovernorTest, meetsTheBudgetWithinASecondOfALoadStepWhateverTheMachinesBend) {
    for (const bool still : {true, false})
        for (const double bend : {0.7, 1.0, 1.4})
            for (const double budget : {16.0, 20.0, 24.0}) {
                Governor governor(ladder(), budget);
                Machine machine{0.9, 0.5, bend};
                run(governor, machine, 6, still);
                // Between two sizes of the picture there may be a gap.
                EXPECT_NEAR(machine.run(governor).frameMs, budget, 0.13 * budget) << bend << " " << budget;
                machine = {1.3, 1.5, bend};  // more to draw
                run(governor, machine, 1, still);
                EXPECT_LT(machine.run(governor).frameMs, 1.08 * budget) << bend << " " << budget;
                EXPECT_GT(machine.run(governor).frameMs, 0.75 * budget) << bend << " " << budget;
                machine = {0.9, 0.5, bend};  // and gone again: the way back may take longer
                run(governor, machine, 8, still);
                EXPECT_NEAR(machine.run(governor).frameMs, budget, 0.13 * budget) << bend << " " << budget;
            }
}

TEST(GovernorTest, followsAClockThatGoesDown) {
    Governor governor(ladder(), 24);
    run(governor, {1, 1, 1}, 3);
    // Within a second, some frames at a time.
    double load = 1;
    for (int i = 0; i < 20; ++i) run(governor, {load += 0.03, load, 1}, 0.05);
    const std::vector<double> times = run(governor, {load, load, 1}, 2);
    EXPECT_NEAR(median(times), 24, 0.1 * 24);
    EXPECT_LT(*std::max_element(times.begin() + 8, times.end()), 1.1 * 24);
}

TEST(GovernorTest, foreseesWhatVehiclesCostBeforeTheyAreDrawn) {
    const Machine few, many{1, 1, 1, 400};
    const auto firstFrame = [&](const DetailLadder& steps) {
        Governor governor(steps, 20);
        run(governor, few, 3);
        governor.expect({many.vehicles, true});
        return many.run(governor).frameMs;
    };
    EXPECT_LT(firstFrame(ladder()), 1.1 * 20);
    // Who does not know what a vehicle costs is surprised.
    EXPECT_GT(firstFrame(ladder({})), 1.3 * 20);

    // And when they leave, what they took is given back at once.
    Governor governor(ladder(), 20);
    run(governor, many, 3);
    EXPECT_NEAR(many.run(governor).frameMs, 20, 0.13 * 20);
    governor.expect({few.vehicles, true});
    EXPECT_NEAR(few.run(governor).frameMs, 20, 0.15 * 20);
}

TEST(GovernorTest, staysWhereItIsUnderNoise) {
    SeededRandom random(7);
    Governor governor(ladder(), 20);
    run(governor, {1, 1, 1}, 4);
    const double settled = governor.position();
    double farthest = 0;
    std::vector<double> times;
    for (int i = 0; i < 2000; ++i) {
        governor.expect({fewVehicles, true});
        EXPECT_EQ(governor.dissolveFrames(), 0) << i;
        FrameCost cost = Machine{}.run(governor);
        const double noise = random.between(0.96, 1.04) * (random.between(0, 1) < 0.05 ? 1.6 : 1);
        cost.frameMs *= noise;
        cost.reflectionMs *= noise;
        governor.observe(cost);
        times.push_back(cost.frameMs);
        farthest = std::max(farthest, std::abs(governor.position() - settled));
    }
    EXPECT_LT(farthest, 0.5);
    EXPECT_NEAR(median(times), 20, 0.06 * 20);
}

TEST(GovernorTest, aSlowFrameMovesNothing) {
    Governor governor(ladder(), 20);
    run(governor, {1, 1, 1}, 4);
    const double settled = governor.position();
    for (int i = 0; i < 300; ++i) {
        governor.expect({fewVehicles, true});
        FrameCost cost = Machine{}.run(governor);
        if (i % 7 == 1 || i % 7 == 2 || i % 7 == 5) cost.frameMs *= 8;  // three of seven
        governor.observe(cost);
        EXPECT_EQ(governor.position(), settled) << i;
    }
}

TEST(GovernorTest, noFrameOfAStandingViewShowsAChangeThatIsSeen) {
    // Whatever the load does: what a frame shows of a change is below the traffic's own motion, far down a
    // street (mean FLIP 0.0003).
    SeededRandom random(11);
    for (int round = 0; round < 20; ++round) {
        Governor governor(ladder(), random.between(12, 26));
        double left = 0;  // of a change that is going on
        int frames = 0;
        bool longest = false;
        double before = governor.position();
        Machine machine;
        for (int i = 0; i < 1500; ++i) {
            if (i % 100 == 0)
                machine = {random.between(0.7, 1.5), random.between(0.5, 2), 1,
                           static_cast<std::size_t>(random.between(1, 300))};
            governor.expect({machine.vehicles, i > 0});
            const double change = governor.ladder().jumpBetween(before, governor.position());
            if (governor.dissolveFrames() > 0) {
                left += change;
                frames = governor.dissolveFrames();
                longest = longest || frames == 1200;
            } else if (i > 0) {
                EXPECT_LE(change, 0.0000401) << round << " " << i;
            }
            if (frames > 0) {
                // Very large ones are cut short: nobody wants to wait for them.
                EXPECT_LE(left / frames, longest ? 0.001 : 0.00008) << round << " " << i;
                left -= left / frames;
                --frames;
            }
            EXPECT_TRUE(restsAtOneSize(governor)) << governor.position();
            before = governor.position();
            governor.observe(machine.run(governor));
        }
    }
}

TEST(GovernorTest, whatEachVehicleShowsFollowsAtARateUnlessNobodySeesIt) {
    std::vector<Rung> rungs(2);
    rungs[0].drawingMs = 20;
    rungs[0].detail.reflection.texelsPerPixel = 1;
    rungs[1] = rungs[0];
    rungs[1].drawingMs = 10;
    rungs[1].error = 0.1;
    rungs[1].detail.drawing = {0.5, 0, 10};
    rungs[1].detail.reflection.texelsPerPixel = 0.25;
    for (const bool still : {true, false}) {
        Governor governor(DetailLadder(rungs), 20.5);
        double before = 1;
        int frames = 0;
        for (int i = 0; i < 200; ++i) {
            governor.expect({10, still});
            const Detail now = governor.detail();
            const double share = now.reflection.texelsPerPixel / before;
            if (still) {
                EXPECT_GE(share, 1 / 1.0301) << i;
                EXPECT_LE(now.drawing.vehicleTolerance, 2.5 * std::pow(1.0301, frames + 1)) << i;
            }
            before = now.reflection.texelsPerPixel;
            if (now.drawing.scale == 0.5) ++frames;
            // Twice the load, at once.
            const double ms = governor.position() == 0 ? 20 : 10;
            governor.observe({i < 20 ? ms : 2 * ms, 0.1, 10, 0});
        }
        EXPECT_GT(frames, 100);
        EXPECT_EQ(before, 0.25);
        EXPECT_EQ(governor.detail().drawing.vehicleTolerance, 10);
    }
}

TEST(GovernorTest, windowsReflectionsNeverComeOrGoAtOnceInAStandingView) {
    // The trap: the view in which a ladder was measured hardly showed them.
    std::vector<Rung> rungs(2);
    rungs[0].drawingMs = 20;
    rungs[1] = rungs[0];
    rungs[1].drawingMs = 10;
    rungs[1].error = 0.1;
    rungs[1].detail.mirrors = {0.7, 0, 1};
    Governor governor(DetailLadder(rungs), 20.5);
    SeededRandom random(3);
    int changes = 0, left = 0;
    double load = 1;
    MirrorDetail before;
    for (int i = 0; i < 2000; ++i) {
        if (i % 100 == 0) load = random.between(0.7, 2.1);
        governor.expect({10, i > 0});
        const MirrorDetail now = governor.detail().mirrors;
        left = std::max(left - 1, governor.dissolveFrames());
        if (i > 0 && !now.drawsAsMany(before)) {
            ++changes;
            EXPECT_GE(left, 60) << i;
        }
        before = now;
        governor.observe({load * governor.ladder().at(governor.position()).drawingMs, 0, 10, 0});
    }
    EXPECT_GT(changes, 4);
}

TEST(GovernorTest, doesNotGoUpAndDownForEver) {
    // A machine on which the next larger picture always turns out too dear.
    Governor governor(ladder(), 16);
    int steps = 0;
    for (int i = 0; i < 6000; ++i) {  // a minute and a half
        const double before = governor.position();
        governor.expect({fewVehicles, true});
        if (std::abs(governor.position() - before) >= 1) ++steps;
        FrameCost cost = Machine{}.run(governor);
        if (governor.detail().drawing.scale == 1) cost.frameMs = 22;
        governor.observe(cost);
    }
    EXPECT_LT(steps, 40);
}

TEST(GovernorTest, mapsTakeAShareOfTheBudgetEach) {
    Governor governor(ladder(), 20);
    for (int i = 0; i < 100; ++i) {
        governor.expect({fewVehicles, true});
        const double wanted = governor.detail().reflection.texelBudget;
        // 20 ns a texel, and five times as many as wanted come due.
        FrameCost cost{16, wanted * 20e-6, fewVehicles, static_cast<std::uint64_t>(wanted)};
        cost.frameMs = 10 + cost.reflectionMs;
        governor.observe(cost);
    }
    const double ms = governor.detail().reflection.texelBudget * 20e-6;
    EXPECT_LE(ms, 0.1 * 20 + 1e-9);
    EXPECT_GE(ms, 0.05 * 20);
    EXPECT_LT(governor.detail().reflection.texelBudget,
              governor.ladder().at(governor.position()).detail.reflection.texelBudget);
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
        governor.expect({0, true});
        FrameCost cost = Machine{}.run(governor);
        cost.frameMs -= cost.reflectionMs;
        cost.reflectionMs = 0;
        cost.reflecting = 0;
        governor.observe(cost);
    }
    EXPECT_NEAR(governor.predictedMs(), 19.5, 2);
    EXPECT_EQ(governor.detail().drawing.scale, 1);
    EXPECT_GT(governor.detail().drawing.antialiasing, 0.5);
}

TEST(GovernorTest, oddCostsAndBudgetsDoNoHarm) {
    for (const double budget : {0.0, -1.0, 1e9}) {
        Governor governor(ladder(), budget);
        for (const double ms : {std::nan(""), -1.0, 0.0, 1e300, 1e-300, 20.0, 1e-300, 1e300})
            for (const std::size_t vehicles : {0u, 3u, 1u << 31}) {
                governor.expect({vehicles, true});
                governor.observe({ms, ms / 2, vehicles, vehicles});
                EXPECT_GE(governor.dissolveFrames(), 0);
                EXPECT_TRUE(std::isfinite(governor.detail().reflection.texelBudget));
            }
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

TEST(DetailLadderTest, thePicturesSizeChangesAtRungsAlone) {
    const DetailLadder steps = ladder();
    for (double p = 0; p <= steps.last(); p += 0.01) {
        const double scale = steps.at(p).detail.drawing.scale;
        EXPECT_NEAR(scale, 0.1 * std::round(10 * scale), 1e-12) << p;
        const auto [first, last] = steps.sameSize(p);
        EXPECT_EQ(steps.at(first).detail.drawing.scale, scale);
        EXPECT_EQ(steps.at(last).detail.drawing.scale, scale);
        EXPECT_LE(first, p + 0.5);
        EXPECT_GE(last, p - 0.5);
    }
    EXPECT_EQ(steps.sameSize(1.5), (std::pair<double, double>(0, 3)));
    EXPECT_EQ(steps.sameSize(4), (std::pair<double, double>(4, 4)));
    EXPECT_NEAR(steps.jumpBetween(2, 2.5), 0.004, 1e-12);
    EXPECT_NEAR(steps.jumpBetween(4, 2.5), 0.034, 1e-12);
    EXPECT_NEAR(steps.jumpBetween(3.2, 3.4), 0, 1e-12);
    EXPECT_EQ(steps.jumpBetween(3.4, 3.4), 0);
}

TEST(DetailLadderTest, anErrorAskedForIsMetByTheCheapest) {
    const DetailLadder steps = ladder();
    EXPECT_EQ(steps.positionForError(0.02), 0);  // none is that good
    EXPECT_NEAR(steps.at(steps.positionForError(0.035)).error, 0.035, 1e-12);
    EXPECT_EQ(steps.positionForError(1), steps.last());
}

TEST(DetailLadderTest, whatLosesLeastForAMillisecondIsGivenUpFirst) {
    const std::vector<Trial> trials{{Knob::scale, 0.8, 6, 0.06},         {Knob::scale, 0.5, 12, 0.18},
                                    {Knob::texelBudget, 80e3, 2, 0.002}, {Knob::texelBudget, 20e3, 3, 0.1},
                                    {Knob::lookups, 2, 0.01, 0.001},     {Knob::antialiasing, 0, 2, 0.01}};
    const std::vector<Detail> order = orderOfGivingUp({}, trials, 0.1);
    ASSERT_EQ(order.size(), 8u);  // the lookups save nothing
    EXPECT_EQ(order[1].reflection.texelBudget, 80e3);
    EXPECT_EQ(order[2].drawing.antialiasing, 0);
    EXPECT_EQ(order[3].drawing.scale, 0.8);
    EXPECT_EQ(order[3].reflection.texelBudget, Detail{}.reflection.texelBudget);  // back again
    EXPECT_EQ(order[3].drawing.antialiasing, 0);
    EXPECT_EQ(order[4].drawing.scale, 0.8);
    EXPECT_EQ(order[4].reflection.texelBudget, 80e3);
    EXPECT_EQ(order[5].drawing.scale, 0.5);
    EXPECT_EQ(order[6].reflection.texelBudget, 80e3);
    EXPECT_EQ(order[7].reflection.texelBudget, 20e3);
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

TEST(DetailTest, windowsAreGivenUpWithTheirOwnWordsAndInWholeReflections) {
    Detail all, few;
    all.mirrors = {1, 8, 2};
    few.mirrors = {0.5, 1, 1};
    EXPECT_EQ(blend(all, few, 0), all);
    EXPECT_EQ(blend(all, few, 1), few);
    EXPECT_NEAR(blend(all, few, 0.5).mirrors.texels, std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(blend(all, few, 0.5).mirrors.maps, 4.5, 1e-12);
    EXPECT_EQ(givenUp(all, few),
              "windows at 50% of the size, reflections in windows: 1, not 8, windows in a row: 1, not 2");
    // A hair less is the same number of reflections: nothing to tell.
    Detail hair = all;
    hair.mirrors.maps = 7.6;
    EXPECT_EQ(givenUp(all, hair), "");
}

TEST(DetailTest, closeChromeIsGivenUpFromItsSmallestPartsOn) {
    Detail all, large, none;
    large.chrome.leastPixels = 4 * all.chrome.leastPixels;
    none.chrome.leastPixels = ChromeDetail::none;
    EXPECT_EQ(blend(all, large, 1), large);
    EXPECT_NEAR(blend(all, large, 0.5).chrome.leastPixels, 2 * all.chrome.leastPixels, 1e-9);
    EXPECT_EQ(givenUp(all, large), "close things in chrome from 96 pixels on, not 24");
    EXPECT_EQ(givenUp(large, none), "no close things in chrome");
    EXPECT_EQ(&valueOf(all, Knob::chromePixels), &all.chrome.leastPixels);
}

TEST(Detail, SaysWhatChromeGivesUpAndOfChromeInChromeAll) {
    Detail full, now;
    now.chrome = {48, ChromeDetail::none};
    EXPECT_EQ(givenUp(full, now),
              "close things in chrome from 48 pixels on, not 24, no close things in chrome seen in chrome");
    EXPECT_EQ(givenUp(now, now), "");
    EXPECT_NEAR(blend(full, now, 0.5).chrome.leastPixels, std::sqrt(24. * 48), 1e-9);
    EXPECT_EQ(valueOf(now, Knob::bouncePixels), ChromeDetail::none);
}

}  // namespace
}  // namespace app
