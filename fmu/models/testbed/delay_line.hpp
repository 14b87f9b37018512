// The last entries put in, handed out a fixed number of bus cycles later. Plain data: a copy is a checkpoint.
#pragma once

#include <array>
#include <cstddef>

namespace giveway::testbed {

inline constexpr int max_delay_cycles = 64;

template <class Entry> class DelayLine {
public:
    // Until the first entries come through, `history(j)` is what went in j cycles before the start, j = 1 .. delay.
    template <class History> void start(int delay_cycles, History history) {
        delay_ = delay_cycles;
        next_ = 0;
        for (int j = 1; j <= delay_; ++j) {
            entries_[static_cast<std::size_t>(delay_ + 1 - j)] = history(j);
        }
    }

    // Puts this cycle's entry in and returns the one of `delay_cycles` ago.
    Entry exchange(const Entry &entry) {
        entries_[static_cast<std::size_t>(next_)] = entry;
        next_ = next_ == delay_ ? 0 : next_ + 1; // no more places than are needed, which stay in the processor's cache
        return entries_[static_cast<std::size_t>(next_)];
    }

private:
    std::array<Entry, max_delay_cycles + 1> entries_{};
    int delay_ = 0;
    int next_ = 0;
};

} // namespace giveway::testbed
