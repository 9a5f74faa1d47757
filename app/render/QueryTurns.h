#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace app {

/// Which of a few timer queries measures a frame, and what the newest of their results says. Plain data: who
/// owns the queries asks here. Results may come frames late, not at all, or be nonsense.
class QueryTurns {
  public:
    /// Frames that a graphics card is behind at most, where it is to be measured.
    static constexpr std::size_t slots = 4;
    /// Frames after which a result that has not come will not come: two seconds.
    static constexpr std::uint64_t lostAfter = 120;
    /// No frame takes longer, milliseconds: a clock that wrapped or a card that was reset.
    static constexpr double longestMs = 10'000;

    /// A frame begins. `result(slot)`: milliseconds of the query that was begun there last, or nothing as
    /// yet; asked for those that have not answered, oldest first. Returns the slot whose query is to be
    /// begun; nothing where all are waited for.
    template <typename Result>
    std::optional<std::size_t> begin(const Result& result) {
        ++frame_;
        for (std::size_t i = 0; i < slots; ++i) {
            Slot& slot = slots_[(next_ + i) % slots];
            if (!slot.pending) continue;
            if (const std::optional<double> ms = result((next_ + i) % slots)) {
                slot.pending = false;
                if (!std::isfinite(*ms) || *ms < 0 || *ms > longestMs) continue;
                if (slot.begun < measured_) continue;  // a newer one was faster
                newest_ = *ms;
                measured_ = slot.begun;
            } else if (frame_ - slot.begun > lostAfter) {
                slot.pending = false;
            }
        }
        // What the card took long ago says nothing of now.
        if (frame_ - measured_ > lostAfter) newest_ = 0;
        open_ = !slots_[next_].pending;
        if (!open_) return std::nullopt;
        return next_;
    }
    /// The frame ends. Returns whether a query is to be ended: the one that was begun.
    bool end() {
        if (!open_) return false;
        slots_[next_] = {true, frame_};
        next_ = (next_ + 1) % slots;
        open_ = false;
        return true;
    }
    /// Of the newest frame that is known, milliseconds; 0 while none is.
    double milliseconds() const { return newest_; }

  private:
    struct Slot {
        bool pending = false;
        std::uint64_t begun = 0;  ///< frame
    };
    std::array<Slot, slots> slots_;
    std::size_t next_ = 0;
    std::uint64_t frame_ = 0, measured_ = 0;
    bool open_ = false;
    double newest_ = 0;
};

}  // namespace app
