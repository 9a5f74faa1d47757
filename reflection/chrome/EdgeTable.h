#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace reflection {

/// A number for each of many edges, by their keys, made anew for each picture: one piece of memory that is
/// kept, emptied without being touched. Linear probing, at most half full.
class EdgeTable {
  public:
    void clear() {
        filled = 0;
        // Entries of other turns count as empty; once in four thousand million turns they are wiped.
        if (++turn == 0) {
            entries.assign(entries.size(), {});
            turn = 1;
        }
    }
    /// Null if there is none. Holds until the next one is added.
    const std::uint32_t* find(std::uint64_t key) const {
        if (entries.empty()) return nullptr;
        const Entry& e = entries[placeOf(key)];
        return e.turn == turn ? &e.value : nullptr;
    }
    /// The number that is there, or the one given; true: it was added.
    std::pair<std::uint32_t, bool> add(std::uint64_t key, std::uint32_t value) {
        Entry& e = entryFor(key);
        if (e.turn == turn) return {e.value, false};
        fill(e, key, value);
        return {value, true};
    }
    void set(std::uint64_t key, std::uint32_t value) {
        Entry& e = entryFor(key);
        if (e.turn == turn)
            e.value = value;
        else
            fill(e, key, value);
    }

  private:
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t value = 0, turn = 0;
    };
    static constexpr std::size_t least = 64;

    std::size_t placeOf(std::uint64_t key) const {
        const std::size_t mask = entries.size() - 1;
        // Fibonacci's: the golden ratio spreads neighbouring numbers over the high bits.
        auto at =
            static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> (64 - std::countr_zero(entries.size())));
        while (entries[at].turn == turn && entries[at].key != key) at = (at + 1) & mask;
        return at;
    }
    Entry& entryFor(std::uint64_t key) {
        if (2 * (filled + 1) > entries.size()) grow();
        return entries[placeOf(key)];
    }
    void fill(Entry& e, std::uint64_t key, std::uint32_t value) {
        e = {key, value, turn};
        ++filled;
    }
    void grow() {
        std::vector<Entry> old(entries.empty() ? least : 2 * entries.size());
        old.swap(entries);
        for (const Entry& e : old)
            if (e.turn == turn) entries[placeOf(e.key)] = e;
    }

    std::vector<Entry> entries;
    std::size_t filled = 0;
    std::uint32_t turn = 1;
};

}  // namespace reflection
