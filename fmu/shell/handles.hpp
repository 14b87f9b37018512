// What an importer holds instead of a pointer, so that a handle that was freed, or never was one, is noticed and not followed.
//
// Finding is lock-free and costs two loads; making and freeing may happen in several threads at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace giveway {

class Handles {
public:
    Handles() = default;
    // When the library is unloaded. Whoever did not free an object has lost it.
    ~Handles();
    Handles(const Handles &) = delete;
    Handles &operator=(const Handles &) = delete;

    // A handle for `object` (not null); null when out of memory or with a million objects alive.
    void *add(void *object);

    // The object; null if the handle was freed, or was never given out.
    void *find(const void *handle) const;

    // Frees the handle and gives the object back, to one caller only; null as above.
    void *remove(void *handle);

private:
    static constexpr unsigned chunk_bits = 10;
    static constexpr unsigned index_bits = 20;
    static constexpr std::size_t chunk_size = std::size_t{1} << chunk_bits;
    static constexpr std::size_t chunk_count = std::size_t{1} << (index_bits - chunk_bits);

    struct Slot {
        // The complement of the object's address, 0 if there is none: a leak checker is not to take the table for an owner.
        std::atomic<std::uintptr_t> object{0};
        std::atomic<std::uintptr_t> handle{0}; // of the object that is, or was last, in this slot
        std::size_t next_free = 0;             // index + 1; 0: none
    };

    Slot *slot(std::uintptr_t handle) const;
    std::size_t take_free_index();
    void lock() {
        while (busy_.test_and_set(std::memory_order_acquire)) {
        }
    }
    void unlock() { busy_.clear(std::memory_order_release); }

    std::atomic<Slot *> chunks_[chunk_count] = {};
    std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
    std::size_t used_ = 0;       // slots that were ever used
    std::size_t first_free_ = 0; // index + 1
};

} // namespace giveway
