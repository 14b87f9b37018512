// Returns entries a fixed number of bus cycles after they were put in. Plain data: a copy is a checkpoint.
#pragma once

#include <array>
#include <cstddef>

namespace giveway::testbed {

inline constexpr int max_delay_cycles = 64;

template <class Entry> class DelayLine {
public:
    // Until the first entries arrive, `history(j)` is the entry of j cycles before the start, j = 1 .. delay.
    template <class History> void start(int delay_cycles, History history) {
        delay_ = delay_cycles;
        next_ = 0;
        for (int j = 1; j <= delay_; ++j) {
            entries_[static_cast<std::size_t>(delay_ + 1 - j)] = history(j);
        }
    }

    // Puts in this cycle's entry and returns the entry of `delay_cycles` ago.
    Entry exchange(const Entry &entry) {
        entries_[static_cast<std::size_t>(next_)] = entry;
        next_ = next_ == delay_ ? 0 : next_ + 1; // only as many places as needed, so that they stay in the processor's
                                                 // cache
        return entries_[static_cast<std::size_t>(next_)];
    }

private:
    std::array<Entry, max_delay_cycles + 1> entries_{};
    int delay_ = 0;
    int next_ = 0;
};

} // namespace giveway::testbed
