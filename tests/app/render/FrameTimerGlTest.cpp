// What a frame took, when the graphics card answers late, never, or nonsense: queries that are simulated; and
// real ones on whatever OpenGL there is.
#include "app/render/FrameTimer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <thread>
#include <vector>

#include "app/display/OffscreenContext.h"

namespace app {
namespace {

/// A card that finishes frame n, which takes n + 1 ms, `late` frames after it began.
struct Card {
    std::uint64_t late = 1;
    std::uint64_t frame = 0;
    std::map<std::size_t, std::uint64_t> begunIn{};  ///< by slot
    std::vector<std::size_t> used{};

    std::optional<double> result(std::size_t slot) const {
        const std::uint64_t begun = begunIn.at(slot);
        if (frame < begun + late) return std::nullopt;
        return static_cast<double>(begun) + 1;
    }
    void run(QueryTurns& turns) {
        if (const auto slot = turns.begin([this](std::size_t s) { return result(s); })) {
            begunIn[*slot] = frame;
            used.push_back(*slot);
            EXPECT_TRUE(turns.end());
        } else {
            EXPECT_FALSE(turns.end());
        }
        ++frame;
    }
};

TEST(QueryTurnsTest, theNewestFinishedFrameCountsHoweverLateItIs) {
    for (std::uint64_t late = 1; late <= QueryTurns::slots; ++late) {
        QueryTurns turns;
        Card card{late};
        for (int i = 0; i < 50; ++i) {
            card.run(turns);
            // Frame i has begun; known are those up to i - late.
            const double known = i >= static_cast<int>(late) ? i - static_cast<double>(late) + 1 : 0;
            EXPECT_EQ(turns.milliseconds(), known) << i << " late by " << late;
        }
        EXPECT_EQ(card.used.size(), 50u) << "every frame is measured";
    }
}

TEST(QueryTurnsTest, aCardFartherBehindIsMeasuredNowAndThen) {
    QueryTurns turns;
    Card card{10};
    for (int i = 0; i < 100; ++i) card.run(turns);
    EXPECT_LT(card.used.size(), 50u);
    EXPECT_GE(card.used.size(), 100u * QueryTurns::slots / 11);
    EXPECT_GT(turns.milliseconds(), 75);
}

TEST(QueryTurnsTest, noQueryIsBegunWhileItsResultIsWaitedFor) {
    QueryTurns turns;
    std::map<std::size_t, bool> pending;
    for (int i = 0; i < 40; ++i) {
        const auto slot = turns.begin([&](std::size_t s) -> std::optional<double> {
            EXPECT_TRUE(pending[s]) << "asked for a result that there is none of";
            if ((i + static_cast<int>(s)) % 3 != 0) return std::nullopt;  // in any order
            pending[s] = false;
            return 5.0;
        });
        if (!slot) continue;
        EXPECT_FALSE(pending[*slot]);
        pending[*slot] = true;
        turns.end();
    }
}

TEST(QueryTurnsTest, anOlderResultThatComesLaterIsNotTheNewest) {
    QueryTurns turns;
    const auto none = [](std::size_t) -> std::optional<double> { return std::nullopt; };
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(turns.begin(none));
        turns.end();
    }
    turns.begin([](std::size_t s) { return s == 1 ? std::optional(20.0) : std::nullopt; });
    turns.end();
    EXPECT_EQ(turns.milliseconds(), 20);
    turns.begin([](std::size_t s) { return s == 0 ? std::optional(10.0) : std::nullopt; });
    EXPECT_EQ(turns.milliseconds(), 20);
}

TEST(QueryTurnsTest, resultsThatNeverComeAreGivenUpAndWhatWasKnownIsForgotten) {
    QueryTurns turns;
    Card card{1};
    for (int i = 0; i < 10; ++i) card.run(turns);
    EXPECT_GT(turns.milliseconds(), 0);
    card.late = 1'000'000;  // the card was reset
    const std::size_t before = card.used.size();
    for (std::uint64_t i = 0; i < QueryTurns::lostAfter / 2; ++i) card.run(turns);
    EXPECT_GT(turns.milliseconds(), 0);
    EXPECT_LE(card.used.size(), before + QueryTurns::slots);
    for (std::uint64_t i = 0; i < QueryTurns::lostAfter; ++i) card.run(turns);
    EXPECT_EQ(turns.milliseconds(), 0);
    EXPECT_GT(card.used.size(), before + QueryTurns::slots) << "the queries are used again";
    card.late = 1;
    for (int i = 0; i < 10; ++i) card.run(turns);
    EXPECT_EQ(turns.milliseconds(), static_cast<double>(card.frame) - 1);
}

TEST(QueryTurnsTest, nonsenseIsLeftOut) {
    for (const double nonsense : {-1.0, 2 * QueryTurns::longestMs, std::nan(""),
                                  std::numeric_limits<double>::infinity(), 1.8446744073709552e13}) {
        QueryTurns turns;
        for (int i = 0; i < 20; ++i) {
            ASSERT_TRUE(turns.begin([&](std::size_t) { return std::optional(i < 10 ? 7.0 : nonsense); }));
            turns.end();
        }
        EXPECT_EQ(turns.milliseconds(), 7) << nonsense;
    }
}

TEST(FrameTimerGlTest, framesTakeAsLongAsTheyTakeWithAndWithoutWaiting) {
    OffscreenContext context;
    for (const bool waits : {true, false}) {
        FrameTimer timer(waits);
        for (int i = 0; i < 8; ++i) {
            timer.begin();
            glFlush();
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
            EXPECT_GE(timer.end(), 3) << waits;
        }
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR)) << "queries overlap";
    }
}

}  // namespace
}  // namespace app
